# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules from the editor to a running robot: what would change, the push, and its confirmation."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from typing import Literal, Protocol

from msgspec import Struct

from smarttestudo.adirf.parser import parse
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.parameter import ParameterValue, Refusals, Values
from smarttestudo.domain.rule_texts import RuleTexts
from smarttestudo.use_cases.live.rule_manager import CONFIRM_WITHIN_S
from smarttestudo.use_cases.ruler.checked_text import Draft
from smarttestudo.use_cases.ruler.difference import differences, mean_the_same
from smarttestudo.use_cases.ruler.sharing import download_text

_TEXT, _HASH, _CONFIRM, _IN_FORCE = "rules_text", "rules_hash", "confirm_hash", "rules_in_force"
# "rules_text:3:5: error: cause; remedy", as a TestudoError is told.
_WORDS = re.compile(r"(?:(?P<place>\S+): )?error: (?P<cause>.*)", re.DOTALL)


class RefusedByRobotError(RosError):
    """What a robot did not take, in its own words."""


class Parameters(Protocol):
    """Parameters of robots, by node; both may raise ``RosError``."""

    def get(self, node: str, names: list[str]) -> Values:
        """Their values; ``None`` for one that the robot does not have."""

    def set(self, node: str, values: Mapping[str, ParameterValue]) -> Refusals:
        """Set them; the reasons of those that were refused."""


class PushRequest(Draft, frozen=True, kw_only=True):
    """``POST /api/push/preview`` → ``PushPreview``; ``POST /api/push`` → ``PushAnswer``.

    Both refuse (409 with findings) rules with errors.
    """

    node: str


class PushPreview(Struct, frozen=True, kw_only=True):
    """What a push would change, in sentences; ``same`` if the rules mean the same to the robot.

    ``text_to_send`` has numbers in the place of quality levels, since a robot may have no profile; ``hash``
    is its SHA-256. ``robot_hash`` is that of what the robot follows now.
    """

    differences: tuple[str, ...]
    same: bool
    hash: str
    robot_hash: str
    text_to_send: str


class PushAnswer(Struct, frozen=True, kw_only=True):
    """``staged``: the rules hold for ``confirm_within_s``, and for good once ``hash`` is confirmed.

    ``same``: nothing was sent, since the robot follows these rules already; ``hash`` is that of what it has.
    A refusal by the robot is a 422 with the robot's own words.
    """

    state: Literal["staged", "same"]
    hash: str
    confirm_within_s: float
    differences: tuple[str, ...]


class ConfirmRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/push/confirm`` → ``ConfirmAnswer``: keep the rules that were pushed."""

    node: str
    hash: str


class ConfirmAnswer(Struct, frozen=True, kw_only=True):
    """The pushed rules hold for good."""

    state: Literal["confirmed"]
    hash: str


def preview(robots: Parameters, request: PushRequest) -> PushPreview:
    """What a push would change.

    Raises ``RefusedTextError`` for rules with errors, ``RuleFileError`` for levels that do not fit and
    ``RosError`` if the robot does not report its rules.
    """
    text = download_text(request)
    texts = _texts_of(robots, request.node)
    old, new = parse(texts.text, "the robot's rules"), parse(text, request.name)
    is_same = bool(texts.files) and mean_the_same(old, new)
    return PushPreview(
        differences=() if is_same else differences(old, new) or ("the rules differ",),
        same=is_same,
        hash=hashlib.sha256(text.encode("utf-8")).hexdigest(),
        robot_hash=texts.sha256,
        text_to_send=text,
    )


def _texts_of(robots: Parameters, node: str) -> RuleTexts:
    """The rules that a robot follows. Raises ``RosError``."""
    value = robots.get(node, [_IN_FORCE])[_IN_FORCE]
    try:
        return RuleTexts.from_text(str(value))
    except ValueError as error:
        raise RosError(
            "the robot does not report its rules",
            place=node,
            remedy="update SmartTestudo on the robot",
        ) from error


def push(robots: Parameters, request: PushRequest) -> PushAnswer:
    """Let a robot follow rules for ``CONFIRM_WITHIN_S``, unless it does already.

    Raises like ``preview``, and ``RefusedByRobotError``; then the robot goes on as before.
    """
    change = preview(robots, request)
    if not change.same:
        _set(robots, request.node, _TEXT, change.text_to_send, {_TEXT: request.name})
    return PushAnswer(
        state="same" if change.same else "staged",
        hash=change.robot_hash if change.same else change.hash,
        confirm_within_s=CONFIRM_WITHIN_S,
        differences=change.differences,
    )


def confirm(robots: Parameters, request: ConfirmRequest) -> ConfirmAnswer:
    """Let the pushed rules hold for good. Raises ``RosError``, where they are gone, too."""
    node, sha256 = request.node, request.hash
    try:
        _set(robots, node, _CONFIRM, sha256, {})
    except RefusedByRobotError as error:
        holds = robots.get(node, [_HASH])[_HASH]
        if holds == sha256:
            raise
        raise RefusedByRobotError(
            "the pushed rules are no longer in force: "
            f"they were not confirmed within {CONFIRM_WITHIN_S} s, or other "
            "rules replaced them",
            place=node,
            remedy=f"push them again; the robot's answer: {error.cause}",
        ) from error
    return ConfirmAnswer(state="confirmed", hash=sha256)


def _set(robots: Parameters, node: str, name: str, value: str, called: Mapping[str, str]) -> None:
    reason = robots.set(node, {name: value}).get(name)
    if reason is None:
        return
    words = _WORDS.fullmatch(reason)
    if words is None:
        raise RefusedByRobotError(reason or "the robot refused it without a reason", place=node)
    place = words["place"] or node
    for theirs, ours in called.items():
        place = place.replace(theirs, ours, 1)
    raise RefusedByRobotError(words["cause"], place=place)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules to a running robot in stages: what would change, a trial, kept, written to its file."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.parameter import ParameterValue, Refusals, Values
from smarttestudo.domain.remote_robots import RuleTexts
from smarttestudo.editing.difference import differences, differing_blocks, mean_the_same
from smarttestudo.language.parser import parse
from smarttestudo.robot.rule_manager import CONFIRM_WITHIN_S
from smarttestudo.rules.rule_files import PREVIOUS_SUFFIX

_TEXT, _HASH, _CONFIRM, _IN_FORCE = "rules_text", "rules_hash", "confirm_hash", "rules_in_force"
_WRITE, _WRITABLE, _MAY_WRITE, _FILES = (
    "write_hash",
    "writable_rules_file",
    "allow_writing_rules",
    "rules_file",
)
# "rules_text:3:5: error: cause; remedy", as a TestudoError is told.
_WORDS = re.compile(r"(?:(?P<place>\S+): )?error: (?P<cause>.*)", re.DOTALL)


class RefusedByRobotError(RosError):
    """Refusal by a robot, in its own words."""


class Parameters(Protocol):
    """Parameters of robots, by node; both may raise ``RosError``."""

    def get(self, node: str, names: list[str]) -> Values:
        """Their values; ``None`` for one that the robot does not have."""

    def set(self, node: str, values: Mapping[str, ParameterValue]) -> Refusals:
        """Set them; the reasons of those that were refused."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PushPreview:
    """Changes that a push would make, in sentences; ``same`` if the rules mean the same to the robot.

    ``text_to_send`` has numbers in the place of quality levels, since a robot may have no profile; ``hash``
    is its SHA-256. ``robot_hash`` is that of what the robot follows now. ``differing_rules`` are the numbers,
    from 0 in the order of the text, of the rules that it does not follow as they are.
    """

    differences: tuple[str, ...]
    same: bool
    hash: str
    robot_hash: str
    text_to_send: str
    differing_rules: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PushAnswer:
    """``staged``: the rules hold for ``confirm_within_s``, and for good once ``hash`` is confirmed.

    ``same``: nothing was sent, since the robot follows these rules already; ``hash`` is that of what it has.
    A refusal by the robot is a 422 with the robot's own words.
    """

    state: Literal["staged", "same"]
    hash: str
    confirm_within_s: float
    differences: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfirmAnswer:
    """The pushed rules hold for good."""

    state: Literal["confirmed"]
    hash: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LastingAnswer:
    """Kept rules last until the robot's runtime ends or its ``files`` change, of which it may have none.

    ``writable_file`` is the one that it lets kept rules be written to; where that is empty, ``why_not`` says
    why.
    """

    files: tuple[str, ...]
    writable_file: str
    why_not: str


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteAnswer:
    """The robot's ``file`` holds the rules; what it held is beside it, in ``previous_file``."""

    file: str
    previous_file: str


def preview(robots: Parameters, node: str, text: str, name: str) -> PushPreview:
    """Compare the rules ``text``, which findings call ``name``, with those that a robot follows.

    Raises ``RosError`` if the robot does not report its rules.
    """
    texts = rules_in_force(robots, node)
    old, new = parse(texts.text, "the robot's rules"), parse(text, name)
    is_same = bool(texts.files) and mean_the_same(old, new)
    return PushPreview(
        differences=() if is_same else differences(old, new) or ("the rules differ",),
        same=is_same,
        hash=hashlib.sha256(text.encode("utf-8")).hexdigest(),
        robot_hash=texts.sha256,
        text_to_send=text,
        differing_rules=differing_blocks(old, new),
    )


def rules_in_force(robots: Parameters, node: str) -> RuleTexts:
    """The rules that a robot follows. Raises ``RosError``."""
    value = robots.get(node, [_IN_FORCE])[_IN_FORCE]
    try:
        return RuleTexts.from_text(str(value))
    except ValueError as error:
        raise RosError(
            "the robot does not report its rules", place=node, remedy="update SmartTestudo on the robot"
        ) from error


def push(robots: Parameters, node: str, change: PushPreview, name: str) -> PushAnswer:
    """Let a robot follow the rules of ``change`` for ``CONFIRM_WITHIN_S``, unless it does already.

    Raises ``RosError``, and ``RefusedByRobotError``; then the robot goes on as before.
    """
    if not change.same:
        _set(robots, node, _TEXT, change.text_to_send, {_TEXT: name})
    return PushAnswer(
        state="same" if change.same else "staged",
        hash=change.robot_hash if change.same else change.hash,
        confirm_within_s=CONFIRM_WITHIN_S,
        differences=change.differences,
    )


def confirm(robots: Parameters, node: str, sha256: str) -> ConfirmAnswer:
    """Let the pushed rules hold for good. Raises ``RosError``, where they are gone, too."""
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


def lasting(robots: Parameters, node: str) -> LastingAnswer:
    """How long the rules last that a robot keeps. Raises ``RosError``."""
    values = robots.get(node, [_FILES, _WRITABLE, _MAY_WRITE])
    named = values[_FILES]
    files = tuple(named if isinstance(named, tuple) else filter(None, [str(named or "")]))
    writable = str(values[_WRITABLE] or "")
    return LastingAnswer(
        files=files, writable_file=writable, why_not="" if writable else _why_not(values[_MAY_WRITE], files)
    )


def _why_not(may_write: ParameterValue, files: tuple[str, ...]) -> str:
    if may_write is None:
        return "Its SmartTestudo is from before rules could be written: update it on the robot."
    if may_write is not True:
        return "It was not started with --allow-writing-rules, without which nothing is written to its files."
    if not files:
        return "It was started without a rule file."
    return "It has several rule files, and what was sent is one text: put that into its files by other means."


def write(robots: Parameters, node: str, sha256: str) -> WriteAnswer:
    """Have a robot write the rules that it keeps to its file. Raises ``RosError``."""
    file = lasting(robots, node).writable_file
    _set(robots, node, _WRITE, sha256, {})
    return WriteAnswer(file=file, previous_file=f"{file}{PREVIOUS_SUFFIX}")


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

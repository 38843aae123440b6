# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules from the editor to a running robot: what would change, the push, and its confirmation."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from smarttestudo.adirf.parser import parse
from smarttestudo.composition.pushed_rules import CONFIRM_WITHIN_S
from smarttestudo.composition.ruler.checked_text import Draft
from smarttestudo.composition.ruler.difference import differences, mean_the_same
from smarttestudo.composition.ruler.sharing import download_text
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.remote_parameters import Refusals, Values
from smarttestudo.domain.rule_texts import RuleTexts

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A rule file beside the rules that a robot follows; ``is_same`` where a robot could not tell them apart.

    ``text`` is what would be sent, with its SHA-256; ``robot_sha256`` that of what the robot has.
    """

    text: str
    sha256: str
    robot_sha256: str
    is_same: bool
    differences: tuple[str, ...]


def compare_with_robot(robots: Parameters, node: str, draft: Draft) -> Change:
    """What a push of ``draft`` would change.

    Raises ``RefusedTextError`` for rules with errors, ``RuleFileError`` for levels that do not fit and
    ``RosError`` where the robot does not tell its rules.
    """
    text = download_text(draft)
    texts = texts_of(robots, node)
    old, new = parse(texts.text, "the robot's rules"), parse(text, draft.name)
    is_same = bool(texts.files) and mean_the_same(old, new)
    return Change(
        text=text,
        sha256=hashlib.sha256(text.encode("utf-8")).hexdigest(),
        robot_sha256=texts.sha256,
        is_same=is_same,
        differences=() if is_same else differences(old, new) or ("the rules differ",),
    )


def texts_of(robots: Parameters, node: str) -> RuleTexts:
    """The rules that a robot follows. Raises ``RosError``."""
    value = robots.get(node, [_IN_FORCE])[_IN_FORCE]
    try:
        return RuleTexts.from_text(str(value))
    except ValueError as error:
        raise RosError(
            "the robot does not tell which rules it follows",
            place=node,
            remedy="update SmartTestudo on the robot",
        ) from error


def push(robots: Parameters, node: str, draft: Draft) -> Change:
    """Let a robot follow ``draft`` for ``CONFIRM_WITHIN_S``, unless it does already.

    Raises like ``compare_with_robot``, and ``RefusedByRobotError``; then the robot goes on as before.
    """
    change = compare_with_robot(robots, node, draft)
    if not change.is_same:
        _set(robots, node, _TEXT, change.text, {_TEXT: draft.name})
    return change


def confirm(robots: Parameters, node: str, sha256: str) -> None:
    """Let the pushed rules hold for good. Raises ``RosError``, where they are gone, too."""
    try:
        _set(robots, node, _CONFIRM, sha256, {})
    except RefusedByRobotError as error:
        holds = robots.get(node, [_HASH])[_HASH]
        if holds == sha256:
            raise
        raise RefusedByRobotError(
            f"the pushed rules hold no longer: they were not confirmed within {CONFIRM_WITHIN_S} s, or other "
            "rules came meanwhile",
            place=node,
            remedy=f"push them again; the robot says: {error.cause}",
        ) from error


def _set(robots: Parameters, node: str, name: str, value: str, called: Mapping[str, str]) -> None:
    reason = robots.set(node, {name: value}).get(name)
    if reason is None:
        return
    words = _WORDS.fullmatch(reason)
    if words is None:
        raise RefusedByRobotError(reason or "the robot refuses it without a word", place=node)
    place = words["place"] or node
    for theirs, ours in called.items():
        place = place.replace(theirs, ours, 1)
    raise RefusedByRobotError(words["cause"], place=place)

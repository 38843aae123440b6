# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles on disk: TOML, checked, every complaint with its line."""

from __future__ import annotations

import difflib
import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.names import is_topic_name, resolve_topic
from smarttestudo.domain.profile import (
    MAX_BUDGET_KB_PER_S,
    AccuracyTiers,
    LevelledProperty,
    LevelUnit,
    Profile,
    TopicProfile,
)
from smarttestudo.domain.rate import MAX_RATE_HZ, MIN_SOURCE_HZ, RATE_STEP_HZ, Tier
from smarttestudo.files.toml_text import KeyPath, parse_toml, read_toml_text


@dataclass(frozen=True, slots=True, kw_only=True)
class _Range:
    """The numbers that a key can hold; ``unit`` begins with a blank, ``remedy`` is for keys without one."""

    least: float
    most: float
    unit: str = ""
    remedy: str = ""


# Wider than any robot needs, and narrow enough for nanoseconds, sums and solvers.
_BUDGET = _Range(least=0.0, most=MAX_BUDGET_KB_PER_S, unit=" KB/s")
_SETTLE = _Range(least=0.0, most=1e6, unit=" s")
_STALE = _Range(least=1e-3, most=1e6, unit=" s")
_MESSAGE = _Range(least=1e-6, most=1e6, unit=" KB")
_SOURCE = _Range(least=MIN_SOURCE_HZ, most=MAX_RATE_HZ, unit=" Hz")
_STREAMS = _Range(least=1.0, most=1e6)
_PRIORITY = _Range(least=1e-6, most=1e6, remedy="only its ratio to the others counts")
_ACCURACY = _Range(least=1e-9, most=1e9, remedy="the unit is in the key's name")


def load_profile(path: Path) -> Profile:
    """The profile in the TOML file at ``path``; topic names are resolved in the root namespace.

    Raises ``ProfileError`` for the first key that is unknown or holds a value that it cannot.
    """
    return parse_profile(read_toml_text(path), path)


def parse_profile(text: str, path: Path, *, named: Callable[[KeyPath], str] | None = None) -> Profile:
    """The profile in ``text``, which is that of ``path``; see ``load_profile``.

    ``named`` is how errors call the value at a place; without it they spell the path of its key.
    """
    values, lines = parse_toml(text, path)
    return _ProfileReader(path=path, lines=lines, named=named or _name).profile(values)


class _ProfileReader:
    def __init__(self, *, path: Path, lines: Mapping[KeyPath, int], named: Callable[[KeyPath], str]) -> None:
        self._path = path
        self._named = named
        self._lines = lines
        self._top: dict[str, Callable[[KeyPath, object], object]] = {
            "budget_kb_per_s": partial(self._in_range, _BUDGET),
            "settle_s": partial(self._in_range, _SETTLE),
            "topics": self._topics,
        }
        self._of_topic: dict[str, Callable[[KeyPath, object], object]] = {
            "type": self._text,
            "message_kb": partial(self._in_range, _MESSAGE),
            "source_hz": partial(self._in_range, _SOURCE),
            "streams": partial(self._in_range, _STREAMS),
            "tiers_hz": self._tiers,
            "priority": partial(self._in_range, _PRIORITY),
            "min_hz": self._rate,
            "max_hz": self._rate,
            "stale_after_s": partial(self._in_range, _STALE),
            "paced_with": self._topic_name,
            "level_unit": self._level_unit,
        }
        for one in LevelledProperty:
            self._of_topic[one.tiers_key] = partial(self._accuracies, one)
            self._of_topic[one.needs_key] = self._tiers

    def profile(self, values: Mapping[str, object]) -> Profile:
        read: dict[str, Any] = self._table((), values, self._top)
        return Profile(path=str(self._path), **read)

    def _table(
        self, at: KeyPath, values: object, readers: Mapping[str, Callable[[KeyPath, object], object]]
    ) -> dict[str, object]:
        if not isinstance(values, Mapping):
            raise self._error(at, f"{self._named(at)} must be a table")
        for key in values:
            if key not in readers:
                close = difflib.get_close_matches(key, readers, n=1)
                remedy = f"did you mean {close[0]}?" if close else f"known keys: {', '.join(readers)}"
                raise self._error((*at, key), f"unknown key {self._named((*at, key))}", remedy=remedy)
        return {key: readers[key]((*at, key), value) for key, value in values.items()}

    def _topics(self, at: KeyPath, values: object) -> dict[str, TopicProfile]:
        if not isinstance(values, Mapping):
            raise self._error(at, 'topics must be tables such as [topics."/odom"]')
        topics: dict[str, TopicProfile] = {}
        for name, entry in values.items():
            full = self._topic_name((*at, name), name)
            if full in topics:
                remedy = "keep one of the two tables"
                raise self._error((*at, name), f"the topic {full} has a table already", remedy=remedy)
            topics[full] = self._topic((*at, name), entry)
        return topics

    def _topic(self, at: KeyPath, values: object) -> TopicProfile:
        read: dict[str, Any] = self._table(at, values, self._of_topic)
        read["type_name"] = read.pop("type", None)
        read["accuracies"] = self._accuracy_tiers(at, read)
        topic = TopicProfile(
            **{field.name: read[field.name] for field in fields(TopicProfile) if field.name in read}
        )
        if topic.min_hz is not None and topic.max_hz is not None and topic.min_hz > topic.max_hz:
            raise self._error((*at, "min_hz"), "min_hz is above max_hz")
        return topic

    def _accuracy_tiers(self, at: KeyPath, read: Mapping[str, Any]) -> dict[LevelledProperty, AccuracyTiers]:
        for one in LevelledProperty:
            if one.needs_key in read and one.tiers_key not in read:
                cause = (
                    f"{self._named((*at, one.needs_key))} says what {one.tiers_key} need, which is missing"
                )
                raise self._error((*at, one.needs_key), cause, remedy=f"add {one.tiers_key}, or remove it")
        return {
            one: AccuracyTiers(bounds=read[one.tiers_key], needs_hz=read.get(one.needs_key))
            for one in LevelledProperty
            if one.tiers_key in read
        }

    def _in_range(self, bounds: _Range, at: KeyPath, value: object) -> float:
        number = self._number(at, value)
        if bounds.least > 0 and number <= 0:
            raise self._error(at, f"{self._named(at)} must be above 0, it is {number:g}")
        if number < 0:
            raise self._error(at, f"{self._named(at)} must not be negative, it is {number:g}")
        if not bounds.least <= number <= bounds.most:
            limits = f"from {bounds.least:g} to {bounds.most:g}{bounds.unit}"
            remedy = f"is it in{bounds.unit}?" if bounds.unit else bounds.remedy
            raise self._error(at, f"{self._named(at)} must be {limits}, it is {number:g}", remedy=remedy)
        return number

    def _number(self, at: KeyPath, value: object) -> float:
        try:
            if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
                return float(value)
        except OverflowError as error:
            cause = f"{self._named(at)} has more digits than a number can have"
            raise self._error(at, cause, remedy="write it shorter, as in 1500.0") from error
        raise self._error(at, f"{self._named(at)} must be a finite number")

    def _rate(self, at: KeyPath, value: object) -> float:
        number = self._number(at, value)
        if number < 0:
            raise self._error(at, f"{self._named(at)} must not be negative, it is {number:g}")
        if number != 0 and not RATE_STEP_HZ <= number <= MAX_RATE_HZ:
            limits = f"0, or from {RATE_STEP_HZ:g} to {MAX_RATE_HZ:g} Hz"
            raise self._error(at, f"{self._named(at)} must be {limits}, it is {number:g}")
        return number

    def _tiers(self, at: KeyPath, value: object) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) != len(Tier):
            given = f"{len(value)} numbers" if isinstance(value, list) else "something else"
            raise self._error(
                at, f"{self._named(at)} must be a list of six rates τ0 … τ5 in Hz, it is {given}"
            )
        tiers = tuple(self._rate(at, one) for one in value)
        for (lower, lower_hz), (higher, higher_hz) in itertools.pairwise(zip(Tier, tiers, strict=True)):
            if higher_hz < lower_hz:
                fall = f"{higher.value} ({higher_hz:g} Hz) is below {lower.value} ({lower_hz:g} Hz)"
                raise self._error(at, f"{self._named(at)} must not fall from one level to the next: {fall}")
        return tiers

    def _accuracies(self, kind: LevelledProperty, at: KeyPath, value: object) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) != len(Tier):
            given = f"{len(value)} numbers" if isinstance(value, list) else "something else"
            what = f"a list of six accuracies α0 … α5 in {kind.unit}"
            raise self._error(at, f"{self._named(at)} must be {what}, it is {given}")
        bounds = tuple(self._in_range(_ACCURACY, at, one) for one in value)
        for (lower, loose), (higher, tight) in itertools.pairwise(zip(Tier, bounds, strict=True)):
            if tight > loose:
                rise = f"{higher.value} ({tight:g}) is above {lower.value} ({loose:g})"
                remedy = "write the widest bound first"
                cause = f"{self._named(at)} must not rise from one level to the next: {rise}"
                raise self._error(at, cause, remedy=remedy)
        return bounds

    def _text(self, at: KeyPath, value: object) -> str:
        if not isinstance(value, str) or not value:
            raise self._error(at, f"{self._named(at)} must be a string in quotes")
        return value

    def _topic_name(self, at: KeyPath, value: object) -> str:
        name = self._text(at, value)
        if not is_topic_name(name):
            raise self._error(at, f"{name!r} is not a valid ROS 2 topic name")
        return resolve_topic(name)

    def _level_unit(self, at: KeyPath, value: object) -> LevelUnit:
        for unit in LevelUnit:
            if unit.value == value:
                return unit
        raise self._error(at, f'{self._named(at)} must be "percent" or "fraction"')

    def _error(self, at: KeyPath, cause: str, *, remedy: str | None = None) -> ProfileError:
        known = next(
            (self._lines[at[:end]] for end in range(len(at), 0, -1) if at[:end] in self._lines), None
        )
        place = f"{self._path}:{known}:1" if known else str(self._path)
        return ProfileError(cause, place=place, remedy=remedy)


def _name(at: KeyPath) -> str:
    return ".".join(f'"{part}"' if "/" in part else part for part in at) or "the profile"

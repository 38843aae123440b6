# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles on disk: TOML, checked, every complaint with its line."""

from __future__ import annotations

import difflib
import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.names import MAX_NAME_LENGTH, TOPIC_FORM, is_topic_name, resolve_topic
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


@dataclass(frozen=True, slots=True, kw_only=True)
class _Key:
    """A key of a profile: what it means, how its value is read, and what a JSON schema says of that."""

    meaning: str
    read: Callable[[_ProfileReader, KeyPath, object], object]
    schema: Mapping[str, object]


class _ProfileReader:
    def __init__(self, *, path: Path, lines: Mapping[KeyPath, int], named: Callable[[KeyPath], str]) -> None:
        self._path = path
        self._named = named
        self._lines = lines

    def profile(self, values: Mapping[str, object]) -> Profile:
        read: dict[str, Any] = self._table((), values, _TOP)
        return Profile(path=str(self._path), **read)

    def _table(self, at: KeyPath, values: object, keys: Mapping[str, _Key]) -> dict[str, object]:
        if not isinstance(values, Mapping):
            raise self._error(at, f"{self._named(at)} must be a table")
        for key in values:
            if key not in keys:
                close = difflib.get_close_matches(key, keys, n=1)
                remedy = f"did you mean {close[0]}?" if close else f"known keys: {', '.join(keys)}"
                raise self._error((*at, key), f"unknown key {self._named((*at, key))}", remedy=remedy)
        return {key: keys[key].read(self, (*at, key), value) for key, value in values.items()}

    def topics(self, at: KeyPath, values: object) -> dict[str, TopicProfile]:
        if not isinstance(values, Mapping):
            raise self._error(at, 'topics must be tables such as [topics."/odom"]')
        topics: dict[str, TopicProfile] = {}
        for name, entry in values.items():
            full = self.topic_name((*at, name), name)
            if full in topics:
                remedy = "keep one of the two tables"
                raise self._error((*at, name), f"the topic {full} has a table already", remedy=remedy)
            topics[full] = self._topic((*at, name), entry)
        return topics

    def _topic(self, at: KeyPath, values: object) -> TopicProfile:
        read: dict[str, Any] = self._table(at, values, _OF_TOPIC)
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

    def in_range(self, bounds: _Range, at: KeyPath, value: object) -> float:
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

    def rate(self, at: KeyPath, value: object) -> float:
        number = self._number(at, value)
        if number < 0:
            raise self._error(at, f"{self._named(at)} must not be negative, it is {number:g}")
        if number != 0 and not RATE_STEP_HZ <= number <= MAX_RATE_HZ:
            limits = f"0, or from {RATE_STEP_HZ:g} to {MAX_RATE_HZ:g} Hz"
            raise self._error(at, f"{self._named(at)} must be {limits}, it is {number:g}")
        return number

    def tiers(self, at: KeyPath, value: object) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) != len(Tier):
            given = f"{len(value)} numbers" if isinstance(value, list) else "something else"
            raise self._error(
                at, f"{self._named(at)} must be a list of six rates τ0 … τ5 in Hz, it is {given}"
            )
        tiers = tuple(self.rate(at, one) for one in value)
        for (lower, lower_hz), (higher, higher_hz) in itertools.pairwise(zip(Tier, tiers, strict=True)):
            if higher_hz < lower_hz:
                fall = f"{higher.value} ({higher_hz:g} Hz) is below {lower.value} ({lower_hz:g} Hz)"
                raise self._error(at, f"{self._named(at)} must not fall from one level to the next: {fall}")
        return tiers

    def accuracies(self, kind: LevelledProperty, at: KeyPath, value: object) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) != len(Tier):
            given = f"{len(value)} numbers" if isinstance(value, list) else "something else"
            what = f"a list of six accuracies α0 … α5 in {kind.unit}"
            raise self._error(at, f"{self._named(at)} must be {what}, it is {given}")
        bounds = tuple(self.in_range(_ACCURACY, at, one) for one in value)
        for (lower, loose), (higher, tight) in itertools.pairwise(zip(Tier, bounds, strict=True)):
            if tight > loose:
                rise = f"{higher.value} ({tight:g}) is above {lower.value} ({loose:g})"
                remedy = "write the widest bound first"
                cause = f"{self._named(at)} must not rise from one level to the next: {rise}"
                raise self._error(at, cause, remedy=remedy)
        return bounds

    def text(self, at: KeyPath, value: object) -> str:
        if not isinstance(value, str) or not value:
            raise self._error(at, f"{self._named(at)} must be a string in quotes")
        return value

    def topic_name(self, at: KeyPath, value: object) -> str:
        name = self.text(at, value)
        if not is_topic_name(name):
            raise self._error(at, f"{name!r} is not a valid ROS 2 topic name")
        return resolve_topic(name)

    def allowed_parameters(self, at: KeyPath, values: object) -> dict[str, frozenset[str]]:
        if not isinstance(values, Mapping):
            remedy = 'write it as in "/camera_driver" = ["jpeg_quality"]'
            raise self._error(at, f"{self._named(at)} must be a table of nodes", remedy=remedy)
        allowed: dict[str, frozenset[str]] = {}
        for node, names in values.items():
            full = self.topic_name((*at, node), node)
            parameters = frozenset(self._names((*at, node), names, self.text))
            allowed[full] = allowed.get(full, frozenset()) | parameters
        return allowed

    def allowed_calls(self, at: KeyPath, values: object) -> frozenset[str]:
        return frozenset(self._names(at, values, self.topic_name))

    def _names(self, at: KeyPath, values: object, read: Callable[[KeyPath, object], str]) -> list[str]:
        if not isinstance(values, list):
            raise self._error(at, f"{self._named(at)} must be a list of names")
        return [read(at, value) for value in values]

    def truth(self, at: KeyPath, value: object) -> bool:
        if not isinstance(value, bool):
            raise self._error(at, f"{self._named(at)} must be true or false")
        return value

    def level_unit(self, at: KeyPath, value: object) -> LevelUnit:
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


_RATE: Mapping[str, object] = {
    "type": "number",
    "anyOf": [{"const": 0}, {"minimum": RATE_STEP_HZ, "maximum": MAX_RATE_HZ}],
}
_TOPIC_NAME: Mapping[str, object] = {
    "type": "string",
    "pattern": f"^(?!.*__){TOPIC_FORM}$",
    "maxLength": MAX_NAME_LENGTH,
}


def _in_range(bounds: _Range, meaning: str) -> _Key:
    return _Key(
        meaning=meaning,
        read=lambda reader, at, value: reader.in_range(bounds, at, value),
        schema={"type": "number", "minimum": bounds.least, "maximum": bounds.most},
    )


def _rate(meaning: str) -> _Key:
    return _Key(meaning=meaning, read=_ProfileReader.rate, schema=_RATE)


def _six(items: Mapping[str, object]) -> Mapping[str, object]:
    return {"type": "array", "items": items, "minItems": len(Tier), "maxItems": len(Tier)}


def _object(keys: Mapping[str, _Key]) -> dict[str, object]:
    return {
        "type": "object",
        "properties": {name: {"description": key.meaning, **key.schema} for name, key in keys.items()},
        "additionalProperties": False,
    }


def _levels(meaning: str) -> _Key:
    return _Key(meaning=meaning, read=_ProfileReader.tiers, schema=_six(_RATE))


def _accuracies(kind: LevelledProperty) -> _Key:
    return _Key(
        meaning=f"six accuracies α0 … α5 of its {kind.value} in {kind.unit}, the widest first",
        read=lambda reader, at, value: reader.accuracies(kind, at, value),
        schema=_six({"type": "number", "minimum": _ACCURACY.least, "maximum": _ACCURACY.most}),
    )


_OF_TOPIC: Mapping[str, _Key] = {
    "type": _Key(
        meaning="type of its messages, as in nav_msgs/msg/Odometry",
        read=_ProfileReader.text,
        schema={"type": "string", "minLength": 1},
    ),
    "message_kb": _in_range(_MESSAGE, "mean size of a message in KB of 1000 bytes"),
    "source_hz": _in_range(_SOURCE, "rate of the source in Hz"),
    "streams": _in_range(_STREAMS, "streams that its messages name, 1 if not given"),
    "tiers_hz": _levels("six rates τ0 … τ5 of its quality levels in Hz, which do not fall"),
    "priority": _in_range(_PRIORITY, "what it counts beside other topics, 1 if not given"),
    "min_hz": _rate("floor in every model of the optimizer in Hz"),
    "max_hz": _rate("ceiling in the models budget and priority in Hz"),
    "stale_after_s": _in_range(_STALE, "silence in s after which its values are unknown"),
    "paced_with": _Key(
        meaning="topic whose stamps it follows", read=_ProfileReader.topic_name, schema=_TOPIC_NAME
    ),
    "level_unit": _Key(
        meaning="unit of a battery's level",
        read=_ProfileReader.level_unit,
        schema={"enum": [unit.value for unit in LevelUnit]},
    ),
    "measured": _Key(
        meaning="false while size and rate are from a preset, true if not given",
        read=_ProfileReader.truth,
        schema={"type": "boolean"},
    ),
    **{
        name: key
        for one in LevelledProperty
        for name, key in (
            (one.tiers_key, _accuracies(one)),
            (one.needs_key, _levels(f"messages per s that each of {one.tiers_key} needs")),
        )
    },
}
_TOP: Mapping[str, _Key] = {
    "budget_kb_per_s": _in_range(_BUDGET, "what all relayed topics together may take, in KB/s"),
    "settle_s": _in_range(
        _SETTLE, "how long nothing must ask for more before a rate falls, in s; 0.5 if not given"
    ),
    "allow_parameters": _Key(
        meaning="parameters that rules may set, a list for each node",
        read=_ProfileReader.allowed_parameters,
        schema={
            "type": "object",
            "propertyNames": _TOPIC_NAME,
            "additionalProperties": {"type": "array", "items": {"type": "string", "minLength": 1}},
        },
    ),
    "allow_calls": _Key(
        meaning="services that rules may call",
        read=_ProfileReader.allowed_calls,
        schema={"type": "array", "items": _TOPIC_NAME},
    ),
    "topics": _Key(
        meaning='a table for each topic, as in [topics."/odom"]',
        read=_ProfileReader.topics,
        schema={
            "type": "object",
            "propertyNames": _TOPIC_NAME,
            "additionalProperties": {
                **_object(_OF_TOPIC),
                "dependencies": {one.needs_key: [one.tiers_key] for one in LevelledProperty},
            },
        },
    ),
}


def profile_schema() -> dict[str, object]:
    """The JSON schema of a profile; it does not compare values with each other, as reading one does."""
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Profile of SmartTestudo",
        **_object(_TOP),
    }


def _name(at: KeyPath) -> str:
    return ".".join(f'"{part}"' if "/" in part else part for part in at) or "the profile"

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A profile as a table of topics, and back into its text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from msgspec import Struct, structs

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.profile import LevelledProperty
from smarttestudo.files.toml_text import KeyPath, parse_toml
from smarttestudo.rules.profile_edit import edited_profile
from smarttestudo.rules.profile_file import parse_profile

SixLevels = tuple[float, float, float, float, float, float]


class ProfileRow(Struct, frozen=True, kw_only=True):
    """One topic by the name that the text has for it; null stands for a key that is not written.

    Sizes are in KB of 1000 B, rates in Hz; accuracies are in m, degrees and rad, beside the rates they need.
    """

    topic: str
    type: str | None = None
    message_kb: float | None = None
    source_hz: float | None = None
    tiers_hz: SixLevels | None = None
    priority: float | None = None
    min_hz: float | None = None
    max_hz: float | None = None
    tiers_m: SixLevels | None = None
    tiers_m_need_hz: SixLevels | None = None
    tiers_deg: SixLevels | None = None
    tiers_deg_need_hz: SixLevels | None = None
    tiers_rad: SixLevels | None = None
    tiers_rad_need_hz: SixLevels | None = None

    def keys(self) -> dict[str, str | float | Sequence[float] | None]:
        """The keys of the topic's table."""
        return {key: value for key, value in structs.asdict(self).items() if key != "topic"}


class ProfileParseRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/parse`` → ``ProfileTable``."""

    text: str
    name: str = "profile.toml"


class ProfileTable(Struct, frozen=True, kw_only=True):
    """The topics of a profile in the order of the text, and its budget in KB/s."""

    rows: tuple[ProfileRow, ...]
    budget_kb_per_s: float | None = None


class ProfileWriteRequest(ProfileTable, frozen=True, kw_only=True):
    """``POST /api/profile/write`` → ``TextAnswer``: ``base_text`` with the values of the table.

    Comments, order and keys that the table does not show stay. Topics that are not in ``rows`` are removed.
    ``POST /api/profile/check`` → ``ProfileCheckAnswer``: whether that can be done.
    """

    base_text: str = ""
    name: str = "profile.toml"


class ProfileEntryRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/entry`` → ``TextAnswer``: ``text`` with ``value`` for ``key`` of ``topic``.

    Null takes the key out. Everything else stays as it is written; a topic that the text lacks gets a table.
    """

    text: str
    topic: str
    key: str
    value: str | None
    name: str = "profile.toml"


class ProfileCheckAnswer(Struct, frozen=True, kw_only=True):
    """Why a table cannot be written; empty if it can."""

    problem: str


def read_table(text: str, path: Path) -> ProfileTable:
    """The table of the profile ``text``; ``ProfileError`` for one that has errors."""
    budget_kb_per_s = parse_profile(text, path).budget_kb_per_s
    values, _ = parse_toml(text, path)
    topics = values.get("topics", {})
    tables: Mapping[str, Mapping[str, object]] = topics if isinstance(topics, Mapping) else {}
    return ProfileTable(
        rows=tuple(_row(topic, table) for topic, table in tables.items()), budget_kb_per_s=budget_kb_per_s
    )


def write_table(table: ProfileTable, base_text: str, path: Path) -> str:
    """``base_text`` with the values of ``table``.

    Raises ``ProfileError`` for a row that no profile can hold, and for a text that cannot be edited so.
    """
    names = [row.topic for row in table.rows]
    for name in names:
        if not is_topic_name(name):
            raise ProfileError(f"{name!r} is not a valid ROS 2 topic name", place=str(path))
        if names.count(name) > 1:
            raise ProfileError(
                f"{name} is in the table twice", place=str(path), remedy="remove one of the rows"
            )
    text = edited_profile(
        base_text,
        path,
        {"budget_kb_per_s": table.budget_kb_per_s},
        {row.topic: row.keys() for row in table.rows},
    )
    parse_profile(text, path, named=_in_words)
    return text


def _in_words(at: KeyPath) -> str:
    """The words of the table for the value at this place of a profile."""
    match at:
        case ("topics", topic, key) if key in _COLUMNS:
            return f"{_COLUMNS[key]} of {topic}"
        case ("budget_kb_per_s",):
            return "The budget, the total bandwidth,"
        case _:
            return ".".join(at)


_COLUMNS = {
    "message_kb": "Message size",
    "source_hz": "Source rate",
    "priority": "Priority",
    "min_hz": "Lowest rate",
    "max_hz": "Highest rate",
    "tiers_hz": "Levels",
    **{one.tiers_key: f"Accuracies in {one.value}" for one in LevelledProperty},
    **{one.needs_key: f"Rates for the accuracies in {one.value}" for one in LevelledProperty},
}


def write_entry(text: str, path: Path, *, topic: str, key: str, value: str | None) -> str:
    """``text`` with ``value`` for ``key`` of ``topic``; ``ProfileError`` where no profile can hold that."""
    before = read_table(text, path)
    entries: dict[str, dict[str, str | None]] = {row.topic: {} for row in before.rows}
    entries[topic] = {key: value}
    edited = edited_profile(text, path, {}, entries)
    parse_profile(edited, path)
    return edited


def six_levels(thresholds: Sequence[float]) -> SixLevels:
    """The thresholds of the six levels, as which a profile that was read has them."""
    one, two, three, four, five, six = thresholds
    return one, two, three, four, five, six


def _row(topic: str, table: Mapping[str, object]) -> ProfileRow:
    values: dict[str, Any] = {key: _number(table.get(key)) for key in _NUMBERS}
    values.update((key, _six(table.get(key))) for key in _SIXES)
    return ProfileRow(topic=topic, type=_text(table.get("type")), **values)


_NUMBERS = ("message_kb", "source_hz", "priority", "min_hz", "max_hz")
_SIXES = ("tiers_hz", *(key for one in LevelledProperty for key in (one.tiers_key, one.needs_key)))


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None


def _six(value: object) -> SixLevels | None:
    return six_levels([float(one) for one in value]) if isinstance(value, list) else None


def _text(value: object) -> str | None:
    return value if isinstance(value, str) else None

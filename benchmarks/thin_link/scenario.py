# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A radio as a file: its link, how much is offered to it, and what an operator should observe of it.

Such a file is a case of the benchmarks: a link above, and below an interval for each thing that is observed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.toml_text import KeyPath, parse_toml, read_toml_text
from thin_link.cases import WARM_S, Beside, Case, Seen, Target
from thin_link.emulated_path import PathConditions
from thin_link.observations import CLOUD, EVENTS, JPEG, LAST_S, OBSERVED, SMALL, judge_fairness
from thin_link.traffic import Topic

FOLDER = Path(__file__).parent / "scenarios"
_LEAST_JPEG_BYTES = 1_000
_UNITS: Mapping[str, tuple[str, float]] = {
    "rate_mbit_per_s": ("rate_bits_per_s", 1e6),
    "queue_kb": ("queue_bytes", 1e3),
    "delay_ms": ("delay_ms", 1),
    "jitter_ms": ("jitter_ms", 1),
    "loss": ("loss", 1),
    "loss_run_packets": ("loss_run_packets", 1),
    "reordered": ("reordered", 1),
    "duplicated": ("duplicated", 1),
    "mtu_bytes": ("mtu_bytes", 1),
}
"""Numbers of a link: the field of ``PathConditions`` that each is for, and how many of its units."""


class ScenarioError(TestudoError):
    """A file that describes no radio."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """The least and the most that should be observed."""

    least: float
    most: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scenario:
    """A radio by its file; ``course`` is its conditions from each time on."""

    name: str
    title: str
    seconds: float
    course: Sequence[tuple[float, PathConditions]]
    topics: Sequence[Topic]
    observed: Mapping[str, Interval]

    @property
    def conditions(self) -> PathConditions:
        """How it begins."""
        return self.course[0][1]

    def case(self, beside: Beside = Beside.NOTHING) -> Case:
        """The case of the benchmarks that it is; beside something else it is to be fair to that alone."""
        return Case(
            title=self.title,
            topics=self.topics,
            course=self.course,
            seconds=self.seconds,
            judge=self.judge if beside is Beside.NOTHING else judge_fairness,
            beside=beside,
        )

    def judge(self, seen: Seen) -> list[Target]:
        """All that was observed, beside its interval."""
        return [
            Target(
                name=OBSERVED[name].text,
                value=OBSERVED[name].of(seen),
                least=interval.least,
                most=interval.most,
            )
            for name, interval in self.observed.items()
        ]


def load_scenario(path: Path) -> Scenario:
    """The radio in a file. Raises ``TestudoError`` with the place of what is wrong in it."""
    values, lines = parse_toml(read_toml_text(path), path)
    table = _Table(path, lines, values)
    link = table.table("link")
    changes = link.tables("changes")
    conditions = _conditions(link, None)
    course = [(0.0, conditions)]
    for change in changes:
        at_s = change.number("at_s", course[-1][0], float("inf"))
        course.append((at_s, _conditions(change, course[-1][1])))
    observed = table.table("observed")
    scenario = Scenario(
        name=path.stem,
        title=table.text("title"),
        seconds=table.number("seconds", WARM_S + LAST_S + 1, 3_600, 20.0),
        course=course,
        topics=_offered(table.table("offered"), conditions),
        observed={name: observed.interval(name) for name in observed.left() if name in OBSERVED},
    )
    for read in (table, link, observed, *changes):
        read.end()
    return scenario


def scenario_paths() -> dict[str, Path]:
    """The files that are here, by the names of their radios."""
    return {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}


def _conditions(table: _Table, before: PathConditions | None) -> PathConditions:
    """The conditions that a table names, and else what held ``before``."""
    if before is None:
        before = PathConditions(rate_bits_per_s=table.number("rate_mbit_per_s", 0, 10_000) * 1e6)
    changed = dict[str, Any]()
    for key, (name, unit) in _UNITS.items():
        if key in table.left():
            most = 1 if key in {"loss", "reordered", "duplicated"} else float("inf")
            value = table.number(key, 0, most) * unit
            changed[name] = int(value) if name.endswith("_bytes") else value
    if "blocks_udp" in table.left():
        changed["blocks_udp"] = table.truth("blocks_udp")
    return replace(before, **changed)


def _offered(table: _Table, conditions: PathConditions) -> list[Topic]:
    """The small topics, one of which every message matters, and images so large that the share is offered."""
    share = table.number("share_of_rate", 0, 100)
    cloud = replace(CLOUD, hz=table.number("cloud_hz", 0, 100, 0.0))
    table.end()
    others = [*SMALL, EVENTS, *([cloud] if cloud.hz else [])]
    left_bytes_per_s = share * conditions.rate_bits_per_s / 8 - sum(one.size_bytes * one.hz for one in others)
    size_bytes = max(_LEAST_JPEG_BYTES, int(left_bytes_per_s / JPEG.hz))
    return [*others, replace(JPEG, size_bytes=size_bytes)]


@dataclass(slots=True)
class _Table:
    """A table of a file, of which each key is read once."""

    path: Path
    lines: Mapping[KeyPath, int]
    values: Mapping[str, object]
    keys: KeyPath = ()
    read: set[str] = field(default_factory=set)

    def left(self) -> list[str]:
        """The keys that nobody has read."""
        return [key for key in self.values if key not in self.read]

    def end(self) -> None:
        """Raise ``ScenarioError`` for a key that nobody has read."""
        for key in self.left():
            known = OBSERVED if self.keys == ("observed",) else (*_UNITS, "blocks_udp")
            raise self.error(key, "means nothing here", remedy=f"known keys: {', '.join(known)}")

    def error(self, key: str, cause: str, remedy: str) -> ScenarioError:
        """An error about a key of the table."""
        keys = (*self.keys, key)
        line = self.lines.get(keys, self.lines.get(self.keys, 1))
        return ScenarioError(f"{'.'.join(keys)} {cause}", place=f"{self.path}:{line}", remedy=remedy)

    def table(self, key: str) -> _Table:
        """The table below a key."""
        self.read.add(key)
        value = self.values.get(key)
        if not isinstance(value, Mapping):
            raise self.error(key, "is no table", remedy=f"write [{key}] and what belongs to it")
        return _Table(self.path, self.lines, value, (*self.keys, key))

    def tables(self, key: str) -> list[_Table]:
        """The tables below a key; none where it is not there."""
        self.read.add(key)
        value = self.values.get(key, [])
        if not isinstance(value, list) or not all(isinstance(one, Mapping) for one in value):
            raise self.error(key, "are no tables", remedy=f"write [[{'.'.join((*self.keys, key))}]] for each")
        return [_Table(self.path, self.lines, one, (*self.keys, key)) for one in value]

    def number(self, key: str, least: float, most: float, default: float | None = None) -> float:
        """A number within limits."""
        self.read.add(key)
        value = self.values.get(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= most:
            wanted = f"from {least:g}" + (f" to {most:g}" if most < float("inf") else "")
            raise self.error(key, f"is no number {wanted}", remedy=f"write {key} = {least:g} or more")
        return value

    def text(self, key: str) -> str:
        """A text."""
        self.read.add(key)
        value = self.values.get(key)
        if not isinstance(value, str):
            raise self.error(key, "is no text", remedy=f'write {key} = "…"')
        return value

    def truth(self, key: str) -> bool:
        """Yes or no."""
        self.read.add(key)
        value = self.values.get(key)
        if not isinstance(value, bool):
            raise self.error(key, "is neither true nor false", remedy=f"write {key} = true")
        return value

    def interval(self, key: str) -> Interval:
        """Two numbers, the lesser first."""
        self.read.add(key)
        value = self.values.get(key)
        if not (
            isinstance(value, list)
            and len(value) == 2
            and all(isinstance(one, (int, float)) for one in value)
            and value[0] <= value[1]
        ):
            raise self.error(key, "is no interval", remedy=f"write {key} = [least, most]")
        return Interval(least=value[0], most=value[1])

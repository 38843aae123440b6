# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles: as a table of topics, for a rule file, and measured."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path, PurePosixPath
from typing import Any

from msgspec import Struct, structs

from smarttestudo.domain.errors import ProfileError, TestudoError, UsageError
from smarttestudo.domain.names import is_topic_name, resolve_topic
from smarttestudo.domain.profile import LevelledProperty, Profile
from smarttestudo.domain.rate import MAX_RATE_HZ
from smarttestudo.files.toml_text import KeyPath, parse_toml
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.optimizer.profiling import proposed_tiers_hz
from smarttestudo.robot.profile import profile_of_robot
from smarttestudo.robot.ros import open_robot
from smarttestudo.ruler.files.project import SettingsFile
from smarttestudo.ruler.files.project_folder import FileKind, ForbiddenPathError, ProjectFolder
from smarttestudo.ruler.files.recordings import READING, BagRequest
from smarttestudo.ruler.job import Limit, Report, TextAnswer, job
from smarttestudo.ruler.topics.vocabulary import topics_in
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
    measured: bool | None = None

    def keys(self) -> dict[str, str | float | Sequence[float] | None]:
        """The keys of the topic's table."""
        return {key: value for key, value in structs.asdict(self).items() if key != "topic"}


class ProfileParseRequest(Struct, frozen=True, kw_only=True):
    """The text of a profile, to be read as a table."""

    text: str
    name: str = "profile.toml"


class ProfileTable(Struct, frozen=True, kw_only=True):
    """The topics of a profile in the order of the text, and its budget in KB/s."""

    rows: tuple[ProfileRow, ...]
    budget_kb_per_s: float | None = None


class ProfileWriteRequest(ProfileTable, frozen=True, kw_only=True):
    """A table to be written: ``base_text`` with the values of the table.

    Comments, order and keys that the table does not show stay. Topics that are not in ``rows`` are removed.
    """

    base_text: str = ""
    name: str = "profile.toml"


class ProfileEntryRequest(Struct, frozen=True, kw_only=True):
    """An entry to be written: ``text`` with ``value`` for ``key`` of ``topic``.

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
    measured = table.get("measured")
    values["measured"] = measured if isinstance(measured, bool) else None
    return ProfileRow(topic=topic, type=_text(table.get("type")), **values)


_NUMBERS = ("message_kb", "source_hz", "priority", "min_hz", "max_hz")
_SIXES = ("tiers_hz", *(key for one in LevelledProperty for key in (one.tiers_key, one.needs_key)))


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None


def _six(value: object) -> SixLevels | None:
    return six_levels([float(one) for one in value]) if isinstance(value, list) else None


def _text(value: object) -> str | None:
    return value if isinstance(value, str) else None


_MAX_PROFILES = 200


class ProfileForRequest(Struct, frozen=True, kw_only=True):
    """A rule file that needs a profile."""

    text: str
    name: str


class ProfileForAnswer(Struct, frozen=True, kw_only=True):
    """The name of a profile of the project; null where none is wanted, or none has to do with the rules.

    ``gone`` is the one that was chosen for the rules, where it is no longer there.
    """

    name: str | None
    gone: str | None = None


class ProfileChosenRequest(Struct, frozen=True, kw_only=True):
    """The profile that the rule file ``name`` goes with, or none."""

    name: str
    profile: str | None


class MeasureLiveRequest(Struct, frozen=True, kw_only=True):
    """A wish for a profile of what the robot's nodes publish now.

    ``run`` names it in the ``Progress`` messages of ``/ws``.
    """

    seconds: float
    run: str = ""


class MeasureRequest(BagRequest, frozen=True, kw_only=True):
    """A bag to be measured; ``run`` names the job in ``Progress`` messages of ``/ws``."""

    run: str = ""


class LevelsRequest(Struct, frozen=True, kw_only=True):
    """A source of ``source_hz`` that needs six levels."""

    source_hz: float


class LevelsAnswer(Struct, frozen=True, kw_only=True):
    """A first guess from the rate alone."""

    tiers_hz: SixLevels


@job("POST /api/profile/for", reads=True)
def choice(request: ProfileForRequest, folder: ProjectFolder, settings: SettingsFile) -> ProfileForAnswer:
    """The profile that somebody chose for the rules; else the one that they are most likely meant for."""
    chosen = settings.read().profiles.get(request.name)
    if chosen is not None and (not chosen or _is_profile(folder, chosen)):
        return ProfileForAnswer(name=chosen or None)
    rules = parse(request.text, request.name)
    return ProfileForAnswer(name=profile_for(request.name, rules, dict(_profiles(folder))), gone=chosen)


@job("PUT /api/profile/for")
def choose(request: ProfileChosenRequest, folder: ProjectFolder, settings: SettingsFile) -> ProfileForAnswer:
    """Remember the profile of a rule file, for everybody who opens the project."""
    for name, kind in ((request.name, FileKind.RULES), (request.profile, FileKind.PROFILE)):
        if name is None:
            continue
        folder.path(name)
        if folder.kind(name) is not kind:
            raise ForbiddenPathError(f"this is no file of {kind.value}", place=name)
    settings.set_profile(request.name, request.profile or "")
    return ProfileForAnswer(name=request.profile)


def _is_profile(folder: ProjectFolder, name: str) -> bool:
    with suppress(TestudoError):
        return folder.kind(name) is FileKind.PROFILE and folder.path(name).is_file()
    return False


def _profiles(folder: ProjectFolder) -> Iterator[tuple[str, Profile]]:
    """The profiles of the project that can be read; other programs have TOML files, too."""
    files, _ = folder.files()
    names = (one.name for one in files if one.kind is FileKind.PROFILE)
    for name in islice(names, _MAX_PROFILES):
        with suppress(TestudoError):
            yield name, parse_profile(folder.read(name).text, Path(name))


@job("POST /api/profile/measure", reads=True, limit=READING)
def measured(request: MeasureRequest, folder: ProjectFolder, report: Report) -> TextAnswer:
    """A profile measured in a bag; ``RecordingError`` where it cannot be read."""
    from smarttestudo.bags.profile import profile_of_recording  # noqa: PLC0415  reads bags
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  most projects have no bag

    with open_recording(folder.bag(request.bag)) as recording:
        return TextAnswer(text=profile_of_recording(recording, name=request.bag, report=report))


def profile_for(name: str, rules: ParseResult, profiles: Mapping[str, Profile]) -> str | None:
    """Of ``profiles``, by name, the one for the rule file ``name``; ``None`` where none has to do with it.

    That is the one of the same name; else the one that knows the most of the rules' topics, of equals one in
    the same folder. Rules without a topic yet are at home in their folder.
    """
    own = PurePosixPath(name)
    topics = {resolve_topic(topic) for topic in topics_in(rules)}

    def merits(candidate: str) -> tuple[bool, int, bool]:
        path = PurePosixPath(candidate)
        is_near = path.parent == own.parent
        return is_near and path.stem == own.stem, len(topics & set(profiles[candidate].topics)), is_near

    best = max(sorted(profiles), key=merits, default=None)
    if best is None:
        return None
    is_namesake, known, is_near = merits(best)
    return best if is_namesake or known > 0 or (is_near and not topics) else None


MAX_SECONDS = 60.0
# For the first topic to be seen, and for the process to begin and end.
_FIRST_TOPIC_S = 5.0
_MARGIN_S = 30.0
_MEASURING = Limit(
    limit_s=2 * (MAX_SECONDS + _FIRST_TOPIC_S) + _MARGIN_S,
    too_long=TestudoError("measuring did not finish", remedy="try fewer seconds"),
    broken=TestudoError("measuring ended without a result", remedy="try testudo profile --seconds"),
)


@job("POST /api/profile/measure-live", limit=_MEASURING)
def measured_on_robots(request: MeasureLiveRequest, report: Report) -> TextAnswer:
    """A profile of what is published now. Raises ``TestudoError`` where nothing can be measured."""
    if not (math.isfinite(request.seconds) and 1 <= request.seconds <= MAX_SECONDS):
        raise UsageError(f"robots are measured for 1 to {MAX_SECONDS:g} s", place="seconds")
    with open_robot(name=f"testudo_ruler_profile_{os.getpid()}") as robot:
        profile = profile_of_robot(
            robot,
            seconds=request.seconds,
            timeout_s=_FIRST_TOPIC_S,
            steady_s=time.monotonic,
            report=report,
        )
    return TextAnswer(text=profile.text)


@job("POST /api/profile/parse", reads=True)
def table_of(request: ProfileParseRequest) -> ProfileTable:
    """A profile as a table."""
    return read_table(request.text, Path(request.name))


@job("POST /api/profile/entry", reads=True)
def with_entry(request: ProfileEntryRequest) -> TextAnswer:
    """The text of a profile with one more entry; ``ProfileError`` where no profile can hold that."""
    path = Path(request.name)
    return TextAnswer(
        text=write_entry(request.text, path, topic=request.topic, key=request.key, value=request.value)
    )


@job("POST /api/profile/write", reads=True)
def written(request: ProfileWriteRequest) -> TextAnswer:
    """A table as a profile."""
    return TextAnswer(text=write_table(request, request.base_text, Path(request.name)))


@job("POST /api/profile/check", reads=True)
def checked(request: ProfileWriteRequest) -> ProfileCheckAnswer:
    """Whether ``written`` would do it, for a table that is being typed."""
    try:
        written(request)
    except ProfileError as error:
        return ProfileCheckAnswer(problem=error.cause)
    return ProfileCheckAnswer(problem="")


@job("POST /api/profile/levels", reads=True)
def levels_of_rate(request: LevelsRequest) -> LevelsAnswer:
    """Six levels to begin with, where nothing but the rate of the source is known."""
    if not 0 < request.source_hz <= MAX_RATE_HZ:
        raise ProfileError(
            f"a source of {request.source_hz:g} Hz has no levels",
            remedy=f"give a rate above 0, up to {MAX_RATE_HZ:g} Hz",
        )
    return LevelsAnswer(tiers_hz=six_levels(proposed_tiers_hz(request.source_hz)))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The profiles of a project: their tables, which one rules are meant for, and new ones from bags."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path

from msgspec import Struct

from smarttestudo.adapters.files.profile import parse_profile
from smarttestudo.adapters.files.project_folder import FileKind, ProjectFolder
from smarttestudo.adirf.parser import parse
from smarttestudo.domain.errors import ProfileError, TestudoError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import MAX_RATE_HZ
from smarttestudo.optimizer.profiling import proposed_tiers_hz
from smarttestudo.use_cases.ruler.edits import TextAnswer
from smarttestudo.use_cases.ruler.profile_choice import profile_for
from smarttestudo.use_cases.ruler.profile_table import (
    ProfileCheckAnswer,
    ProfileParseRequest,
    ProfileTable,
    ProfileWriteRequest,
    SixRates,
    read_table,
    six_rates,
    write_table,
)

_MAX_PROFILES = 200


class ProfileForRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/for`` → ``ProfileForAnswer``: the profile for the rule file ``name``."""

    text: str
    name: str


class ProfileForAnswer(Struct, frozen=True, kw_only=True):
    """The name of a profile of the project; null where none has to do with the rules."""

    name: str | None


class ProfileMeasureRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/measure`` → ``TextAnswer``: a profile measured in a bag of the project."""

    bag: str


class LevelsRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/levels`` → ``LevelsAnswer``: six levels for a source of ``source_hz``."""

    source_hz: float


class LevelsAnswer(Struct, frozen=True, kw_only=True):
    """A first guess from the rate alone."""

    tiers_hz: SixRates


class Profiles:
    """The profiles and bags of ``folder``."""

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder

    def choice(self, request: ProfileForRequest) -> ProfileForAnswer:
        """The profile of the project that rules are most likely meant for."""
        rules = parse(request.text, request.name)
        return ProfileForAnswer(name=profile_for(request.name, rules, dict(self._profiles())))

    def _profiles(self) -> Iterator[tuple[str, Profile]]:
        """The profiles of the project that can be read; other programs have TOML files, too."""
        files, _ = self._folder.files()
        names = (one.name for one in files if one.kind is FileKind.PROFILE)
        for name in islice(names, _MAX_PROFILES):
            with suppress(TestudoError):
                yield name, parse_profile(self._folder.read(name).text, Path(name))

    def measured(self, request: ProfileMeasureRequest) -> TextAnswer:
        """A profile measured in a bag; ``RecordingError`` where it cannot be read."""
        from smarttestudo.adapters.rosbag import open_recording  # noqa: PLC0415  most projects have no bag
        from smarttestudo.use_cases.bags.profile import profile_of_recording  # noqa: PLC0415  reads bags

        with open_recording(self._folder.bag(request.bag)) as recording:
            return TextAnswer(text=profile_of_recording(recording, name=request.bag))


def table_of(request: ProfileParseRequest) -> ProfileTable:
    """A profile as a table."""
    return read_table(request.text, Path(request.name))


def written(request: ProfileWriteRequest) -> TextAnswer:
    """A table as a profile."""
    return TextAnswer(text=write_table(request, request.base_text, Path(request.name)))


def checked(request: ProfileWriteRequest) -> ProfileCheckAnswer:
    """Whether ``written`` would do it, for a table that is being typed."""
    try:
        written(request)
    except ProfileError as error:
        return ProfileCheckAnswer(problem=error.cause)
    return ProfileCheckAnswer(problem="")


def levels_of_rate(request: LevelsRequest) -> LevelsAnswer:
    """Six levels to begin with, where nothing but the rate of the source is known."""
    if not 0 < request.source_hz <= MAX_RATE_HZ:
        raise ProfileError(
            f"a source of {request.source_hz:g} Hz has no levels",
            remedy=f"give a rate above 0, up to {MAX_RATE_HZ:g} Hz",
        )
    return LevelsAnswer(tiers_hz=six_rates(proposed_tiers_hz(request.source_hz)))

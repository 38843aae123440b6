# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Summary of a rule file for the list of files: its load in the worst case, and its last try."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache

from msgspec import Struct

from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.optimizer.model import Model
from smarttestudo.ruler.files.project import SettingsFile
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.side_files import SideFiles
from smarttestudo.ruler.job import job
from smarttestudo.ruler.rules.document import Draft
from smarttestudo.ruler.rules.optimize import SituationKind, optimize_draft, situations_of
from smarttestudo.ruler.topics.profiles import ProfileForRequest, choice

TRIES_FOLDER = ".testudo/tries"
_MAX_CHARACTERS = 200_000
"""What is larger takes longer than anybody looks at a list."""
_TEXTS_KEPT = 256
_MAX_NAME_CHARACTERS = 1000


class FileLoad(Struct, frozen=True, kw_only=True):
    """Load of rules in their worst case, and the budget."""

    kb_per_s: float
    budget_kb_per_s: float


class LastTry(Struct, frozen=True, kw_only=True):
    """The last try of rules: on the recording ``bag``, or on those of a folder, which ends in ``/``.

    ``kb_per_s`` is what was sent of relayed topics, ``percent`` how much less that is than the source. Times
    count since 1970.
    """

    bag: str
    kb_per_s: float
    percent: float
    tried_at_ms: int


class TriedRequest(Struct, frozen=True, kw_only=True):
    """Result of a try of the rule file ``name``; see ``LastTry``."""

    name: str
    bag: str
    kb_per_s: float
    percent: float


class FileSummary(Struct, frozen=True, kw_only=True):
    """Load and last try of a rule file.

    ``load`` is null where the rules have errors or their profile does not say all that it takes.
    """

    load: FileLoad | None
    last_try: LastTry | None


class LastTries:
    """The last try of each rule file of ``folder``; ``now_s`` is the time in seconds since 1970."""

    def __init__(self, folder: ProjectFolder, now_s: Callable[[], float] = time.time) -> None:
        self._files = SideFiles(folder, TRIES_FOLDER, LastTry, "the last try")
        self._now_s = now_s

    def read(self, name: str) -> LastTry | None:
        return self._files.read(name)

    def keep(self, tried: TriedRequest) -> LastTry:
        """Keep a result; ``UsageError`` for one that is none, ``OutputFileError`` where that fails."""
        numbers = (tried.kb_per_s, tried.percent)
        if len(tried.bag) > _MAX_NAME_CHARACTERS or not all(map(math.isfinite, numbers)):
            raise UsageError("this is not the result of a try", place=tried.name)
        tried_at_ms = int(self._now_s() * 1000)
        last = LastTry(bag=tried.bag, kb_per_s=tried.kb_per_s, percent=tried.percent, tried_at_ms=tried_at_ms)
        self._files.write(tried.name, last)
        return last


class FileLoads:
    """Loads of rules, computed once for each text and profile of the last few."""

    def __init__(self) -> None:
        self._load: Callable[[Draft], FileLoad | None] = lru_cache(maxsize=_TEXTS_KEPT)(_load)

    def load(self, draft: Draft) -> FileLoad | None:
        """Load of ``draft`` in its worst case; ``None`` where that cannot be said."""
        return self._load(draft)


def _load(draft: Draft) -> FileLoad | None:
    try:
        optimized = optimize_draft(draft, Model.QUPER, only_named=False)
    except TestudoError:
        return None
    done = optimized.outcome.optimization
    situations = tuple(situations_of(optimized))
    known = [one.kb_per_s for one in situations if one.kind is SituationKind.WORST or not done.feasible]
    return FileLoad(kb_per_s=max(known), budget_kb_per_s=done.budget_kb_per_s) if known else None


@job("GET /api/file/summary")
def summary(
    name: str, folder: ProjectFolder, settings: SettingsFile, loads: FileLoads, tries: LastTries
) -> FileSummary:
    """Load and last try of a rule file as it is on disk."""
    last_try = tries.read(name)
    load = None
    # What cannot be read is said where it is opened.
    with suppress(TestudoError):
        text = folder.read(name).text
        profile = choice(ProfileForRequest(text=text, name=name), folder, settings).name
        if profile is not None and len(text) <= _MAX_CHARACTERS:
            profile_text = folder.read(profile).text
            load = loads.load(Draft(text=text, name=name, profile_text=profile_text, profile_name=profile))
    return FileSummary(load=load, last_try=last_try)


@job("PUT /api/file/tried")
def tried(request: TriedRequest, tries: LastTries) -> LastTry:
    """Remember what the last try of a rule file said, for everybody who opens the project."""
    return tries.keep(request)

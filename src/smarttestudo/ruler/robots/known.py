# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that were heard, kept in the project until somebody removes them."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.record import to_json
from smarttestudo.domain.remote_robots import HeardStatus
from smarttestudo.domain.status import RuntimeStatus, status_from_json
from smarttestudo.files.input_file import read_input
from smarttestudo.files.whole_file import whole_file
from smarttestudo.ruler.files.project_folder import ProjectFolder

KNOWN_FOLDER = ".testudo/robots"
_FILE = f"{KNOWN_FOLDER}/heard.json"
MAX_KNOWN = 500
"""So many robots are known, those that were heard last."""
_MAX_BYTES = 5_000_000
_MAX_STATUS_BYTES = 8000


class KnownRobots:
    """The robots of the project in ``folder``, with when each was heard last.

    ``now_s`` is the time in seconds since 1970, ``steady_s`` the clock of ``HeardStatus.heard_s``.
    """

    def __init__(
        self,
        folder: ProjectFolder,
        steady_s: Callable[[], float] = time.monotonic,
        now_s: Callable[[], float] = time.time,
    ) -> None:
        self._folder = folder
        self._steady_s = steady_s
        self._now_s = now_s

    def read(self) -> dict[str, HeardStatus]:
        """The robots by their ids, as gone; none where nothing is kept, or nothing that can be read."""
        with suppress(OSError, ValueError, RecursionError, TestudoError):
            found = json.loads(read_input(self._folder.path(_FILE), _MAX_BYTES))
            rows = found if isinstance(found, list) else []
            robots = [one for one in map(self._heard, rows[:MAX_KNOWN]) if one is not None]
            return {one.status.robot_id: one for one in robots}
        return {}

    def write(self, robots: Iterable[HeardStatus]) -> None:
        """Keep these robots; ``TestudoError`` or ``OSError`` where that is not possible."""
        since_1970_s = self._now_s() - self._steady_s()
        # The names of runs that are called alike hold as long as both are heard.
        named = [one for one in latest(robots) if "#" not in one.status.robot]
        rows = [(since_1970_s + one.heard_s, to_json(_kept(one.status))) for one in named]
        fitting = [row for row in rows if len(json.dumps(row)) <= _MAX_STATUS_BYTES]
        path = self._folder.path(_FILE)
        if not fitting and not path.exists():
            return
        self._folder.make_unshared(KNOWN_FOLDER)
        with whole_file(path, "the robots that were heard") as write:
            write(f"{json.dumps(fitting)}\n")

    def _heard(self, row: object) -> HeardStatus | None:
        """The robot of a row that anybody may have written."""
        if not isinstance(row, list) or len(row) != len(("heard_at_s", "status")):
            return None
        heard_at_s, record = row
        if not isinstance(heard_at_s, float) or not math.isfinite(heard_at_s):
            return None
        silent_s = max(0.0, self._now_s() - heard_at_s)
        with suppress(ValueError):
            status = _kept(status_from_json(record))
            heard_s = self._steady_s() - silent_s
            return HeardStatus(status=status, heard_s=heard_s, size_bytes=0, is_present=False)
        return None


def latest(robots: Iterable[HeardStatus]) -> list[HeardStatus]:
    """The robots that were heard last, as many as are known."""
    return sorted(robots, key=lambda one: one.heard_s, reverse=True)[:MAX_KNOWN]


def _kept(status: RuntimeStatus) -> RuntimeStatus:
    """The part of a status that stays true of a silent robot: its names, its rules and its budget."""
    nothing: Mapping[str, object] = {}
    return replace(
        status, topics={}, blocks=(), link=None, accepted=(), incidents=None, notices=(), sections=nothing
    )

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fetches the incidents of robots as they come."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryFile

from smarttestudo.domain.errors import said
from smarttestudo.domain.incident import (
    FetchProgress,
    RemoteIncident,
    RemoteIncidents,
    SilentRobotError,
)
from smarttestudo.domain.texts import SayOnce
from smarttestudo.files.whole_file import not_written
from smarttestudo.link.transfer.partial_incident import incident_there, remove_begun_fetches
from smarttestudo.link.worker import Worker

POLL_PERIOD_S = 2.0
STALLED_AFTER_S = 30.0
"""A fetch that got nothing for so long gives way to those from other robots."""
TURN_S = 60.0
"""So does one that began so long ago, to what is newer of its robot, too."""
STARTS_WITHIN_S = 20.0
"""A robot that is connected for less may not answer because its run is still starting."""
_AGAIN_AFTER_POLLS = 30


@dataclass(frozen=True, slots=True, kw_only=True)
class MirrorFolders:
    """Where what rules recorded goes, and where what could not be sent; each in a folder for the robot."""

    incidents: Path | None = None
    outages: Path | None = None

    def of(self, incident: RemoteIncident) -> Path | None:
        """Where an incident goes; ``None`` where it is not wanted."""
        folder = self.outages if incident.is_outage else self.incidents
        return None if folder is None else folder / incident.robot

    def make(self) -> None:
        """Make the folders where there are none, and tidy the others.

        Raises ``OutputFileError`` where one takes no files.

        The first incident may come after hours, and is then better not lost to a typing error.
        """
        for option, folder in (("--incidents", self.incidents), ("--catch-up", self.outages)):
            if folder is None:
                continue
            try:
                folder.mkdir(parents=True, exist_ok=True)
                TemporaryFile(dir=folder).close()
                for of_robot in folder.iterdir():
                    remove_begun_fetches(of_robot)
            except OSError as error:
                raise not_written(folder, f"the folder of {option}", error) from error


class _Turn:
    """A fetch in its time: what arrived, and whether it is another one's turn."""

    def __init__(self, steady_s: Callable[[], float]) -> None:
        self._steady_s = steady_s
        self._began_s = self._progress_s = steady_s()
        self._got_bytes = 0
        self.waits_for = "the robot's answers"

    def note(self, progress: FetchProgress) -> None:
        if progress.got_bytes > self._got_bytes:
            self._got_bytes, self._progress_s = progress.got_bytes, self._steady_s()
        self.waits_for = progress.waits_for or self.waits_for

    @property
    def is_stalled(self) -> bool:
        return self._steady_s() - self._progress_s >= STALLED_AFTER_S

    @property
    def is_long(self) -> bool:
        return self._steady_s() - self._began_s >= TURN_S


class IncidentMirror:
    """Has what robots recorded in ``folders``, the newest first, on a thread of its own while ``running``.

    Robots take turns: a fetch ends where its robot leaves, where nothing comes, and after a minute, and is
    gone on with when what is newer is there. ``say`` is told of each that is whole, ``warn`` of what
    fails or stalls, which is tried again a minute later, or when the robot has come back. That a robot leaves
    is no failure, nor that it does not answer at first. ``steady_s`` is a clock that never jumps.
    """

    def __init__(
        self,
        incidents: RemoteIncidents,
        folders: MirrorFolders,
        say: Callable[[str], None],
        warn: Callable[[str], None],
        *,
        steady_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._incidents = incidents
        self._folders = folders
        self._say = say
        self._warn = SayOnce(warn)
        self._steady_s = steady_s
        self._worker = Worker("link-mirror", lambda error: warn(said(error)), self.poll)
        self._backoff_polls: dict[tuple[str, str], int] = {}
        self._there: frozenset[str] = frozenset()
        self._present_since_s: dict[str, float] = {}
        self._has_more = False

    @contextmanager
    def running(self) -> Iterator[None]:
        """Fetch during the block; what is not whole by then is gone on with by another run."""
        self._worker.start()
        try:
            yield
        finally:
            self._worker.close()

    def poll(self) -> float:
        """Fetch what there is now; after how many seconds to poll again."""
        before, self._there = self._there, frozenset(self._incidents.robots(0))
        now_s = self._steady_s()
        self._present_since_s = {robot: self._present_since_s.get(robot, now_s) for robot in self._there}
        self._backoff_polls = {
            (robot, name): polls - 1
            for (robot, name), polls in self._backoff_polls.items()
            if polls > 1 and (robot in before or robot not in self._there)
        }
        self._has_more = False
        for robot in sorted(self._there):
            self._try(robot, "", partial(self._mirror, robot))
        return 0.0 if self._has_more else POLL_PERIOD_S

    def _mirror(self, robot: str) -> None:
        for incident in sorted(self._incidents.list(robot), key=lambda incident: -incident.triggered_ns):
            folder = self._folders.of(incident)
            if folder is None or incident_there(folder, incident.name) or self._worker.is_closed:
                continue
            turn = _Turn(self._steady_s)
            self._try(robot, incident.name, partial(self._fetch, incident, folder, turn))
            if turn.is_stalled or turn.is_long:
                self._has_more |= turn.is_long
                return

    def _fetch(self, incident: RemoteIncident, folder: Path, turn: _Turn) -> None:
        def is_over() -> bool:
            is_there = incident.robot in self._incidents.robots(0)
            return self._worker.is_closed or not is_there or turn.is_stalled or turn.is_long

        path = self._incidents.fetch(incident.robot, incident.name, folder, turn.note, is_over)
        if path is not None:
            self._say(f"{incident.robot}: {'outage' if incident.is_outage else 'incident'} {path}")
        elif turn.is_stalled and incident.robot in self._incidents.robots(0):
            self._back_off(incident.robot, incident.name, f"waits for {turn.waits_for}")

    def _try(self, robot: str, name: str, act: Callable[[], None]) -> None:
        if (robot, name) in self._backoff_polls or (robot, "") in self._backoff_polls:
            return
        try:
            act()
        except Exception as error:  # noqa: BLE001 - whatever one robot does, others are fetched from
            if robot not in self._incidents.robots(0) or self._may_start(robot, error):
                return
            self._back_off(robot, name, said(error))

    def _may_start(self, robot: str, error: Exception) -> bool:
        """Whether ``error`` may come of a run that is still starting."""
        is_new = self._steady_s() - self._present_since_s[robot] < STARTS_WITHIN_S
        return is_new and isinstance(error, SilentRobotError)

    def _back_off(self, robot: str, name: str, why: str) -> None:
        """Try it again a minute later."""
        self._backoff_polls[robot, name] = _AGAIN_AFTER_POLLS
        self._warn(f"{f'{robot} {name}'.rstrip()}: {why}")

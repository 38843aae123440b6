# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents that robots on a link hold, and fetching them into the project."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from msgspec import Struct

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.incident import FetchProgress, RemoteIncident, RemoteIncidents
from smarttestudo.ruler.files.project_folder import ForbiddenPathError, ProjectFolder
from smarttestudo.ruler.incidents.incidents import told_of_listed
from smarttestudo.ruler.job import job
from smarttestudo.ruler.tries.keep import INCIDENTS_FOLDER

OpenIncidents: TypeAlias = Callable[[], AbstractContextManager[RemoteIncidents]]
"""Joins the link; raises ``LinkError`` where that cannot be."""

MAX_FETCHES = 20
_MAX_SHOWN = 500
_ASKED_AT_ONCE = 8
_STOP_S = 2.0
_KNOWN_WITHIN_S = 1.0
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}\Z")


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentsOfRobot:
    """The newest incidents first; ``problem`` is why they are not known, else empty.

    ``kept`` are those that were fetched, by name, with what the project calls them.
    """

    robot: str
    problem: str
    incidents: tuple[RemoteIncident, ...] = ()
    kept: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotIncidentsAnswer:
    """Incidents of each robot that is heard over the link.

    ``is_linked`` is whether there is a link at all, ``problem`` why it carries nothing, else empty.
    """

    is_linked: bool
    problem: str
    robots: tuple[IncidentsOfRobot, ...]


class RobotIncidentRequest(Struct, frozen=True, kw_only=True):
    """An incident by the name of its robot and its own."""

    robot: str
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchState:
    """How far a fetch is, of which all but what is missing stays when it ends early.

    ``problem`` is why it failed, else empty; ``kept`` what the project calls it once done.
    """

    robot: str
    name: str
    state: Literal["running", "done", "cancelled", "failed"]
    progress: FetchProgress
    problem: str = ""
    kept: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchesAnswer:
    """Fetches that were asked for since the start of the server.

    ``heard`` are the robots that are there now, which costs the link nothing; none before they were asked.
    """

    fetches: tuple[FetchState, ...]
    heard: tuple[str, ...]


class _Fetch:
    """A fetch on a thread of its own."""

    def __init__(self, request: RobotIncidentRequest) -> None:
        progress = FetchProgress(got_bytes=0, total_bytes=0)
        self.state = FetchState(robot=request.robot, name=request.name, state="running", progress=progress)
        self.cancelled = threading.Event()
        self.thread: threading.Thread | None = None

    def note(self, progress: FetchProgress) -> None:
        """How far it is."""
        self.state = replace(self.state, progress=progress)


class RobotIncidents:
    """Incidents of the robots of ``open_incidents``, fetched into ``incidents`` of the project in ``folder``.

    ``open_incidents`` is ``None`` where there is no link; it is called when somebody asks first.
    """

    def __init__(self, folder: ProjectFolder, open_incidents: OpenIncidents | None) -> None:
        self._folder = folder
        self._open = open_incidents
        self._stack = ExitStack()
        self._joined: RemoteIncidents | None = None
        self._lock = threading.Lock()
        self._fetches: dict[tuple[str, str], _Fetch] = {}

    def incidents(self) -> RobotIncidentsAnswer:
        """Ask all robots; one that does not answer costs only itself."""
        if self._open is None:
            return RobotIncidentsAnswer(is_linked=False, problem="", robots=())
        try:
            remote = self._link()
            robots = list(remote.robots(_KNOWN_WITHIN_S))
        except TestudoError as error:
            return RobotIncidentsAnswer(is_linked=True, problem=told_of_listed(error), robots=())
        if not robots:
            return RobotIncidentsAnswer(is_linked=True, problem=remote.problem or "", robots=())
        with ThreadPoolExecutor(_ASKED_AT_ONCE) as asking:
            answered = tuple(asking.map(lambda robot: self._of_robot(remote, robot), robots))
        return RobotIncidentsAnswer(is_linked=True, problem="", robots=answered)

    def fetches(self) -> FetchesAnswer:
        """All that were asked for since the start, each as it is now."""
        with self._lock:
            fetches, remote = tuple(fetch.state for fetch in self._fetches.values()), self._joined
        return FetchesAnswer(fetches=fetches, heard=() if remote is None else tuple(remote.robots(0)))

    def fetch(self, request: RobotIncidentRequest) -> FetchesAnswer:
        """Begin to fetch an incident, or go on with it; it goes on though the page is closed.

        Raises:
            ForbiddenPathError: the project can have no folder of that name.
            LinkError: there is no link.
            TestudoError: too many are being fetched.
        """
        target = self._target(request)
        remote = self._link()
        with self._lock:
            key = (request.robot, request.name)
            running = [one for one in self._fetches.values() if one.state.state == "running"]
            if key not in self._fetches or self._fetches[key] not in running:
                if len(running) >= MAX_FETCHES:
                    remedy = "wait for one of them, or cancel it"
                    raise TestudoError(f"{MAX_FETCHES} incidents are being fetched", remedy=remedy)
                fetch = self._fetches[key] = _Fetch(request)
                fetch.thread = threading.Thread(target=self._run, args=(remote, fetch, target), daemon=True)
                fetch.thread.start()
        return self.fetches()

    def cancel(self, request: RobotIncidentRequest) -> FetchesAnswer:
        """End a fetch; what is there stays, and the next one goes on with it."""
        with self._lock:
            fetch = self._fetches.get((request.robot, request.name))
        if fetch is not None:
            fetch.cancelled.set()
            if fetch.thread is not None:
                fetch.thread.join(_STOP_S)
        return self.fetches()

    def close(self) -> None:
        """End all fetches and leave the link."""
        with self._lock:
            fetches = list(self._fetches.values())
        for fetch in fetches:
            fetch.cancelled.set()
        for fetch in fetches:
            if fetch.thread is not None:
                fetch.thread.join(_STOP_S)
        self._stack.close()

    def _link(self) -> RemoteIncidents:
        with self._lock:
            if self._joined is None:
                if self._open is None:
                    remedy = "start testudo ruler with --connect"
                    raise LinkError("there is no link to a robot", remedy=remedy)
                self._joined = self._stack.enter_context(self._open())
            return self._joined

    def _of_robot(self, remote: RemoteIncidents, robot: str) -> IncidentsOfRobot:
        try:
            found = remote.list(robot)
        except TestudoError as error:
            return IncidentsOfRobot(robot=robot, problem=told_of_listed(error))
        newest = sorted(found, key=lambda one: one.triggered_ns, reverse=True)[:_MAX_SHOWN]
        kept = ((one.name, self._kept(RobotIncidentRequest(robot=robot, name=one.name))) for one in newest)
        return IncidentsOfRobot(
            robot=robot,
            problem="",
            incidents=tuple(newest),
            kept={name: target for name, target in kept if target is not None},
        )

    def _kept(self, request: RobotIncidentRequest) -> str | None:
        try:
            target = self._target(request)
            is_there = (self._folder.path(target) / RECORD_NAME).exists()
        except (TestudoError, OSError):
            return None
        return target if is_there else None

    def _target(self, request: RobotIncidentRequest) -> str:
        """The project's name for an incident of a robot; ``ForbiddenPathError`` where it can have none."""
        if not (_NAME.match(request.robot) and _NAME.match(request.name)):
            raise ForbiddenPathError("this is no name of a robot's incident", place=request.name[:80])
        return f"{INCIDENTS_FOLDER}/{request.robot}/{request.name}"

    def _run(self, remote: RemoteIncidents, fetch: _Fetch, target: str) -> None:
        robot, name = fetch.state.robot, fetch.state.name
        try:
            folder = self._folder.path(target).parent
            path = remote.fetch(robot, name, folder, fetch.note, fetch.cancelled.is_set)
        except TestudoError as error:
            fetch.state = replace(fetch.state, state="failed", problem=told_of_listed(error))
        else:
            done = path is not None
            state: Literal["done", "cancelled"] = "done" if done else "cancelled"
            fetch.state = replace(fetch.state, state=state, kept=target if done else None)


@job("GET /api/robot-incidents")
def robot_incidents(robots: RobotIncidents) -> RobotIncidentsAnswer:
    return robots.incidents()


@job("GET /api/robot-incidents/fetches")
def fetches(robots: RobotIncidents) -> FetchesAnswer:
    return robots.fetches()


@job("POST /api/robot-incidents/fetch")
def fetch(request: RobotIncidentRequest, robots: RobotIncidents) -> FetchesAnswer:
    return robots.fetch(request)


@job("POST /api/robot-incidents/cancel")
def cancel(request: RobotIncidentRequest, robots: RobotIncidents) -> FetchesAnswer:
    return robots.cancel(request)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots' incidents over Zenoh, listed and fetched as the bytes of their names."""

from __future__ import annotations

import secrets
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.incident import FetchProgress, OnProgress, RemoteIncident, SilentRobotError
from smarttestudo.link.protocol.keys import MAX_ROBOTS, Boot
from smarttestudo.link.transfer.fetching import Fetching
from smarttestudo.link.transfer.partial_incident import PartialIncident, incident_there
from smarttestudo.link.transfer.plan import (
    FILES,
    MAX_PLAN_BYTES,
    PLANS,
    TransferPlan,
    is_incident_name,
    list_from_bytes,
    no_incident,
)
from smarttestudo.link.zenoh.queries import QueryClient
from smarttestudo.link.zenoh.transfer import Fetch

_POLL_S = 0.1
_SAVE_S = 0.5
_SAY_S = 0.25
_RATE_SAYS = 12
"""The rate is that of so many times ``_SAY_S``."""
_AGAIN_AFTER_S = 0.05
_AGAIN_WITHIN_S = 3.0
"""A robot that is asked much answers some questions with silence, as does one without incidents."""
_BACK_WITHIN_S = 5.0
"""For so long a robot is waited for that its link lost, maybe for a moment."""
_KNOWN_WITHIN_S = 5.0
_DIGITS = "#"


class LinkIncidents:
    """``RemoteIncidents`` of the robots that ``client`` reaches at ``place``; any thread may call."""

    def __init__(self, client: QueryClient, place: str) -> None:
        self._place = place
        self._client = client
        self._lock = threading.Lock()
        self._present: dict[Boot, None] = {}
        self._seen: set[str] = set()
        self._all_known = threading.Event()
        self._client.begin(self._on_presence, self._all_known.set)

    def robots(self, within_s: float) -> Sequence[str]:
        self._all_known.wait(within_s)
        with self._lock:
            return sorted({boot.robot for boot in self._present})

    @property
    def problem(self) -> str | None:
        return self._client.problem

    def list(self, robot: str) -> Sequence[RemoteIncident]:
        data = self._read(robot, "", lambda: False)
        assert data is not None
        return list_from_bytes(data, robot)

    def fetch(
        self, robot: str, name: str, folder: Path, on_progress: OnProgress, cancelled: Callable[[], bool]
    ) -> Path | None:
        if not is_incident_name(name):
            raise no_incident(name)
        data = self._read(robot, name, cancelled)
        if data is None:
            return None
        plan = PLANS.from_bytes(data)
        if not any(file.name == RECORD_NAME for file in plan.files):
            raise LinkError(
                f"{robot} has no {RECORD_NAME} of it, so there is nothing to fetch",
                place=name,
                remedy="look at its folder on the robot",
            )
        there = incident_there(folder, name, [file.name for file in plan.files])
        if there is not None:
            on_progress(FetchProgress(got_bytes=plan.size_bytes, total_bytes=plan.size_bytes))
            return there
        with PartialIncident(folder, name, plan) as partial_incident:
            fetching = Fetching(
                f"{name}{FILES}",
                secrets.randbits(64),
                version=plan.version,
                offset=partial_incident.cursor,
                total_bytes=plan.order_bytes,
            )
            fetch = Fetch(self._client, partial(self._incidents_key, robot), fetching)
            progress = _Progress(plan, partial_incident, on_progress)
            is_whole = self._save_all(robot, fetch, partial_incident, progress, cancelled)
            return partial_incident.finish() if is_whole else None

    def _save_all(
        self,
        robot: str,
        fetch: Fetch,
        there: PartialIncident,
        progress: _Progress,
        cancelled: Callable[[], bool],
    ) -> bool:
        """Whether all is there; if not, it was ``cancelled``. Raises ``TestudoError``."""
        saved_s = 0.0
        try:
            while not fetch.fetching.is_complete:
                if cancelled():
                    return False
                there.write(fetch.step(_POLL_S))
                if time.monotonic() - saved_s > _SAVE_S:
                    saved_s = time.monotonic()
                    there.save()
                progress.say(self._waits_for(robot, fetch.fetching))
            # That all arrived is said, too.
            fetch.step(0)
        finally:
            there.save()
        progress.say(None)
        return True

    def _incidents_key(self, robot: str) -> str | None:
        boot = self.boot(robot)
        return None if boot is None else boot.incidents_key

    def _waits_for(self, robot: str, fetching: Fetching) -> str | None:
        if self.boot(robot) is None:
            return "the robot, which is not there"
        return "a part of the link that topics leave unused" if fetching.is_unanswered else None

    def close(self) -> None:
        self._client.close()

    def boot(self, robot: str) -> Boot | None:
        """The run of a robot's end that is there, the newest where there are several."""
        name, _, digits = robot.partition(_DIGITS)
        with self._lock:
            found = [boot for boot in self._present if boot.robot == name and boot.number.startswith(digits)]
        return found[-1] if found else None

    def _read(self, robot: str, name: str, cancelled: Callable[[], bool]) -> bytes | None:
        """All bytes of a name, ``None`` if ``cancelled`` before. Raises ``LinkError``."""
        self._all_known.wait(_KNOWN_WITHIN_S)
        fetching = Fetching(name, secrets.randbits(64), most_bytes=MAX_PLAN_BYTES)
        fetch = Fetch(self._client, partial(self._incidents_key, robot), fetching)
        data, since_s, was_there = b"", time.monotonic(), True
        while not fetching.is_complete:
            is_there = self.boot(robot) is not None
            if is_there != was_there:
                was_there, since_s = is_there, time.monotonic()
            waited_s = time.monotonic() - since_s
            if fetching.is_unanswered and is_there and waited_s >= _AGAIN_WITHIN_S:
                raise self._silent(robot)
            if not is_there and (robot.partition(_DIGITS)[0] not in self._seen or waited_s >= _BACK_WITHIN_S):
                raise self._silent(robot)
            if cancelled():
                return None
            if more := fetch.step(_AGAIN_AFTER_S):
                data += more
            elif not fetching.is_complete:
                time.sleep(_AGAIN_AFTER_S)
        return data

    def _silent(self, robot: str) -> LinkError:
        kind, cause = LinkError, self._client.problem
        if cause is None and self.boot(robot) is None:
            cause = f"there is no robot {robot!r:.80}"
        elif cause is None:
            kind, cause = SilentRobotError, f"{robot} does not answer this"
        return kind(
            cause,
            place=self._place,
            remedy="start 'testudo run --link --incidents' on the robot, and see 'testudo top --connect'",
        )

    def _on_presence(self, boot: Boot, is_present: bool) -> None:  # noqa: FBT001 - what a client calls
        with self._lock:
            self._present.pop(boot, None)
            if is_present and len(self._present) < MAX_ROBOTS:
                self._present[boot] = None
                if len(self._seen) < MAX_ROBOTS:
                    self._seen.add(boot.robot)


class _Progress:
    """Progress of a fetch, said now and then."""

    def __init__(self, plan: TransferPlan, there: PartialIncident, on_progress: OnProgress) -> None:
        self._plan = plan
        self._there = there
        self._on_progress = on_progress
        self._said_s = 0.0
        self._history: deque[tuple[float, int]] = deque(maxlen=_RATE_SAYS)

    def say(self, waits_for: str | None) -> None:
        now_s, is_whole = time.monotonic(), self._there.cursor >= self._plan.order_bytes
        if is_whole or now_s - self._said_s >= _SAY_S:
            self._said_s = now_s
            self._history.append((now_s, self._there.got_bytes))
            self._on_progress(self._progress(None if is_whole else waits_for))

    def _progress(self, waits_for: str | None) -> FetchProgress:
        got_bytes, cursor = self._there.got_bytes, self._there.cursor
        reached = [level.rate_hz for level in self._plan.levels if level.end <= cursor]
        (first_s, first), (last_s, last) = self._history[0], self._history[-1]
        return FetchProgress(
            got_bytes=got_bytes,
            total_bytes=self._plan.size_bytes,
            rate_bytes_per_s=(last - first) / (last_s - first_s) if last_s > first_s else 0.0,
            level_hz=reached[-1] if reached else None,
            waits_for=waits_for,
        )

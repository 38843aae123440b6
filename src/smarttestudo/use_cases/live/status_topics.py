# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses on the ROS graph: published by a runtime as often as requested, received by its observers."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace

from smarttestudo.adapters.json.status import status_from_text, status_to_json
from smarttestudo.domain.errors import RosError, said
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.use_cases.live.diagnostics import diagnostics
from smarttestudo.use_cases.live.status import STATUS_HZ

STATUS_TOPIC = "/testudo/status"
STATUS_QOS = Qos(reliable=True, transient_local=True, depth=1)
DIAGNOSTICS_TOPIC = "/diagnostics"

_Announce = Callable[[RuntimeStatus], None]


class StatusPublisher:
    """Publishes a status on ``STATUS_TOPIC`` and as diagnostics; if one of them fails, it is logged once."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._text = self._opened(_as_text)
        self._diagnostics = self._opened(_as_diagnostics)

    def announce(self, status: RuntimeStatus, *, diagnostics_too: bool = True) -> None:
        """Publish ``status``; as diagnostics only with a subscriber, since they are not latched."""
        self._text = self._said(self._text, status)
        if diagnostics_too and self._robot.subscriber_count(DIAGNOSTICS_TOPIC):
            self._diagnostics = self._said(self._diagnostics, status)

    def _opened(self, way: Callable[[Robot], _Announce]) -> _Announce | None:
        try:
            return way(self._robot)
        except RosError as error:
            self._robot.log.warning(str(error))
            return None

    def _said(self, way: _Announce | None, status: RuntimeStatus) -> _Announce | None:
        """``way`` as long as it works."""
        try:
            if way is not None:
                way(status)
        except Exception as error:  # noqa: BLE001 - whatever publishing fails of, relaying goes on
            self._robot.log.warning(f"{said(error)}; nothing more is published there")
            return None
        return way


def _as_text(robot: Robot) -> _Announce:
    publish = robot.text_publisher(STATUS_TOPIC, STATUS_QOS)
    return lambda status: publish(json_text(status_to_json(status), ascii_only=False))


def _as_diagnostics(robot: Robot) -> _Announce:
    publish = robot.diagnostics_publisher(DIAGNOSTICS_TOPIC)
    return lambda status: publish(diagnostics(status))


_TEXT_TYPE = "std_msgs/msg/String"
# Several nodes may publish between two looks, and all share one queue.
_QOS = replace(STATUS_QOS, depth=100)


@dataclass(frozen=True, slots=True, kw_only=True)
class HeardStatus:
    """The last status of one SmartTestudo node, when it was received, and the size of its message."""

    status: RuntimeStatus
    heard_s: float
    size_bytes: int


class StatusWatch:
    """Subscribes to ``STATUS_TOPIC``; ``steady_s`` is a clock that never jumps. Raises ``RosError``.

    ``unreadable`` counts what came there and was no status of this version.
    """

    def __init__(self, robot: Robot, steady_s: Callable[[], float]) -> None:
        self.heard: dict[str, HeardStatus] = {}
        self.unreadable = 0
        self._robot = robot
        self._steady_s = steady_s
        robot.data_path.subscribe(STATUS_TOPIC, _TEXT_TYPE, _QOS, self._receive)

    @property
    def has_heard_all(self) -> bool:
        """Whether there is a SmartTestudo node, and a status of each discovered one was received."""
        # `testudo receive` publishes those of several robots, so the names of nodes do not tell.
        return 0 < len(self.heard) >= len(self._robot.publishers(STATUS_TOPIC))

    def _receive(self, payload: Payload, _publisher: Hashable) -> None:
        try:
            message = self._robot.data_path.decode(STATUS_TOPIC, _TEXT_TYPE, payload)
            status = status_from_text(getattr(message, "data", ""))
        except (RosError, ValueError):
            self.unreadable += 1
            return
        self.heard[status.node] = HeardStatus(
            status=status, heard_s=self._steady_s(), size_bytes=len(payload)
        )


# Status publishing is capped at a fifth of a core: messages come first.
_TIMES_ITS_COST = 5
# A period of one second is met by timers that are a little early.
_DIAGNOSIS_AFTER_NS = NS_PER_S * 9 // 10


class StatusTimer:
    """Once a second, or ``asked_hz`` times with a subscriber; diagnostics once a second in any case.

    So a requested rate ends with its subscriber.
    """

    def __init__(self, robot: Robot) -> None:
        self.asked_hz = STATUS_HZ
        self._robot = robot
        self._diagnosed_ns: int | None = None

    @property
    def period_s(self) -> float:
        """The time from one status to the next."""
        return 1 / self.status_hz

    @property
    def status_hz(self) -> float:
        """How often a status comes now."""
        if self.asked_hz > STATUS_HZ and not self._robot.subscriber_count(STATUS_TOPIC):
            return STATUS_HZ
        return self.asked_hz

    def is_diagnosis_due(self, steady_ns: int) -> bool:
        """Whether the status of now is one for diagnostics, too; asked once for each."""
        if self._diagnosed_ns is not None and steady_ns < self._diagnosed_ns + _DIAGNOSIS_AFTER_NS:
            return False
        self._diagnosed_ns = steady_ns
        return True

    def next_s(self, cost_ns: int) -> float:
        """In how many seconds to publish again, if publishing took ``cost_ns`` of CPU time."""
        return max(self.period_s, min(cost_ns * _TIMES_ITS_COST / NS_PER_S, 1 / STATUS_HZ))

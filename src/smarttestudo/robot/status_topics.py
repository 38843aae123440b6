# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The statuses of a runtime, told as often as requested: on the ROS graph and over a link."""

from __future__ import annotations

from collections.abc import Callable

from smarttestudo.domain.errors import RosError, said
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.link import OutgoingLink
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.record import to_json
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.domain.status import STATUS_HZ, RuntimeStatus
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.diagnostics import diagnostics

STATUS_QOS = Qos(reliable=True, transient_local=True, depth=1)
DIAGNOSTICS_TOPIC = "/diagnostics"

_Announce = Callable[[RuntimeStatus], None]


class StatusPublisher:
    """Publishes a status on ``STATUS_TOPIC``, over ``link`` and as diagnostics.

    If one of them fails, it is logged once.
    """

    def __init__(self, robot: Robot, link: OutgoingLink | None = None) -> None:
        self._robot = robot
        self._text = self._opened(_as_text)
        self._linked: _Announce | None = None if link is None else link.tell
        self._diagnostics = self._opened(_as_diagnostics)

    def announce(self, status: RuntimeStatus, *, diagnostics_too: bool = True) -> None:
        """Publish ``status``; as diagnostics only with a subscriber, since they are not latched."""
        self._text = self._said(self._text, status)
        self._linked = self._said(self._linked, status)
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
    publish = robot.text_publisher(STATUS_TOPIC, STATUS_QOS, goes_over_link=False)
    return lambda status: publish(json_text(to_json(status), ascii_only=False))


def _as_diagnostics(robot: Robot) -> _Announce:
    publish = robot.diagnostics_publisher(DIAGNOSTICS_TOPIC)
    return lambda status: publish(diagnostics(status))


# Status publishing is capped at a fifth of a core: messages come first.
_TIMES_ITS_COST = 5
# A period of one second is met by timers that are a little early.
_DIAGNOSIS_AFTER_NS = NS_PER_S * 9 // 10


class StatusTimer:
    """Once a second, or ``asked_hz`` times where somebody receives them; diagnostics once a second.

    So a requested rate ends with its subscriber.
    """

    def __init__(self, robot: Robot, link: OutgoingLink | None = None) -> None:
        self._link = link
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
        return self.asked_hz if self.asked_hz <= STATUS_HZ or self._is_watched else STATUS_HZ

    @property
    def _is_watched(self) -> bool:
        return (self._link is not None and self._link.is_watched) or bool(
            self._robot.subscriber_count(STATUS_TOPIC)
        )

    def is_diagnosis_due(self, steady_ns: int) -> bool:
        """Whether the status of now is one for diagnostics, too; asked once for each."""
        if self._diagnosed_ns is not None and steady_ns < self._diagnosed_ns + _DIAGNOSIS_AFTER_NS:
            return False
        self._diagnosed_ns = steady_ns
        return True

    def next_s(self, cost_ns: int) -> float:
        """In how many seconds to publish again, if publishing took ``cost_ns`` of CPU time."""
        return max(self.period_s, min(cost_ns * _TIMES_ITS_COST / NS_PER_S, 1 / STATUS_HZ))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop, driven by what arrives, what the graph shows and the time between."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping

from smarttestudo.adapters.files.own_process import read_own_process
from smarttestudo.composition.live_decisions import LiveDecisions
from smarttestudo.composition.live_status import LiveStatus
from smarttestudo.composition.live_topics import LiveTopics
from smarttestudo.composition.status_announcer import StatusAnnouncer
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import RulesInForce
from smarttestudo.runtime.execute.relay import Relayed
from smarttestudo.runtime.relay_loop import RelayLoop

LOOK_PERIOD_S = 0.2
STATUS_PERIOD_S = 1.0


class LiveRun:
    """Drives a loop in the node's time. ``monitored`` is the monitored topic of each relayed one."""

    def __init__(
        self,
        robot: Robot,
        loop: RelayLoop,
        monitored: Mapping[str, str],
        decisions: LiveDecisions,
        rules: RulesInForce,
    ) -> None:
        self._robot = robot
        self._loop = loop
        self._decisions = decisions
        self._rules = rules
        self._topics = LiveTopics(robot, monitored, loop.watched, self._receive)
        self._status = LiveStatus(robot.name, read_own_process())
        self._announcer = StatusAnnouncer(robot)

    def drive(self, stopped: Callable[[], bool]) -> None:
        """Until ``stopped``."""
        self._robot.every(LOOK_PERIOD_S, self._look)
        self._robot.every(STATUS_PERIOD_S, self._tell)
        while not stopped():
            self._report()
            self._robot.wait(self._loop.next_wake_ns, LOOK_PERIOD_S)
            now_ns, wake_ns = self._robot.now_ns(), self._loop.next_wake_ns
            if wake_ns is not None and wake_ns <= now_ns:
                self._publish(self._loop.on_wake(now_ns))
        self._report()

    def _receive(self, topic: str, payload: Payload, publisher: Hashable) -> None:
        message = self._topics.decoded(topic, payload) if self._loop.reads(topic) else None
        now_ns = self._robot.now_ns()
        self._publish(
            self._loop.on_message(topic, now_ns, payload, len(payload), message=message, publisher=publisher)
        )

    def _look(self) -> None:
        # What is due goes out before a topic is opened anew, perhaps with another type.
        now_ns = self._robot.now_ns()
        self._publish(self._loop.on_wake(now_ns))
        for change in self._topics.look():
            self._publish(self._loop.on_source(change, now_ns))

    def _publish(self, relayed: Iterable[Relayed]) -> None:
        for one in relayed:
            self._topics.publish(one)
            self._status.note(one)

    def _tell(self) -> None:
        links, now_ns = self._topics.links(), self._robot.now_ns()
        status = self._status.look(self._loop, links, self._rules, read_own_process(), now_ns)
        self._announcer.announce(status)

    def _report(self) -> None:
        self._decisions.report(self._loop.take_decisions())

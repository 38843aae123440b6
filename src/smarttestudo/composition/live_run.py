# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop, driven by what arrives, what the graph shows and the time between."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable

from smarttestudo.adapters.files.own_process import read_own_process
from smarttestudo.composition.input_recorder import InputRecorder
from smarttestudo.composition.live_decisions import LiveDecisions
from smarttestudo.composition.live_rules import LiveRules
from smarttestudo.composition.live_status import LiveStatus
from smarttestudo.composition.live_topics import LiveTopics
from smarttestudo.composition.status_announcer import StatusAnnouncer
from smarttestudo.domain.observation import LinkBudget
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Robot
from smarttestudo.runtime.execute.relay import Relayed

LOOK_PERIOD_S = 0.2
STATUS_PERIOD_S = 1.0


class LiveRun:
    """Drives a loop, which follows ``rules``, in the node's time."""

    def __init__(
        self, robot: Robot, inputs: InputRecorder, rules: LiveRules, decisions: LiveDecisions
    ) -> None:
        self._robot = robot
        self._inputs = inputs
        self._loop = loop = inputs.loop(rules, robot.now_ns())
        self._decisions = decisions
        self._rules = rules
        self._topics = LiveTopics(robot, rules.monitored, loop.watched, self._receive)
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

    def reload(self, rules: LiveRules) -> None:
        """Let other rules hold; to be called between two messages, that is, within ``Robot.wait``."""
        self._rules, now_ns = rules, self._robot.now_ns()
        self._inputs.note_rules(rules, now_ns)
        self._publish(self._loop.reload(rules.rule_set, rules.profile, now_ns))
        self._topics.follow(rules.monitored, self._loop.watched)
        self._look()

    def set_budget(self, budget_kb_per_s: float) -> None:
        """The relayed topics may take so much from now on."""
        budget = LinkBudget(link_kb_per_s=budget_kb_per_s)
        self._publish(self._loop.on_budget(budget, self._robot.now_ns()))

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
        status = self._status.look(self._loop, links, self._rules.in_force, read_own_process(), now_ns)
        self._announcer.announce(status)

    def _report(self) -> None:
        self._decisions.report(self._loop.take_decisions())

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop, driven by what arrives, what the graph shows and the time between."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable

from smarttestudo.adapters.files.own_process import read_own_process
from smarttestudo.composition.input_recorder import InputRecorder
from smarttestudo.composition.live_decisions import LiveDecisions
from smarttestudo.composition.live_losses import LiveLosses
from smarttestudo.composition.live_rules import LiveRules
from smarttestudo.composition.live_sampling import LiveSampling
from smarttestudo.composition.live_status import LiveStatus
from smarttestudo.composition.live_topics import LiveTopics
from smarttestudo.composition.status_announcer import StatusAnnouncer
from smarttestudo.composition.status_pulse import StatusPulse
from smarttestudo.domain.observation import LinkBudget
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import RulesInForce
from smarttestudo.runtime.execute.relay import Relayed

LOOK_PERIOD_S = 0.2


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
        self._topics = LiveTopics(robot, self._receive, self._priority_of, is_lazy=not inputs.is_recording)
        self._topics.follow(rules.monitored, loop.watched, loop.leaders)
        robot.log.info(f"Data path: {robot.data_path.description}")
        self._losses = LiveLosses(robot.log)
        self._sampling = LiveSampling(loop)
        self._status = LiveStatus(robot.name, read_own_process())
        self._announcer = StatusAnnouncer(robot)
        self._pulse = StatusPulse(robot)
        self._standing: Callable[[], RulesInForce] = lambda: self._rules.in_force

    def drive(self, stopped: Callable[[], bool]) -> None:
        """Until ``stopped``."""
        self._robot.every(LOOK_PERIOD_S, self._look)
        self._robot.every(self._pulse.period_s, self._tell)
        while not stopped():
            self._report()
            self._robot.wait(self._wake_ns, LOOK_PERIOD_S)
            self._wake()
        self._report()

    def reload(self, rules: LiveRules) -> None:
        """Let other rules hold; to be called between two messages, that is, within ``Robot.wait``."""
        self._rules, now_ns = rules, self._robot.now_ns()
        self._inputs.note_rules(rules, now_ns)
        self._publish(self._loop.reload(rules.rule_set, rules.profile, now_ns))
        self._topics.follow(rules.monitored, self._loop.watched, self._loop.leaders)
        self._look()

    def set_budget(self, budget_kb_per_s: float) -> None:
        """The relayed topics may take so much from now on."""
        budget = LinkBudget(link_kb_per_s=budget_kb_per_s)
        self._publish(self._loop.on_budget(budget, self._robot.now_ns()))

    def set_status_hz(self, status_hz: float) -> None:
        """Tell what goes on so often from now on, as long as somebody listens."""
        self._pulse.asked_hz = status_hz

    def ask_standing(self, standing: Callable[[], RulesInForce]) -> None:
        """Have ``standing`` say how the rules came to hold."""
        self._standing = standing

    def _priority_of(self, topic: str) -> float:
        return self._loop.profile.topic(topic).priority

    @property
    def _wake_ns(self) -> int | None:
        loop_ns, sampling_ns = self._loop.next_wake_ns, self._sampling.wake_ns
        if loop_ns is None or sampling_ns is None:
            return sampling_ns if loop_ns is None else loop_ns
        return min(loop_ns, sampling_ns)

    def _wake(self) -> None:
        now_ns = self._robot.now_ns()
        wake_ns = self._loop.next_wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            self._publish(self._loop.on_wake(now_ns))
        wake_ns = self._sampling.wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            self._sampling.on_wake(now_ns)

    def _receive(self, topic: str, payload: Payload, publisher: Hashable) -> None:
        message = self._topics.decoded(topic, payload) if self._loop.reads(topic) else None
        self._sampling.received(topic, len(payload))
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
        self._sampling.look(self._topics.inlets_of_one(), now_ns)
        self._losses.look(self._topics.inlets(), now_ns)

    def _publish(self, relayed: Iterable[Relayed]) -> None:
        for one in relayed:
            self._topics.publish(one)
            self._status.note(one)

    def _tell(self) -> float:
        process, now_ns = read_own_process(), self._robot.now_ns()
        self._publish(self._loop.on_wake(now_ns))
        status = self._status.look(
            self._loop,
            self._topics.links(),
            self._standing(),
            process,
            now_ns,
            status_hz=self._pulse.status_hz,
        )
        self._announcer.announce(status, diagnostics_too=self._pulse.is_diagnosis_due(process.steady_ns))
        return self._pulse.next_s(read_own_process().cpu_ns - process.cpu_ns)

    def _report(self) -> None:
        decisions = self._loop.take_decisions()
        if decisions:
            self._decisions.report(decisions)
            self._sampling.look(self._topics.inlets_of_one(), self._robot.now_ns())

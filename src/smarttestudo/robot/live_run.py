# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop, driven by messages, changes of the graph and time."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import replace

from smarttestudo.domain.command import IncomingCommands
from smarttestudo.domain.errors import said
from smarttestudo.domain.link import OutgoingLink
from smarttestudo.domain.observation import LinkBudget
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import RulesInForce, RuntimeStatus
from smarttestudo.files.own_process import read_own_process
from smarttestudo.loop.inputs import ChangeInput, LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.robot.command_subscribers import CommandSubscribers
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.incidents import LiveIncidents
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.link_watch import LINK_PERIOD_S, LinkWatch
from smarttestudo.robot.losses import LiveLosses
from smarttestudo.robot.outages import LiveOutages
from smarttestudo.robot.rules import LiveRules
from smarttestudo.robot.sampling import LiveSampling
from smarttestudo.robot.status import LiveStatus
from smarttestudo.robot.status_topics import StatusPublisher, StatusTimer
from smarttestudo.robot.topics import LiveTopics

Told = Callable[[RuntimeStatus], None]
"""Takes each status; it may not fail."""

LOOK_PERIOD_S = 0.2
"""How often to check whether to stop, and whether rules changed."""


class LiveRun:
    """Drives a loop, which follows ``rules``, in the node's time."""

    def __init__(
        self,
        robot: Robot,
        inputs: InputRecorder,
        rules: LiveRules,
        decisions: LiveDecisions,
        link: OutgoingLink | None = None,
        *,
        incidents: LiveIncidents,
        outages: LiveOutages | None = None,
        commands: IncomingCommands | None = None,
        told: Told | None = None,
    ) -> None:
        self._robot = robot
        self._inputs = inputs
        now_ns = robot.now_ns()
        self._loop = loop = inputs.loop(rules, now_ns)
        self._incidents = incidents
        incidents.follow(rules, now_ns)
        incidents.watch(loop)
        self._decisions = decisions
        self._rules = rules
        self._outages = outages
        is_lazy = not inputs.is_recording and outages is None
        self._topics = LiveTopics(robot, self._receive, self._priority_of, is_lazy=is_lazy)
        self._follow(rules)
        robot.log.info(f"Data path: {robot.data_path.description}")
        self._link = None if link is None else LinkWatch(link)
        self._acceptance = None if commands is None else CommandSubscribers(robot, commands)
        self._losses = LiveLosses(robot.log)
        self._sampling = LiveSampling(loop, may_rest=not inputs.is_recording)
        self._status = LiveStatus(robot.name, read_own_process())
        self._publisher = StatusPublisher(robot, link)
        self._timer = StatusTimer(robot, link)
        self._also_told = told
        self._has_failed_to_tell = False
        self._standing: Callable[[], RulesInForce] = lambda: self._rules.in_force

    def drive(self, stopped: Callable[[], bool]) -> None:
        """Until ``stopped``."""
        self._robot.look_at_graph(self._look)
        self._robot.every(self._timer.period_s, self._tell)
        if self._link is not None:
            self._robot.every(LINK_PERIOD_S, self._look_at_link)
        try:
            while not stopped():
                self._report()
                self._robot.wait(self._wake_ns, LOOK_PERIOD_S)
                self._wake()
            self._report()
        finally:
            if self._acceptance is not None:
                # What operators send is published by another thread, which must not outlive the node.
                self._acceptance.close()

    def reload(self, rules: LiveRules) -> None:
        """Put other rules in force; to be called between two messages, that is, within ``Robot.wait``."""
        now_ns = self._robot.now_ns()
        # What is due by the rules before this is theirs.
        self._take(WakeInput(stamp_ns=now_ns))
        self._rules = rules
        self._incidents.follow(rules, now_ns)
        self._take(RulesInput(stamp_ns=now_ns, rule_set=rules.rule_set, profile=rules.profile))
        self._follow(rules)
        self._look(has_changed=True)

    def set_budget(self, budget_kb_per_s: float) -> None:
        """Set the budget of all relayed topics."""
        budget = LinkBudget(link_kb_per_s=budget_kb_per_s)
        self._take(ChangeInput(stamp_ns=self._robot.now_ns(), change=budget))

    def set_status_hz(self, status_hz: float) -> None:
        """Publish the status so often from now on, while it has a subscriber."""
        self._timer.asked_hz = status_hz

    def ask_standing(self, standing: Callable[[], RulesInForce]) -> None:
        """Have ``standing`` called for the origin of the rules in force."""
        self._standing = standing

    def _follow(self, rules: LiveRules) -> None:
        loop, recorded = self._loop, self._incidents.topics
        self._given = frozenset((*rules.output_topics, *loop.knowledge.watched))
        self._topics.follow(
            rules.output_topics, loop.knowledge.watched, loop.relays.leaders, recorded=recorded
        )

    def _priority_of(self, topic: str) -> float:
        return self._loop.knowledge.profile.topic(topic).priority

    @property
    def _wake_ns(self) -> int | None:
        wakes_ns = (self._loop.next_wake_ns, self._sampling.wake_ns, self._incidents.wake_ns)
        return min((wake_ns for wake_ns in wakes_ns if wake_ns is not None), default=None)

    def _wake(self) -> None:
        now_ns = self._robot.now_ns()
        wake_ns = self._loop.next_wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            self._take(WakeInput(stamp_ns=now_ns))
        wake_ns = self._sampling.wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            self._sampling.on_wake(now_ns)
        self._incidents.advance(now_ns)

    def _receive(self, topic: str, payload: Payload, publisher: Hashable) -> None:
        now_ns = self._robot.now_ns()
        self._incidents.take(topic, payload, publisher, now_ns, self._topics.subscription(topic))
        if topic not in self._given:
            return
        message = self._topics.decoded(topic, payload) if self._loop.needs_decoded(topic) else None
        self._sampling.received(topic, len(payload))
        self._take(MessageInput(now_ns, topic, payload, len(payload), message, publisher))

    def _look(self, has_changed: bool) -> None:  # noqa: FBT001 - what a robot calls
        # What is due goes out before a topic is opened anew, perhaps with another type.
        now_ns = self._robot.now_ns()
        self._take(WakeInput(stamp_ns=now_ns))
        for change in self._topics.look(has_changed=has_changed):
            if change.topic in self._given:
                self._take(ChangeInput(stamp_ns=now_ns, change=change))
        for topic, source in self._topics.heard():
            self._incidents.hear(topic, source, now_ns)
            if self._outages is not None:
                self._outages.hear(topic, source)
        for heard in self._topics.listeners():
            self._take(ChangeInput(stamp_ns=now_ns, change=heard))
        self._sampling.look(self._topics.pausable(), now_ns)
        self._losses.look(self._topics.subscriptions(), now_ns)
        if self._acceptance is not None:
            is_connected = self._link is not None and self._link.state.is_connected
            self._acceptance.look(set(self._rules.output_topics.values()), is_connected=is_connected)

    def _look_at_link(self) -> None:
        assert self._link is not None
        if self._outages is not None:
            self._outages.look(self._rules.rules_hash, is_connected=self._link.state.is_connected)
        now_ns = self._robot.now_ns()
        # What is due goes out before a picture begins anew, of which it is no part.
        self._take(WakeInput(stamp_ns=now_ns))
        plan = self._loop.knowledge.plan
        for change in self._link.changed_receivers(self._rules, plan, self._topics.heard_here()):
            self._take(ChangeInput(stamp_ns=now_ns, change=change))
        self._link.tell_pictures(self._rules, plan, self._loop.relays.pictures)
        self._link.follow(self._rules, plan)
        budget = self._link.changed_budget(self._robot.steady_ns())
        if budget is not None:
            self._take(ChangeInput(stamp_ns=self._robot.now_ns(), change=budget))

    def _take(self, given: LoopInput) -> None:
        self._inputs.record(given, self._rules)
        relayed = self._loop.take(given)
        if relayed and self._link is not None:
            loop = self._loop
            self._link.tell_pictures(self._rules, loop.knowledge.plan, loop.relays.pictures)
        for one in relayed:
            if self._outages is None:
                self._topics.publish(one)
            else:
                self._outages.publish(one, self._topics.publish)
            self._status.note(one)

    def _tell(self) -> float:
        self._take(WakeInput(stamp_ns=self._robot.now_ns()))
        try:
            return self._told()
        except Exception as error:  # noqa: BLE001 - whatever publishing fails of, relaying goes on
            if not self._has_failed_to_tell:
                self._has_failed_to_tell = True
                self._robot.log.warning(f"{said(error)}; some statuses are missing")
            return self._timer.period_s

    def _told(self) -> float:
        """Publish the status; returns in how many seconds to do so again."""
        process, now_ns = read_own_process(), self._robot.now_ns()
        status = self._status.look(
            self._loop,
            self._topics.links(),
            self._standing(),
            process,
            now_ns,
            status_hz=self._timer.status_hz,
        )
        status = replace(status, incidents=self._incidents.state())
        if self._link is not None:
            status = self._link.added_to(status)
        if self._acceptance is not None:
            status = replace(status, accepted=self._acceptance.topics)
        if self._also_told is not None:
            self._also_told(status)
        self._publisher.announce(status, diagnostics_too=self._timer.is_diagnosis_due(process.steady_ns))
        return self._timer.next_s(read_own_process().cpu_ns - process.cpu_ns)

    def _report(self) -> None:
        decisions = self._loop.take_decisions()
        if decisions:
            self._decisions.report(decisions)
            self._sampling.look(self._topics.pausable(), self._robot.now_ns())

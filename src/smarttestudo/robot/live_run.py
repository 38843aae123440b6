# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop, driven by messages, changes of the graph and time."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.compiled_relay import MessageCopy
from smarttestudo.domain.errors import error_at
from smarttestudo.domain.observation import ClockJumped, LinkBudget
from smarttestudo.domain.robot import GraphChange, Instant, PausableSubscription, Payload, Robot
from smarttestudo.domain.status import RulesInForce, RuntimeStatus
from smarttestudo.domain.texts import SayOnce
from smarttestudo.files.own_process import read_own_process
from smarttestudo.loop.block_states import BlockStates
from smarttestudo.loop.inputs import ChangeInput, GraphInput, LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.reload import RuleExchange
from smarttestudo.robot.clock_jumps import ClockJumps
from smarttestudo.robot.compiled_topics import CompiledTopics
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.part import Part
from smarttestudo.robot.sampling import LiveSampling, SampledTopic
from smarttestudo.robot.source import LiveSource
from smarttestudo.robot.status import LiveStatus, doubt_lines
from smarttestudo.robot.status_topics import StatusPublisher, StatusReporter, StatusTimer
from smarttestudo.robot.topic import Topic
from smarttestudo.robot.topics import LiveTopics

if TYPE_CHECKING:
    from smarttestudo.domain.link import OutgoingLink

POLL_PERIOD_S = 0.2
"""How often to check whether to stop, and whether rules changed."""


class LiveRun:
    """Drives a loop, which follows ``rules``, in the node's time, with ``parts`` beside it.

    ``topics`` are those of the rules and of the parts, by their names.
    """

    def __init__(
        self,
        robot: Robot,
        inputs: InputRecorder,
        rules: LiveRules,
        decisions: LiveDecisions,
        *,
        parts: Sequence[Part] = (),
        link: OutgoingLink | None = None,
    ) -> None:
        self._robot = robot
        self._inputs = inputs
        now_ns = robot.now_ns()
        self._warn_once = SayOnce(robot.log.warning)
        self._clock = ClockJumps(robot)
        self.loop = loop = inputs.loop(rules, now_ns)
        self._parts = parts
        self._on_message = [part.on_message for part in parts if _does(part, "on_message")]
        self._before_relays = [part.before_relays for part in parts if _does(part, "before_relays")]
        self._publishing = [part for part in parts if _does(part, "before_publish")]
        self._waking = [part for part in parts if _does(part, "on_wake")]
        self._decisions = decisions
        self._outcomes: list[ActionDecision] = []
        self.rules = rules
        self._follow_parts(now_ns)
        for part in parts:
            part.begin(self)
        self._follow_loop(())
        is_lazy = not inputs.is_recording and not any(part.needs_every_message for part in parts)
        self.topics: dict[str, Topic] = {}
        self._graph = LiveTopics(robot, self.topics, self._receive, self._priority_of, is_lazy=is_lazy)
        needs_all = any(_does(part, "on_message") and not part.receives_topics_only for part in parts)
        relays = None if needs_all or inputs.is_recording else robot.data_path.compiled
        self._sees_passed = bool(self._before_relays or self._publishing)
        """Whether a part sees what is published, so that no compiled relay publishes it."""
        copy_passed = self._relay_copy if self._sees_passed else None
        self._compiled = CompiledTopics(relays, loop, self._relay, copy_passed)
        may_pause = robot.data_path.can_pause and not inputs.is_recording
        self._sampling = LiveSampling(loop, may_pause=may_pause)
        self._jumps: list[tuple[int, int]] = []
        """How far ahead the clock jumped, and to when, where compiled relays still count that as time."""
        self._decided_by: object = None
        """By what all topics were given to compiled relays that may be: the same gives the same."""
        self._follow(rules)
        robot.log.info(f"Data path: {robot.data_path.description}")
        self._status = LiveStatus(robot.name, read_own_process())
        self._standing: Callable[[], RulesInForce] = lambda: self.rules.in_force
        self.on_graph: Callable[[], None] | None = None
        """What is called after each poll of the graph."""
        self._timer = StatusTimer(robot, link, needs_all=any(_does(part, "on_status") for part in parts))
        publisher = StatusPublisher(robot, link)
        self._reporter = StatusReporter(robot, publisher, self._timer, self._measure, self._rules_in_force)

    def drive(self, stopped: Callable[[], bool]) -> None:
        """Until ``stopped``."""
        self._robot.poll_graph(self._poll)
        self._robot.every(self._timer.period_s, self._reporter.report)
        for part in self._parts:
            if part.poll_s is not None:
                self._robot.every(part.poll_s, part.poll)
        try:
            while not stopped():
                self._turn()
            for part in self._parts:
                part.finish()
            while any(part.is_busy for part in self._parts):
                self._turn()
            self._report()
        finally:
            self._compiled.close()
            for topic in self.topics.values():
                topic.losses.close()
            for part in self._parts:
                part.close()

    def _turn(self) -> None:
        self._report()
        self._robot.wait(self._wake_ns, POLL_PERIOD_S)
        self._wake()

    def note(self, outcome: ActionDecision) -> None:
        """Have what came of an action stand beside the decisions."""
        self._outcomes.append(outcome)

    def reload(self, rules: LiveRules, prepared: RuleExchange | None = None) -> None:
        """Put other rules in force; to be called between two messages, that is, within ``Robot.wait``.

        ``prepared`` may have been made of them beforehand.
        """
        now_ns = self._now_ns()
        # What is due by the rules before this is theirs.
        self._handle(WakeInput(stamp_ns=now_ns))
        self.rules = rules
        self._follow_parts(now_ns)
        given = RulesInput(stamp_ns=now_ns, rule_set=rules.rule_set, profile=rules.profile, prepared=prepared)
        self._handle(given)
        self._follow(rules)
        self._poll(GraphChange.REPORTED)

    def set_budget(self, budget_kb_per_s: float) -> None:
        """Set the budget of all relayed topics."""
        budget = LinkBudget(link_kb_per_s=budget_kb_per_s)
        self._handle(ChangeInput(stamp_ns=self._now_ns(), change=budget))

    def set_status_hz(self, status_hz: float) -> None:
        """Publish the status so often from now on, while it has a subscriber."""
        self._timer.asked_hz = status_hz

    def ask_standing(self, standing: Callable[[], RulesInForce]) -> None:
        """Have ``standing`` called for the origin of the rules in force."""
        self._standing = standing

    def _rules_in_force(self) -> RulesInForce:
        return self._standing()

    def subscribed_here(self) -> Collection[str]:
        """The topics whose output has a subscriber on the robot's own graph."""
        return self._graph.subscribed_here()

    def _follow_parts(self, now_ns: int) -> None:
        for part in self._parts:
            part.follow(self.rules, now_ns)

    def _follow(self, rules: LiveRules) -> None:
        loop = self.loop
        self._part_topics = self._topics_of_parts()
        gone = self._graph.follow(
            rules.output_topics, loop.knowledge.watched, loop.relays.leaders, recorded=self._part_topics
        )
        for topic in gone:
            self._compiled.end(topic)
            topic.losses.close()
            if topic.sampled is not None:
                self._sampling.end(topic.sampled, self._robot.now_ns())

    def _topics_of_parts(self) -> frozenset[str]:
        return frozenset().union(*(part.topics for part in self._parts))

    def _priority_of(self, topic: str) -> float:
        return self.loop.knowledge.profile.topic(topic).priority

    @property
    def _wake_ns(self) -> int | None:
        parts_ns = [part.wake_ns for part in self._waking]
        wakes_ns = (self.loop.next_wake_ns, self._sampling.wake_ns, *parts_ns)
        return min((wake_ns for wake_ns in wakes_ns if wake_ns is not None), default=None)

    def _wake(self) -> None:
        now_ns = self._now_ns()
        wake_ns = self.loop.next_wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            self._handle(WakeInput(stamp_ns=now_ns))
        wake_ns = self._sampling.wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            self._sampling.on_wake(now_ns)
        for part in self._waking:
            part.on_wake(now_ns)
        if self._topics_of_parts() != self._part_topics:
            self._follow(self.rules)

    def _receive(
        self, topic: Topic, payload: Payload | None, publisher: Hashable, copy: MessageCopy | None
    ) -> None:
        """Take a message of a source: now, or a ``copy`` that the compiled relay of ``topic`` made before."""
        now_ns = self._now_ns() if copy is None else self._follow_clock(copy.at)
        if payload is not None and self._on_message:
            self._notify_parts(topic, payload, publisher, now_ns)
        if copy is not None:
            if topic.is_given:
                self._follow_loop(self.loop.count(topic.name, copy.size_bytes, now_ns))
            return
        assert payload is not None
        topic.losses.size_bytes = size_bytes = len(payload)
        if not topic.is_given:
            self._compiled.count_unrelayed(topic, size_bytes, now_ns)
            return
        message = topic.decoded(payload) if self.loop.needs_decoded(topic.name) else None
        if topic.sampled is not None:
            self._sampling.received(topic.sampled, size_bytes)
        self._handle(MessageInput(now_ns, topic.name, payload, size_bytes, message, publisher))

    def _notify_parts(self, topic: Topic, payload: Payload, publisher: Hashable, stamp_ns: int) -> None:
        for on_message in self._on_message:
            try:
                on_message(topic.name, payload, publisher, stamp_ns, topic.subscription)
            except Exception as error:  # noqa: BLE001, PERF203 - it costs neither the relay nor other parts
                self._warn_once(str(error_at(topic.name, error)))

    def _poll(self, graph: GraphChange) -> None:
        # What is due goes out before a topic is opened anew, perhaps with another type.
        self._handle(WakeInput(stamp_ns=self._now_ns()))
        found = self._graph.poll(graph)
        # What was opened anew is received from now on: where there are many topics, the poll takes a second.
        now_ns = self._now_ns()
        if sources := tuple(change for change in found if self.topics[change.topic].is_given):
            self._handle(GraphInput(stamp_ns=now_ns, sources=sources))
        for topic in self.topics.values():
            if topic.subscription is not None and topic.source is not None:
                self._notify_source(topic, topic.source, now_ns)
        if listeners := tuple(self._graph.listeners()):
            self._handle(GraphInput(stamp_ns=now_ns, listeners=listeners))
        self._choose_paths(now_ns, is_quiet=graph is GraphChange.NONE)
        for topic in self.topics.values():
            topic.losses.measure(topic.subscription, now_ns)
        for part in self._parts:
            part.on_graph()
        if self.on_graph is not None:
            self.on_graph()

    def _notify_source(self, topic: Topic, source: LiveSource, now_ns: int) -> None:
        for part in self._parts:
            try:
                part.on_source(topic.name, source, now_ns)
            except Exception as error:  # noqa: BLE001, PERF203 - as of a message
                self._warn_once(str(error_at(topic.name, error)))

    def _choose_paths(self, now_ns: int, *, is_quiet: bool = False) -> None:
        """Decide by the plan as it is now which topics need no Python, and which of the others pause.

        Where it ``is_quiet``, neither graph nor plan have changed since the last time.
        """
        compiled, topics = self._compiled, self.topics.values()
        by = (self._graph.changes, compiled.can_relay, self.loop.counts_all)
        if not is_quiet or by != self._decided_by:
            self._decided_by = by
            for topic in topics:
                ends = topic.ends(is_published=not self._sees_passed) if compiled.can_relay else None
                compiled.choose(topic, ends, now_ns)
                if ends is not None and topic.compiled is None:
                    # It may be relayed so as soon as a message comes.
                    self._decided_by = None
        if self._sampling.may_pause:
            for topic in topics:
                self._choose_pause(topic, now_ns)

    def _choose_pause(self, topic: Topic, now_ns: int) -> None:
        sampled, subscription = topic.sampled, topic.subscription
        if topic.may_pause and not topic.is_left:
            if sampled is None or sampled.subscription is not subscription:
                if sampled is not None:
                    self._sampling.end(sampled, now_ns)
                sampled = None
                if isinstance(subscription, PausableSubscription):
                    sampled = SampledTopic(topic.name, subscription, now_ns)
                topic.sampled = sampled
            if sampled is not None:
                self._sampling.choose(sampled, now_ns, needs_all=topic.losses.may_lack_room)
        elif sampled is not None:
            self._sampling.end(sampled, now_ns)
            if not sampled.has_resumed or sampled.subscription is not subscription:
                topic.sampled = None

    def give(self, given: ChangeInput | WakeInput) -> None:
        """Give the loop an input of now, and relay what comes of it."""
        self._handle(replace(given, stamp_ns=self._now_ns()))

    def _handle(self, given: LoopInput) -> None:
        if self._inputs.is_recording:
            self._inputs.record(given, self.rules)
        self._follow_loop(self.loop.handle(given))

    def _now_ns(self) -> int:
        """The clock, once all was followed that came by now: copies of messages, and jumps of the clock."""
        now_ns = self._robot.now_ns()
        if self._clock.agrees(now_ns) and not (self._compiled.makes_copies or self._jumps):
            return now_ns
        now = self._clock.read()
        if self._compiled.makes_copies:
            self._compiled.deliver(now.steady_ns)
        now_ns = self._follow_clock(now)
        if not self._jumps:
            return now_ns
        while self._jumps:
            self._compiled.leave_out(*self._jumps.pop(0))
        return self._now_ns()

    def _follow_clock(self, at: Instant) -> int:
        """The clock by then; if it jumped, before anything is handled that came after it."""
        jump_ns, now_ns = self._clock.follow(at), at.clock_ns
        if jump_ns <= 0:
            return now_ns
        self._jumps.append((jump_ns, now_ns))
        for part in self._parts:
            part.on_clock_jump(jump_ns)
        self._handle(ChangeInput(stamp_ns=now_ns, change=ClockJumped(ahead_ns=jump_ns)))
        self._decided_by = None
        for topic in self.topics.values():
            # All rates are measured from the next messages on.
            topic.meters = None
        return now_ns

    def _follow_loop(self, relayed: Sequence[Relayed]) -> None:
        """Do what follows from an input that the loop took, once: begin recordings, and publish."""
        for trigger in self.loop.triggers:
            for part in self._parts:
                part.on_trigger(trigger)
        self._relay(relayed)

    def _relay_copy(self, name: str, copy: MessageCopy) -> None:
        """Publish what a compiled relay let pass."""
        now_ns, payload = self._follow_clock(copy.at), copy.payload or b""
        self._relay(
            [Relayed(name, now_ns, payload, copy.size_bytes, repeated=False, publisher=copy.publisher)]
        )

    def _relay(self, relayed: Sequence[Relayed]) -> None:
        if relayed:
            for before_relays in self._before_relays:
                before_relays()
        for one in relayed:
            self._publish(one)

    def _publish(self, relayed: Relayed) -> None:
        topic = self.topics.get(relayed.topic)
        for part in self._publishing:
            part.before_publish(relayed)
        try:
            if topic is not None:
                topic.publish(relayed.payload, relayed.publisher)
        finally:
            for part in self._publishing:
                part.after_publish()
        if topic is not None and topic.meters is not None:
            topic.meters.note(relayed)

    def _measure(self, most_blocks: int) -> tuple[RuntimeStatus, BlockStates]:
        """The status of now without its blocks, and the states of the first of those."""
        now_ns = self._now_ns()
        self._handle(WakeInput(stamp_ns=now_ns))
        self._decided_by = None
        self._compiled.count()
        statistics = self.loop.relays.statistics
        status = self._status.measure(
            self.loop,
            {
                name: topic.measured(statistics[name])
                for name, topic in self.topics.items()
                if topic.output is not None
            },
            self._standing(),
            read_own_process(),
            now_ns,
            status_hz=self._timer.status_hz,
        )
        for line in doubt_lines(status.topics):
            self._warn_once(line)
        for part in self._parts:
            status = part.added_to(status)
        for part in self._parts:
            part.on_status(status)
        return status, self.loop.block_states(now_ns, most_blocks)

    def _report(self) -> None:
        outcomes, self._outcomes = self._outcomes, []
        decisions = [*self.loop.take_all_decisions(), *outcomes]
        if decisions:
            self._decisions.report(decisions)
            self._choose_paths(self._now_ns())


def _does(part: Part, method: str) -> bool:
    """Whether ``part`` has a method of its own: those are called for every message."""
    return getattr(type(part), method) is not getattr(Part, method)

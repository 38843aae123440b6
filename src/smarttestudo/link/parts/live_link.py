# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Between the loop and the link that carries what it relays."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

from smarttestudo.domain.decision import PlannedRate
from smarttestudo.domain.errors import TestudoError, testudo_error
from smarttestudo.domain.link import LinkNeeds, OutgoingLink, Prediction, StreamCounts, TopicOnLink
from smarttestudo.domain.names import DECISIONS_TOPIC
from smarttestudo.domain.observation import LinkBudget, ListenersChanged, ReceiversReckon
from smarttestudo.domain.parameter import Answer, GetParameters, GetTopics, Question, SetParameters
from smarttestudo.domain.robot import Robot, topic_types
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.units import NS_PER_S, counted
from smarttestudo.loop.inputs import ChangeInput, WakeInput
from smarttestudo.loop.relay import PredictedEstimate
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.part import Part, RunView

MOST_LINES = 6
"""So many are said at once; then one for each ``REFILL_NS``, with all that happened meanwhile."""
REFILL_NS = 30 * NS_PER_S
_DIGITS = 4


class OperatorLog:
    """Says by ``say`` which operator's ends came or left; ``now_ns`` is of a clock that never jumps."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._there: frozenset[int] = frozenset()
        self._said: frozenset[int] = frozenset()
        self._moves = 0
        self._lines = float(MOST_LINES)
        self._looked_ns = 0
        self._left_ns: int | None = None
        """When the last one left."""
        self._absent_s = 0.0
        """For how long there was none, until one was there again of which nothing was said yet."""

    def look(self, there: frozenset[int], now_ns: int) -> None:
        self._lines = min(self._lines + (now_ns - self._looked_ns) / REFILL_NS, MOST_LINES)
        self._looked_ns = now_ns
        if there != self._there:
            self._moves += len(there ^ self._there)
            if not there:
                self._left_ns = now_ns
            elif not self._there and self._left_ns is not None:
                self._absent_s = (now_ns - self._left_ns) / NS_PER_S
            self._there = there
        if self._moves and self._lines >= 1:
            self._lines -= 1
            self._say(self._sentence())
            self._said, self._moves, self._absent_s = there, 0, 0.0

    def _sentence(self) -> str:
        came, left = self._there - self._said, self._said - self._there
        parts = [f"{_names(left)} left the link"] if left else []
        if came:
            absent = f", after {self._absent_s:.0f} s without any" if self._absent_s >= 1 else ""
            parts.append(f"{_names(came)} came over the link{absent}")
        if others := self._moves - len(came) - len(left):
            parts.append(f"operators came or left {counted(others, 'more time')} meanwhile")
        if not self._there:
            parts.append("none is there now")
        return "; ".join(parts)


def _names(numbers: Collection[int]) -> str:
    names = ", ".join(sorted(f"{number:016x}"[:_DIGITS] for number in numbers))
    return f"operator {names}" if len(numbers) == 1 else f"operators {names}"


QUESTION_PERIOD_S = 0.1
"""How often one question is answered: more would keep messages waiting."""
_TOPICS_HOLD_NS = 2 * NS_PER_S


class LinkQuestions:
    """Answers the questions that wait at ``link`` on the thread of ``robot``, one at a time."""

    def __init__(self, robot: Robot, link: OutgoingLink) -> None:
        self._robot = robot
        self._link = link
        self._topics: Answer = {}
        self._polled_ns: int | None = None
        robot.every(QUESTION_PERIOD_S, self._poll)

    def _poll(self) -> None:
        asked = self._link.take_question()
        if asked is None:
            return
        answer: Answer | TestudoError
        try:
            answer = self._answer(asked.question)
        except Exception as error:  # noqa: BLE001 - whatever a stranger asks, relaying goes on
            answer = testudo_error(error)
        asked.answer(answer)

    def _answer(self, question: Question) -> Answer:
        match question:
            case GetParameters(names=names):
                return self._robot.parameters(names)
            case SetParameters(values=values):
                return self._robot.set_parameters(values)
            case GetTopics():
                return self._all_topics()

    def _all_topics(self) -> Answer:
        now_ns = self._robot.steady_ns()
        if self._polled_ns is None or now_ns > self._polled_ns + _TOPICS_HOLD_NS:
            self._topics, self._polled_ns = topic_types(self._robot), now_ns
        return self._topics


LINK_PERIOD_S = 0.25
"""How often to read what the link carries."""
_FALL, _RISE = 0.95, 1.1
"""Shares of the budget that was told last: what lies between them is not worth another plan."""
_HOLDS_AFTER_NS = 10 * NS_PER_S
_LEAST_WAIT_NS = NS_PER_S
_LONGEST_WAIT_NS = 60 * NS_PER_S


class LinkWatch:
    """Tells a link what its topics need, and the loop what the link carries."""

    def __init__(self, link: OutgoingLink) -> None:
        self._link = link
        self._needs: Mapping[str, LinkNeeds] = {}
        self._given_kb_per_s: float | None = None
        self._given_ns = 0
        self._wait_ns = _LEAST_WAIT_NS
        self._has_risen = False
        self._sessions = 0
        self._reckoned: frozenset[str] = frozenset()
        self._estimates: Mapping[str, PredictedEstimate] = {}

    def follow(self, rules: LiveRules, plan: Mapping[str, PlannedRate]) -> None:
        """Have topics served by the floors of ``rules``, their priorities and the planned rates."""
        needs = {
            output: LinkNeeds(
                priority=rules.profile.topic(topic).priority,
                floor_hz=max(
                    rules.rule_set.floors_hz.get(topic, 0.0), rules.profile.topic(topic).min_hz or 0.0
                ),
                is_full=(topic in plan and math.isinf(plan[topic].rate.hz))
                or (topic in self._estimates and self._estimates[topic].needs_every_message),
            )
            for topic, output in rules.output_topics.items()
        }
        # What a rule notifies of goes before all topics.
        needs[DECISIONS_TOPIC] = LinkNeeds(priority=math.inf)
        if needs != self._needs:
            self._needs = needs
            self._link.follow(needs)

    def changed_receivers(
        self, rules: LiveRules, plan: Mapping[str, PlannedRate], subscribed_here: Collection[str]
    ) -> list[ListenersChanged | ReceiversReckon]:
        """Changes for the loop: operator's ends that joined, left or reckon something else.

        Topics that are ``subscribed_here`` somebody shows as they are, and are not reckoned for others.
        """
        changes: list[ListenersChanged | ReceiversReckon] = []
        state, outputs = self._link.state, rules.output_topics
        reckoned = frozenset(
            topic
            for topic, output in outputs.items()
            if output in state.predicted and topic not in subscribed_here
        )
        if reckoned != self._reckoned:
            self._reckoned = reckoned
            changes.append(ReceiversReckon(topics=reckoned))
        if state.sessions != self._sessions:
            self._sessions = state.sessions
            changes += [
                ListenersChanged(topic=topic, are_there=True)
                for topic in outputs
                if topic in plan and plan[topic].within
            ]
        return changes

    def announce_estimates(
        self, rules: LiveRules, plan: Mapping[str, PlannedRate], estimates: Mapping[str, PredictedEstimate]
    ) -> None:
        """Have receivers reckon these topics; to be called before what is made from them goes out."""
        before, self._estimates = self._estimates, estimates
        if before == estimates:
            return
        # From its first message on, none of an estimate that needs every message may give way to a newer one.
        self.follow(rules, plan)
        outputs = rules.output_topics
        predictions = {
            outputs[topic]: Prediction(within=bounds, heartbeat_hz=estimate.heartbeat_hz)
            for topic, estimate in estimates.items()
            if topic in outputs
            and (bounds := {name: bound for name, bound in estimate.within.items() if bound < math.inf})
        }
        anew = {
            outputs[topic]
            for topic, estimate in estimates.items()
            if topic in outputs and (topic not in before or before[topic].number != estimate.number)
        }
        self._link.predict(predictions, anew)

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        """``status`` with the robot's name, the state of the link and of each topic on it."""
        counts = self._link.counts()
        topics = {
            source: replace(topic, on_link=self._on_link(topic.output, counts))
            for source, topic in status.topics.items()
        }
        return replace(status, topics=topics, link=self._link.state, robot=self._link.robot)

    def _on_link(self, output: str, counts: Mapping[str, StreamCounts]) -> TopicOnLink | None:
        known = counts.get(output)
        return None if known is None else TopicOnLink(counts=known, age_ms=self._link.age_ms(output))

    def changed_budget(self, now_ns: int) -> LinkBudget | None:
        """Budget of the link at ``now_ns``, where it is worth another plan than the last that was told.

        ``now_ns`` is of a clock that never jumps. A fall counts at once. A rise waits, twice as long each
        time that a fall soon undid one: rates that the link nearly carries do not swing.
        """
        budget_kb_per_s, given = self._link.budget_kb_per_s, self._given_kb_per_s
        if budget_kb_per_s is None or (
            given is not None and not self._is_due(budget_kb_per_s, given, now_ns)
        ):
            return None
        self._given_kb_per_s, self._given_ns = budget_kb_per_s, now_ns
        return LinkBudget(link_kb_per_s=budget_kb_per_s, is_measured=True)

    def _is_due(self, budget_kb_per_s: float, given: float, now_ns: int) -> bool:
        has_held = now_ns - self._given_ns > _HOLDS_AFTER_NS
        if budget_kb_per_s < _FALL * given:
            if self._has_risen:
                self._wait_ns = _LEAST_WAIT_NS if has_held else min(2 * self._wait_ns, _LONGEST_WAIT_NS)
            self._has_risen = False
            return True
        if budget_kb_per_s <= _RISE * given or now_ns - self._given_ns < self._wait_ns:
            return False
        self._has_risen = True
        return True


class LinkPart(Part):
    """Carries what is relayed over a link, and what is asked over it to the node."""

    poll_s = LINK_PERIOD_S

    def __init__(self, robot: Robot, link: OutgoingLink) -> None:
        self._robot = robot
        self._link = link
        self._watch = LinkWatch(link)
        self._operators = OperatorLog(robot.log.info)
        self._run: RunView | None = None

    def begin(self, run: RunView) -> None:
        self._run = run

    def poll(self) -> None:
        """Tell the loop what changed on the link, the link what the loop plans, and the log who is there."""
        self._operators.look(self._link.state.operators, self._robot.steady_ns())
        run = self._run
        if run is None:
            return
        now_ns, rules = self._robot.now_ns(), run.rules
        # What is due goes out before an estimate begins anew, of which it is no part.
        run.give(WakeInput(stamp_ns=now_ns))
        plan = run.loop.knowledge.plan
        for change in self._watch.changed_receivers(rules, plan, run.subscribed_here()):
            run.give(ChangeInput(stamp_ns=now_ns, change=change))
        self._watch.announce_estimates(rules, plan, run.loop.relays.estimates)
        self._watch.follow(rules, plan)
        budget = self._watch.changed_budget(self._robot.steady_ns())
        if budget is not None:
            run.give(ChangeInput(stamp_ns=self._robot.now_ns(), change=budget))

    def before_relays(self) -> None:
        """Have receivers reckon what is about to go out."""
        if self._run is not None:
            loop = self._run.loop
            self._watch.announce_estimates(self._run.rules, loop.knowledge.plan, loop.relays.estimates)

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        """``status`` with the state of the link and of each topic on it."""
        return self._watch.added_to(status)

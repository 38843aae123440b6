# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop beside a robot's ROS graph, in the node's time."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.composition.live_topics import DECISIONS_TOPIC, LiveTopics
from smarttestudo.composition.replay_topics import output_name
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.runtime.execute.relay import Relayed
from smarttestudo.runtime.relay_loop import RelayLoop

DEFAULT_OUTPUT_TOPIC = "/testudo{topic}"
# Late subscribers get the last decisions, so that they see which plan holds.
DECISIONS_QOS = Qos(reliable=True, transient_local=True, depth=100)
LOOK_PERIOD_S = 0.2

Decided = Callable[[Sequence[Decision]], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRequest:
    """The rules, and how they are to be followed. Topics, also the profile's, are by full name.

    ``output_topic`` names monitored topics, with ``{topic}`` for the source's full name. ``decided`` are
    given decisions in order; one that raises is given no more.
    """

    rule_set: RuleSet
    profile: Profile = field(default_factory=Profile)
    when_slow: WhenSlow = WhenSlow.PASS
    output_topic: str = DEFAULT_OUTPUT_TOPIC
    budget_kb_per_s: float | None = None
    decided: Sequence[Decided] = ()


def run_live(request: RunRequest, robot: Robot, stopped: Callable[[], bool]) -> None:
    """Relay until ``stopped``.

    Raises:
        RosError: decisions cannot be published at all.
        UsageError: ``output_topic`` gives no valid names, or such as are taken.
    """
    monitored = monitored_topics(request.rule_set, request.output_topic)
    announce = robot.text_publisher(DECISIONS_TOPIC, DECISIONS_QOS)
    if robot.now_ns() == 0:
        robot.log.info("Waiting for simulated time on /clock")
    while robot.now_ns() == 0 and not stopped():
        robot.wait(None, LOOK_PERIOD_S)
    if stopped():
        return
    _Run(request, robot, monitored, announce).drive(stopped)


def monitored_topics(rule_set: RuleSet, output_topic: str) -> dict[str, str]:
    """The monitored topic of each relayed one; ``UsageError`` where a name is invalid or taken."""
    monitored = {topic: output_name(topic, output_topic) for topic in rule_set.relayed}
    taken = {*rule_set.relayed, *(signal.topic for signal in rule_set.signals), DECISIONS_TOPIC}
    for topic, name in monitored.items():
        if name in taken:
            cause = f"{topic} would be relayed to {name}, which is another topic's name"
            remedy = f"choose another pattern, such as {DEFAULT_OUTPUT_TOPIC}"
            raise UsageError(cause, place="--output-topic", remedy=remedy)
    return monitored


class _Run:
    """Drives the loop with what arrives, what the graph shows and the time between."""

    def __init__(
        self,
        request: RunRequest,
        robot: Robot,
        monitored: Mapping[str, str],
        announce: Callable[[str], None],
    ) -> None:
        rule_set = request.rule_set
        self._robot = robot
        self._loop = RelayLoop(
            rule_set, request.profile, robot.now_ns(), request.when_slow, request.budget_kb_per_s
        )
        watched = sorted({signal.topic for signal in rule_set.signals})
        self._topics = LiveTopics(robot, monitored, watched, self._receive)
        self._decoded = frozenset(topic for topic in (*monitored, *watched) if self._loop.reads(topic))
        self._announce = announce
        self._decided: list[Decided] = [*request.decided, self._log, self._announce_all]
        robot.log.info(f"Relaying {len(monitored)} topics as {request.output_topic}")

    def drive(self, stopped: Callable[[], bool]) -> None:
        """Until ``stopped``."""
        self._robot.every(LOOK_PERIOD_S, self._look)
        while not stopped():
            self._report()
            self._robot.wait(self._loop.next_wake_ns, LOOK_PERIOD_S)
            now_ns, wake_ns = self._robot.now_ns(), self._loop.next_wake_ns
            if wake_ns is not None and wake_ns <= now_ns:
                self._publish(self._loop.on_wake(now_ns))
        self._report()

    def _receive(self, topic: str, payload: bytes) -> None:
        message = self._topics.decoded(topic, payload) if topic in self._decoded else None
        now_ns = self._robot.now_ns()
        self._publish(self._loop.on_message(topic, now_ns, payload, len(payload), message=message))

    def _look(self) -> None:
        # What is due goes out before a topic is opened anew, perhaps with another type.
        now_ns = self._robot.now_ns()
        self._publish(self._loop.on_wake(now_ns))
        for change in self._topics.look():
            self._publish(self._loop.on_source(change, now_ns))

    def _publish(self, relayed: Iterable[Relayed]) -> None:
        for one in relayed:
            self._topics.publish(one)

    def _report(self) -> None:
        decisions = self._loop.take_decisions()
        if not decisions:
            return
        self._decided = [decided for decided in self._decided if self._took(decided, decisions)]

    def _took(self, decided: Decided, decisions: Sequence[Decision]) -> bool:
        try:
            decided(decisions)
        except TestudoError as error:
            self._robot.log.warning(f"{error}; no further decisions go there")
            return False
        return True

    def _log(self, decisions: Sequence[Decision]) -> None:
        for decision in decisions:
            self._robot.log.info(decision_line(decision))

    def _announce_all(self, decisions: Sequence[Decision]) -> None:
        for decision in decisions:
            self._announce(json.dumps(decision.to_json(), ensure_ascii=False, allow_nan=False))


def decision_line(decision: Decision) -> str:
    """A decision for the log: what changed, and why."""
    planned = decision.planned
    before = "" if decision.from_rate is None else f"{decision.from_rate} → "
    why = planned.reason.value if planned.rule is None else f"{planned.reason.value}: {planned.rule}"
    return f"{decision.topic}: {before}{planned.rate} ({why})"

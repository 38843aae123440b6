# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A profile from a running robot."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace

from smarttestudo.bags.topic_selection import is_selected, select_topics
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.robot import Endpoint, Payload, Receive, Robot, Subscription, visible_topics
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.optimizer.profiling import TopicMeasure, profile_text
from smarttestudo.robot.losses import TopicLosses
from smarttestudo.robot.source import live_source

_POLL_PERIOD_S = 0.5
_WAIT_S = 0.1
# What queued up while subscriptions were made comes at once, and would count as a higher rate.
_WARM_UP_S = 1.0
# Messages wait here while others are counted; one that is pushed out would count as a longer interval.
_DEPTH = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotProfile:
    """The text of a profile, and what could not be measured, a line each."""

    text: str
    notices: tuple[str, ...]


def profile_of_robot(
    robot: Robot,
    *,
    seconds: float,
    timeout_s: float,
    patterns: Sequence[str] = (),
    levels: Profile | None = None,
    steady_s: Callable[[], float],
    report: Callable[[float], None],
) -> RobotProfile:
    """Measure for ``seconds`` a second after the first topic was seen.

    ``patterns`` choose topics (default: all visible ones), the accuracies in ``levels`` are measured in place
    of proposed ones; ``report`` is given the share of the time passed.

    Raises:
        RosError: no topic is seen within ``timeout_s``.
        TestudoError: a pattern names none of those that were seen.
    """
    ears = _TopicSampler(robot, patterns, levels or Profile())
    _wait_for_topics(ears, robot, steady_s, timeout_s)
    _listen(ears, robot, steady_s, _WARM_UP_S, lambda _share: None)
    ears.begin()
    start_ns = _time_ns(robot)
    _listen(ears, robot, steady_s, seconds, report)
    duration_s = (_time_ns(robot) - start_ns) / NS_PER_S
    ears.finish()
    ears.check_patterns()
    measures = dict(sorted(ears.measures.items()))
    text = profile_text(measures, duration_s=duration_s, measured_in="a running robot")
    return RobotProfile(text=text, notices=tuple(ears.notices))


def _time_ns(robot: Robot) -> int:
    """Simulated time, or a clock that nobody sets."""
    return robot.now_ns() if robot.is_time_simulated else robot.steady_ns()


def _wait_for_topics(
    ears: _TopicSampler, robot: Robot, steady_s: Callable[[], float], timeout_s: float
) -> None:
    """Until the first chosen topic was seen and time is known."""
    end_s = steady_s() + timeout_s
    while not (ears.measures and robot.now_ns()):
        if steady_s() >= end_s:
            ears.check_patterns()
            what = "no time comes on /clock" if ears.measures else "no topic is seen"
            raise RosError(
                f"{what} within {timeout_s:g} s",
                remedy="start the robot's nodes, with the same ROS_DOMAIN_ID",
            )
        ears.poll()
        robot.wait(None, _WAIT_S)


def _listen(
    ears: _TopicSampler,
    robot: Robot,
    steady_s: Callable[[], float],
    seconds: float,
    report: Callable[[float], None],
) -> None:
    start_s = poll_s = steady_s()
    while (passed_s := steady_s() - start_s) < seconds:
        report(passed_s / seconds)
        if steady_s() >= poll_s:
            poll_s = steady_s() + _POLL_PERIOD_S
            ears.poll()
        robot.wait(None, min(_WAIT_S, seconds - passed_s))


class _TopicSampler:
    """Subscriptions to all chosen topics, as they are discovered."""

    def __init__(self, robot: Robot, patterns: Sequence[str], levels: Profile) -> None:
        self.seen: set[str] = set()
        self.measures: dict[str, TopicMeasure] = {}
        self.notices: list[str] = []
        self._robot = robot
        self._patterns = patterns
        self._levels = levels
        self._latched: set[str] = set()
        self._publishers: dict[str, int] = {}
        self._subscriptions: dict[str, Subscription] = {}
        self._losses: dict[str, TopicLosses] = {}

    def poll(self) -> None:
        """Subscribe to what is new, and count the publishers that are there at once."""
        for topic, publishers in visible_topics(self._robot).items():
            source = live_source(publishers, None)
            count = 0 if source is None else source.publishers
            self._publishers[topic] = max(count, self._publishers.get(topic, 0))
            if topic not in self.seen:
                self.seen.add(topic)
                if not self._patterns or is_selected(topic, self._patterns):
                    self._subscribe(topic, publishers)
        self._measure_losses()

    def begin(self) -> None:
        """Measure from now on; what latched topics gave already still counts."""
        for topic, measure in self.measures.items():
            if topic not in self._latched:
                self.measures[topic] = self._new(topic, measure.type_name)

    def finish(self) -> None:
        """Drop the topics of a SmartTestudo node: publishers may be discovered later than the topic."""
        for topic, measure in self.measures.items():
            measure.publishers = self._publishers[topic]
        visible = visible_topics(self._robot)
        for topic in self.measures.keys() - visible.keys():
            if self._robot.publishers(topic):
                del self.measures[topic]
        self._measure_losses()
        for topic, losses in self._losses.items():
            loss = losses.loss()
            if loss is not None and loss.state is not None and topic in self.measures:
                self.measures[topic].lost_share = loss.share
                lost = f"{loss.state.percent:.0f} % of its messages were lost on their way here"
                self.notices.append(f"{topic}: {lost}; {loss.state.remedy}")

    def _measure_losses(self) -> None:
        now_ns = self._robot.now_ns()
        for topic, subscription in self._subscriptions.items():
            self._losses[topic].measure(subscription, now_ns)

    def check_patterns(self) -> None:
        """Raise ``TestudoError`` where a pattern names nothing that was seen, though something was."""
        if self.seen and self._patterns:
            listed_by = "`ros2 topic list` lists them"
            select_topics(self._patterns, self.seen, place="--topics", listed_by=listed_by)

    def _subscribe(self, topic: str, publishers: Sequence[Endpoint]) -> None:
        source = live_source(publishers, None)
        if source is None:
            return
        qos = replace(source.qos, depth=max(_DEPTH, source.qos.depth))
        robot = self._robot
        # Losses are named at the end, not as they happen.
        self._losses[topic] = TopicLosses(
            topic, lambda _: None, lambda: robot.publishers(topic), robot.senders_remedy
        )
        try:
            subscription = self._robot.data_path.subscribe(
                topic, source.type_name, qos, self._counting(topic)
            )
        except RosError as error:
            self.notices.append(str(error))
            return
        self._subscriptions[topic] = subscription
        self.measures[topic] = self._new(topic, source.type_name)
        if source.qos.transient_local:
            self._latched.add(topic)

    def _new(self, topic: str, type_name: str) -> TopicMeasure:
        return TopicMeasure(type_name, known=self._levels.topic(topic).accuracies)

    def _counting(self, topic: str) -> Receive:
        def receive(payload: Payload, _publisher: Hashable) -> None:
            measure = self.measures[topic]
            self._losses[topic].size_bytes = len(payload)
            serialized = payload[:] if measure.needs_payload else None
            measure.record(_time_ns(self._robot), len(payload), serialized)

        return receive

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever the middleware fails of for a topic costs that topic alone, is said once, and is tried again."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from incidents.incident_runs import rules_of
from robot.small_graph import TEXT, MemoryPublisher, MemorySubscription, SmallGraph
from robot.test_topics_of_parts import PollingGraph
from smarttestudo.domain.compiled_relay import MessageCopy
from smarttestudo.domain.errors import LinkError, RosError
from smarttestudo.domain.names import MAX_NAME_LENGTH
from smarttestudo.domain.observation import Undecodable
from smarttestudo.domain.robot import Endpoint, GraphChange, Payload, Publisher, Qos, Receive, Subscription
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.live_run import LiveRun
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import Part
from smarttestudo.robot.source import LiveSource
from smarttestudo.robot.topic import Topic
from smarttestudo.robot.topics import LiveTopics

GOOD, BAD = "/good", "/bad"
CALLS = (
    "publishers",
    "publisher_count",
    "subscribers",
    "subscriber_count",
    "begins_with_header",
    "subscribe",
    "advertise",
    "publish",
    "receive",
    "close publisher",
    "close subscription",
)
ERRORS: tuple[Exception, ...] = (
    RosError("no", place="/testudo/bad"),
    LinkError("the link has as many topics as it can", place="/testudo/bad"),
    RuntimeError("rcl: no"),
    ValueError("no"),
    KeyError("no"),
    OSError(28, "No space left on device"),
    UnicodeDecodeError("utf-8", b"\xff", 0, 1, "no"),
    MemoryError(),
)


class FailingGraph(SmallGraph):
    """What ``call`` names fails with ``error`` for one topic, and for its output."""

    call = ""
    error: Exception = ERRORS[0]

    def does(self, call: str, topic: str) -> None:
        if call == self.call and topic.removeprefix("/testudo") == BAD:
            raise self.error

    def publishers(self, topic: str) -> Sequence[Endpoint]:
        self.does("publishers", topic)
        return super().publishers(topic)

    def publisher_count(self, topic: str) -> int:
        self.does("publisher_count", topic)
        return super().publisher_count(topic)

    def subscribers(self, topic: str) -> Sequence[Endpoint]:
        self.does("subscribers", topic)
        return super().subscribers(topic)

    def subscriber_count(self, topic: str) -> int:
        self.does("subscriber_count", topic)
        return super().subscriber_count(topic)

    def begins_with_header(self, type_name: str) -> bool:
        if type_name != TEXT:
            self.does("begins_with_header", BAD)
        return False

    def subscribe(
        self, topic: str, type_name: str, qos: Qos, receive: Receive, *, priority: float = 1.0
    ) -> Subscription:
        self.does("subscribe", topic)
        made = super().subscribe(topic, type_name, qos, receive, priority=priority)
        assert isinstance(made, MemorySubscription)
        made.close = partial(self.closes, "close subscription", topic, made.close)  # type: ignore[method-assign]
        return made

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        self.does("advertise", topic)
        made = super().advertise(topic, type_name, qos)
        assert isinstance(made, MemoryPublisher)
        made.close = partial(self.closes, "close publisher", topic, made.close)  # type: ignore[method-assign]
        publish = made.publish

        def publishing(payload: Payload) -> None:
            self.does("publish", topic)
            publish(payload)

        made.publish = publishing  # type: ignore[method-assign]
        return made

    def closes(self, call: str, topic: str, close: Callable[[], None]) -> None:
        close()
        self.does(call, topic)


class Relaying:
    """Topics that relay all that comes; each has one publisher and one operator."""

    def __init__(self, graph: FailingGraph) -> None:
        self.graph = graph
        self.known: dict[str, Topic] = {}
        self.topics = LiveTopics(graph, self.known, self.relay, lambda topic: 0.0)
        self.topics.follow({one: f"/testudo{one}" for one in (BAD, GOOD)}, (), {})
        graph.installed.add("x_msgs/msg/Odd")
        self.number = 0

    def relay(
        self, topic: Topic, payload: Payload | None, publisher: Hashable, copy: MessageCopy | None
    ) -> None:
        assert payload is not None
        self.graph.does("receive", topic.name)
        topic.publish(payload, publisher)

    def change(self) -> None:
        """Both topics come back with another QoS."""
        self.number += 1
        for topic, type_name in ((BAD, "x_msgs/msg/Odd"), (GOOD, TEXT)):
            self.graph.sources[topic] = []
            gid = f"{topic}{self.number}".encode()
            self.graph.joins(topic, gid, type_name=type_name, reliable=self.number % 2 == 0)
            self.graph.operators[f"/testudo{topic}"] = []
            self.graph.listens(f"/testudo{topic}", gid=gid)
        for told in (GraphChange.REPORTED, *[GraphChange.UNREPORTED] * 5):
            self.topics.poll(told)
            self.topics.listeners()
            self.send()

    def send(self) -> None:
        for topic in (BAD, GOOD):
            for one in self.graph.sources[topic]:
                self.graph.sends(topic, one.gid, topic.encode())

    def relayed(self) -> set[str]:
        """What is relayed of one message of each topic."""
        before = len(self.graph.published)
        self.send()
        return {topic.removeprefix("/testudo") for topic, _ in self.graph.published[before:]}

    def problem(self, topic: str) -> str | None:
        return self.known[topic].problem


@pytest.mark.parametrize("begins_well", [True, False])
@pytest.mark.parametrize("call", CALLS)
@given(error=st.sampled_from(ERRORS))
def test_a_call_that_fails_costs_its_topic_until_it_changes_and_is_said_once(
    call: str, begins_well: bool, error: Exception
) -> None:
    graph = FailingGraph()
    live = Relaying(graph)
    if begins_well:
        live.change()
        assert live.relayed() == {BAD, GOOD}
    lines = len(graph.lines)
    graph.call, graph.error = call, error
    live.change()
    live.change()
    assert GOOD in live.relayed()
    assert live.problem(GOOD) is None
    said = [line for line in graph.lines[lines:] if "error: " in line]
    assert len(said) == 1
    assert BAD in said[0]
    if call in ("subscribe", "advertise", "publish", "receive"):
        assert live.problem(BAD)
    graph.call = ""
    live.change()
    assert live.relayed() == {BAD, GOOD}
    assert live.problem(BAD) is None


@pytest.mark.parametrize("error", ERRORS, ids=repr)
def test_a_message_that_cannot_be_decoded_is_unknown_whatever_is_raised(error: Exception) -> None:
    class Odd(FailingGraph):
        def decode(self, topic: str, type_name: str, payload: Payload) -> object:
            raise error

    live = Relaying(Odd())
    live.change()
    assert live.known[BAD].decoded(b"\x00\x01\x00\x00") == Undecodable()


@pytest.mark.parametrize(("letters", "is_relayed"), [(239, True), (240, False), (247, False)])
def test_an_output_whose_name_is_longer_than_ros_takes_costs_that_topic(
    letters: int, is_relayed: bool
) -> None:
    class Limited(SmallGraph):
        def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
            assert len(topic) <= MAX_NAME_LENGTH
            return super().advertise(topic, type_name, qos)

        def subscribers(self, topic: str) -> Sequence[Endpoint]:
            assert len(topic) <= MAX_NAME_LENGTH
            return super().subscribers(topic)

    graph, long = Limited(), "/" + "a" * (letters - 1)
    known: dict[str, Topic] = {}
    topics = LiveTopics(graph, known, lambda *_: None, lambda topic: 0.0)
    topics.follow({one: f"/testudo{one}" for one in (long, GOOD)}, (), {})
    for topic in (long, GOOD):
        graph.joins(topic, topic.encode())
        graph.listens(f"/testudo{topic}")
    for _ in range(5):
        topics.poll(GraphChange.UNREPORTED)
    assert graph.subscribed() == {GOOD, long} - ({long} if not is_relayed else set())
    said = [line for line in graph.lines if "error" in line]
    if is_relayed:
        assert said == []
        return
    (line,) = said
    assert line == (
        f"{long}: error: its name here would have {letters + 8} letters, and ROS 2 takes 247; "
        "give it a shorter name, or choose a shorter --output-topic"
    )
    assert known[long].problem == line.partition("error: ")[2].partition(";")[0]


class Odd(Part):
    """Fails of one topic."""

    topics = frozenset({BAD, GOOD})

    def __init__(self, error: Exception) -> None:
        self.error = error
        self.came: list[str] = []

    def on_source(self, topic: str, source: LiveSource, now_ns: int) -> None:
        if topic == BAD:
            raise self.error

    def on_message(
        self,
        topic: str,
        payload: Payload,
        publisher: Hashable,
        now_ns: int,
        subscription: Subscription | None,
    ) -> None:
        if topic == BAD:
            raise self.error
        self.came.append(topic)


class TalkingGraph(PollingGraph):
    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        super().wait(wake_ns, longest_s)
        for topic, publishers in self.sources.items():
            self.sends(topic, publishers[0].gid, topic.encode())


@pytest.mark.parametrize("error", ERRORS, ids=repr)
def test_a_part_that_fails_of_a_topic_costs_neither_its_relay_nor_other_topics(error: Exception) -> None:
    graph = TalkingGraph()
    for topic in (BAD, GOOD):
        graph.joins(topic, topic.encode())
        graph.listens(f"/testudo{topic}")
    part = Odd(error)
    rules = LiveRules(
        rule_set=rules_of(f"SetFrequency {BAD} Full SetFrequency {GOOD} Full"),
        output_topics={one: f"/testudo{one}" for one in (BAD, GOOD)},
    )
    run = LiveRun(
        graph, InputRecorder(graph, Settings(), None), rules, LiveDecisions(graph, []), parts=[part]
    )
    run.drive(lambda: len(part.came) >= 3)
    assert {topic for topic, _ in graph.published} == {"/testudo/bad", "/testudo/good"}
    assert len([line for line in graph.lines if "error: " in line and BAD in line]) == 1

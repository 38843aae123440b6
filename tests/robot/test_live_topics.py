# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is subscribed to, published and said as publishers and operators come and go."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping

import pytest

from robot.small_graph import NODE, TEXT, SmallGraph
from smarttestudo.domain.compiled_relay import MessageCopy
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.robot import GraphChange, Payload
from smarttestudo.robot.gone_publishers import FOUND_WITHIN_NS
from smarttestudo.robot.topic import Topic
from smarttestudo.robot.topics import LiveTopics

DRIVER, SECOND, OTHER = b"driver", b"second", b"other"


class Live:
    """Live topics that relay all that comes."""

    def __init__(
        self,
        graph: SmallGraph,
        *relayed: str,
        watched: tuple[str, ...] = (),
        leaders: Mapping[str, str] | None = None,
        is_lazy: bool = True,
    ) -> None:
        self.graph = graph
        self.known: dict[str, Topic] = {}
        self.topics = LiveTopics(graph, self.known, self.relay, lambda topic: 0.0, is_lazy=is_lazy)
        self.topics.follow({topic: f"/testudo{topic}" for topic in relayed}, watched, leaders or {})

    def relay(
        self, topic: Topic, payload: Payload | None, publisher: Hashable, copy: MessageCopy | None
    ) -> None:
        assert payload is not None
        topic.publish(payload, publisher)

    def looks(self, times: int = 5) -> None:
        """A second passes."""
        for _ in range(times):
            self.topics.poll(GraphChange.UNREPORTED)


def lines_with(graph: SmallGraph, text: str) -> list[str]:
    return [line for line in graph.lines if text in line]


def test_a_topic_is_subscribed_to_while_an_operator_listens_to_it() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu")
    graph.joins("/imu", DRIVER)
    live.looks()
    assert graph.subscribed() == set()
    assert not live.known["/imu"].link().is_subscribed
    assert [publisher.topic for publisher in graph.advertised] == ["/testudo/imu"]

    graph.listens("/testudo/imu")
    live.looks(1)
    assert graph.subscribed() == {"/imu"}
    assert live.known["/imu"].link().is_subscribed

    graph.operators.clear()
    live.looks(1)
    assert graph.subscribed() == set()
    assert not live.known["/imu"].link().is_subscribed
    assert graph.lines == [
        f"/imu: {TEXT}, reliable; not subscribed, because there is no subscriber",
        "/imu: subscribed, because there is a subscriber",
        "/imu: not subscribed, because there is no subscriber",
    ]


def test_it_is_said_once_when_somebody_begins_to_listen_and_when_nobody_does_any_more() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu", "/scan", watched=("/odom",))
    graph.listens("/testudo/scan")
    said = []
    changes: list[Callable[[], object]] = [
        lambda: None,
        lambda: graph.listens("/testudo/imu", gid=b"first"),
        lambda: graph.listens("/testudo/imu", gid=b"second"),
        graph.operators["/testudo/scan"].clear,
        graph.operators.clear,
    ]
    for change in changes:
        change()
        live.looks(1)
        said.append({(one.topic, one.are_there) for one in live.topics.listeners()})
        assert live.topics.listeners() == []
    assert said == [
        {("/imu", False)},
        {("/imu", True)},
        {("/imu", True)},
        {("/scan", False)},
        {("/imu", False)},
    ]


def test_another_run_of_the_same_robot_is_named_once() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu")
    graph.joins(STATUS_TOPIC, DRIVER, node=NODE)
    graph.joins(STATUS_TOPIC, OTHER, node="/ada/smarttestudo")
    live.looks()
    assert lines_with(graph, "relays on this ROS graph") == []
    graph.joins(STATUS_TOPIC, SECOND, node=NODE)
    live.looks()
    assert lines_with(graph, "relays on this ROS graph") == [
        f"another {NODE} relays on this ROS graph, or was killed a moment ago: "
        "end one of them, as what both relay arrives twice; or, for two robots, give each a name, as with "
        "--ros-args -r __node:=smarttestudo_2: rules can be pushed to neither so"
    ]


def test_a_topic_that_checks_read_is_subscribed_to_in_any_case() -> None:
    graph = SmallGraph()
    live = Live(graph, "/odom", watched=("/odom", "/battery"))
    for topic in ("/odom", "/battery"):
        graph.joins(topic, DRIVER)
    live.looks()
    assert graph.subscribed() == {"/odom", "/battery"}
    assert [publisher.topic for publisher in graph.advertised] == ["/testudo/odom"]


def test_where_inputs_are_recorded_everything_is_subscribed_to() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu", is_lazy=False)
    graph.joins("/imu", DRIVER)
    live.looks()
    assert graph.subscribed() == {"/imu"}


def test_a_topic_with_which_another_is_paced_is_subscribed_to_for_its_sake() -> None:
    graph = SmallGraph()
    live = Live(graph, "/image", "/info", "/imu", leaders={"/info": "/image"})
    for topic in ("/image", "/info", "/imu"):
        graph.joins(topic, DRIVER)
    graph.listens("/testudo/info")
    live.looks()
    assert graph.subscribed() == {"/image", "/info"}


def test_a_late_operator_gets_a_latched_message_that_came_before_anybody_listened() -> None:
    graph = SmallGraph()
    live = Live(graph, "/map")
    graph.joins("/map", DRIVER, transient_local=True)
    graph.sends("/map", DRIVER, b"floor")
    live.looks()
    for _ in range(3):
        graph.listens("/testudo/map", reliable=True, transient_local=True)
        live.looks()
        assert graph.for_late_subscribers("/testudo/map") == [b"floor"]
        graph.operators.clear()
        live.looks()


def two_publishers(graph: SmallGraph) -> Live:
    """One latches a map once, the other a hundred."""
    live = Live(graph, "/map")
    graph.listens("/testudo/map", reliable=True, transient_local=True)
    for gid in (DRIVER, SECOND):
        graph.joins("/map", gid, transient_local=True)
    live.looks()
    graph.sends("/map", DRIVER, b"floor")
    for number in range(100):
        graph.sends("/map", SECOND, b"%d" % number)
    return live


def test_a_publisher_that_says_much_does_not_push_out_what_another_latched() -> None:
    graph = SmallGraph()
    two_publishers(graph)
    late = graph.for_late_subscribers("/testudo/map")
    assert b"floor" in late
    assert late[-1] == b"99"
    assert not lines_with(graph, "cannot be told apart")


def test_where_publishers_cannot_be_told_apart_the_log_says_so() -> None:
    graph = SmallGraph(identifies_publishers=False)
    two_publishers(graph)
    assert lines_with(graph, "told apart") == [
        "/map: its 2 publishers cannot be told apart and share one rate"
    ]


def test_what_a_publisher_latched_goes_when_it_goes_unless_it_was_the_last() -> None:
    graph = SmallGraph()
    live = two_publishers(graph)
    graph.leaves("/map", SECOND)
    live.looks()
    assert graph.for_late_subscribers("/testudo/map") == [b"floor"]
    graph.leaves("/map", DRIVER)
    live.looks()
    assert graph.for_late_subscribers("/testudo/map") == [b"floor"]
    graph.joins("/map", OTHER, transient_local=True)
    graph.sends("/map", OTHER, b"roof")
    live.looks()
    assert graph.for_late_subscribers("/testudo/map") == [b"roof"]


def comes_and_goes(live: Live, gid: bytes, payload: bytes) -> None:
    """Somebody latches a message and is gone before the next look."""
    live.graph.joins("/map", gid, transient_local=True)
    live.graph.sends("/map", gid, payload)
    live.graph.leaves("/map", gid)
    live.looks()
    live.graph.time_ns += FOUND_WITHIN_NS
    live.looks()


def test_what_was_latched_between_two_looks_goes_with_its_publisher_too() -> None:
    graph = SmallGraph()
    live = Live(graph, "/map")
    graph.listens("/testudo/map", reliable=True, transient_local=True)
    graph.joins("/map", DRIVER, transient_local=True)
    live.looks()
    graph.sends("/map", DRIVER, b"floor")
    for number in range(100):
        comes_and_goes(live, b"brief %d" % number, b"stairs")
    assert graph.for_late_subscribers("/testudo/map") == [b"floor"]


def test_what_still_waits_for_a_link_is_not_forgotten_with_a_publisher_that_the_graph_never_showed() -> None:
    graph = SmallGraph()
    graph.keeps_newest = True
    live = Live(graph, "/map")
    graph.listens("/testudo/map", reliable=True, transient_local=True)
    graph.joins("/map", DRIVER, transient_local=True)
    live.looks()
    comes_and_goes(live, SECOND, b"stairs")
    assert graph.for_late_subscribers("/testudo/map") == [b"stairs"]


def test_of_publishers_that_all_came_and_went_between_two_looks_the_last_message_stays() -> None:
    graph = SmallGraph()
    live = Live(graph, "/map")
    graph.listens("/testudo/map", reliable=True, transient_local=True)
    graph.joins("/map", DRIVER, transient_local=True)
    live.looks()
    graph.leaves("/map", DRIVER)
    live.looks()
    for gid in (SECOND, OTHER):
        comes_and_goes(live, gid, gid)
    assert graph.for_late_subscribers("/testudo/map") == [OTHER]
    graph.joins("/map", DRIVER, transient_local=True)
    graph.sends("/map", DRIVER, b"roof")
    live.looks()
    assert graph.for_late_subscribers("/testudo/map") == [b"roof"]


def test_what_a_publisher_latched_stays_while_the_graph_has_not_found_it_yet() -> None:
    graph = SmallGraph()
    live = two_publishers(graph)
    (early,) = (one for one in graph.subscriptions if one.topic == "/map")
    early.receive(b"roof", OTHER)
    graph.time_ns += FOUND_WITHIN_NS - 1
    live.looks()
    graph.joins("/map", OTHER, transient_local=True)
    live.looks()
    graph.time_ns += FOUND_WITHIN_NS
    live.looks()
    assert b"roof" in graph.for_late_subscribers("/testudo/map")


def test_an_operator_who_asks_for_more_than_the_source_offers_is_named_once() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu")
    graph.joins("/imu", DRIVER, reliable=False)
    graph.listens("/testudo/imu", node="/rviz")
    graph.listens("/testudo/imu", node="/recorder", reliable=True, transient_local=True)
    graph.listens("/testudo/imu", node="/watchdog", asks=("a deadline",))
    live.looks(20)
    assert lines_with(graph, "asks for") == [
        "/testudo/imu: /recorder asks for reliable delivery and transient local durability, "
        "which this relay does not offer, and receives nothing; have it ask for best effort and volatile "
        "durability",
        "/testudo/imu: /watchdog asks for a deadline, which this relay does not offer, and receives nothing; "
        "have it ask for no deadline",
    ]


def test_a_node_with_two_subscriptions_that_get_nothing_is_named_once_and_counted_twice() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu")
    graph.joins("/imu", DRIVER, reliable=False)
    graph.listens("/testudo/imu", node="/rviz", reliable=True, gid=b"image")
    graph.listens("/testudo/imu", node="/rviz", reliable=True, gid=b"camera")
    live.looks()
    link = live.known["/imu"].link()
    assert (link.subscribers, link.unserved, link.incompatible) == (2, 2, ("/rviz",))


def test_a_topic_that_comes_back_with_another_type_is_opened_anew() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu")
    graph.installed.add("a_msgs/msg/A")
    graph.listens("/testudo/imu")
    graph.joins("/imu", DRIVER)
    live.looks()
    graph.leaves("/imu", DRIVER)
    live.looks()
    graph.joins("/imu", DRIVER, type_name="a_msgs/msg/A")
    live.looks()
    assert [one.type_name for one in graph.subscriptions] == ["a_msgs/msg/A"]
    assert [one.type_name for one in graph.advertised] == ["a_msgs/msg/A"]


def test_a_type_that_is_not_installed_costs_that_topic_only() -> None:
    graph = SmallGraph()
    live = Live(graph, "/odd", "/imu", is_lazy=False)
    graph.joins("/odd", DRIVER, type_name="odd_msgs/msg/Odd")
    graph.joins("/imu", DRIVER)
    live.looks(20)
    assert graph.subscribed() == {"/imu"}
    assert lines_with(graph, "installed") == [
        "/testudo/odd: error: the message type odd_msgs/msg/Odd is not installed"
    ]
    assert live.known["/odd"].link().problem == "the message type odd_msgs/msg/Odd is not installed"


def test_a_publisher_replaced_by_one_with_another_qos_is_noticed_within_a_second() -> None:
    graph = SmallGraph()
    live = Live(graph, *(f"/t{number}" for number in range(7)), is_lazy=False)
    for number in range(7):
        graph.joins(f"/t{number}", DRIVER)
    live.looks()
    for number in range(7):
        graph.leaves(f"/t{number}", DRIVER)
        graph.joins(f"/t{number}", SECOND, reliable=False)
    live.looks(5)
    assert not any(publisher.qos.reliable for publisher in graph.advertised)


@pytest.mark.parametrize("topics", [1, 200])
def test_a_quiet_graph_is_asked_for_each_topic_once_a_second(topics: int) -> None:
    graph = SmallGraph()
    live = Live(graph, *(f"/t{number}" for number in range(topics)))
    for number in range(topics):
        graph.joins(f"/t{number}", DRIVER)
    live.looks()
    graph.asked.clear()
    live.looks(5)
    assert {graph.asked[f"/t{number}"] for number in range(topics)} == {1}


def test_a_recorded_topic_that_is_relayed_or_read_from_now_on_stays_subscribed_to_and_is_told_of() -> None:
    graph = SmallGraph()
    live = Live(graph)
    live.topics.follow({}, (), {}, recorded=("/imu", "/odom"))
    for topic in ("/imu", "/odom"):
        graph.joins(topic, DRIVER)
    live.looks()
    before = list(graph.subscriptions)
    assert [one.topic for one in before] == ["/imu", "/odom"]
    live.topics.follow({"/imu": "/testudo/imu"}, ("/odom",), {}, recorded=("/imu", "/odom"))
    assert {change.topic for change in live.topics.poll(GraphChange.UNREPORTED)} == {"/imu", "/odom"}
    assert live.topics.poll(GraphChange.UNREPORTED) == []
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]
    live.topics.follow({}, ("/imu",), {}, recorded=("/imu", "/odom"))
    live.looks()
    assert graph.subscriptions == before
    assert graph.advertised == []
    ends = {name: topic.ends(is_published=True) for name, topic in live.known.items()}
    assert ends == {"/odom": (before[1], None), "/imu": None}


def test_a_latched_topic_that_is_recorded_has_what_was_latched_at_its_new_output() -> None:
    graph = SmallGraph()
    live = Live(graph)
    live.topics.follow({}, (), {}, recorded=("/map",))
    graph.joins("/map", DRIVER, transient_local=True)
    live.looks()
    graph.sends("/map", DRIVER, b"floor")
    live.topics.follow({"/map": "/testudo/map"}, (), {}, recorded=("/map",))
    live.looks()
    assert graph.for_late_subscribers("/testudo/map") == [b"floor"]


def test_on_a_graph_that_has_changed_a_publisher_that_replaced_another_is_found_at_once() -> None:
    graph = SmallGraph()
    topics = [f"/t{number}" for number in range(5)]
    live = Live(graph, *topics)
    for topic in topics:
        graph.joins(topic, DRIVER)
    live.looks(6)
    for topic in topics:
        graph.leaves(topic, DRIVER)
        graph.joins(topic, DRIVER, reliable=False)
    live.topics.poll(GraphChange.REPORTED)
    sources = {publisher.topic: publisher.qos.reliable for publisher in graph.advertised}
    assert sources == {f"/testudo{topic}": False for topic in topics}

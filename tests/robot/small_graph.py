# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A ROS graph in memory: what the middleware promises of publishers, subscriptions and latched messages."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import (
    DataPath,
    Diagnostic,
    Endpoint,
    Payload,
    PollGraph,
    Publisher,
    Qos,
    Receive,
    RobotLog,
    Subscription,
)
from smarttestudo.domain.type_definition import TypeDefinition
from smarttestudo.language.standard_types import STANDARD_TYPES
from unasked_robot import UnaskedRobot

NODE = "/smarttestudo"
TEXT = "std_msgs/msg/String"


class MemorySubscription:
    sent = None
    dropped = 0

    def __init__(self, graph: SmallGraph, topic: str, type_name: str, receive: Receive) -> None:
        self._graph = graph
        self.topic = topic
        self.type_name = type_name
        self.receive = receive

    def close(self) -> None:
        self._graph.subscriptions.remove(self)


class MemoryPublisher:
    def __init__(self, graph: SmallGraph, topic: str, type_name: str, qos: Qos) -> None:
        self._graph = graph
        self.topic = topic
        self.type_name = type_name
        self.qos = qos
        self.kept: deque[bytes] = deque(maxlen=qos.depth)

    def publish(self, payload: Payload) -> None:
        self.kept.append(payload[:])
        self._graph.published.append((self.topic, payload[:]))

    def close(self) -> None:
        self._graph.advertised.remove(self)


class SmallGraph(UnaskedRobot):
    """A ``Robot`` and its ``DataPath``; the test says who publishes and subscribes."""

    description = "in memory"
    can_pause = False
    compiled = None
    keeps_newest = False
    has_output_domain = False

    def __init__(self, *, identifies_publishers: bool = True) -> None:
        self.identifies_publishers = identifies_publishers
        self.sources: dict[str, list[Endpoint]] = {}
        self.operators: dict[str, list[Endpoint]] = {}
        self.latched: dict[tuple[str, bytes], bytes] = {}
        self.installed = {TEXT}
        self.subscriptions: list[MemorySubscription] = []
        self.advertised: list[MemoryPublisher] = []
        self.published: list[tuple[str, bytes]] = []
        self.lines: list[str] = []
        self.asked: Counter[str] = Counter()
        self.time_ns = 1

    # What a test does and sees.

    def joins(
        self,
        topic: str,
        gid: bytes,
        *,
        node: str = "/driver",
        type_name: str = TEXT,
        reliable: bool = True,
        transient_local: bool = False,
    ) -> None:
        """A publisher comes."""
        endpoint = Endpoint(
            node=node, type_name=type_name, reliable=reliable, transient_local=transient_local, gid=gid
        )
        self.sources.setdefault(topic, []).append(endpoint)

    def leaves(self, topic: str, gid: bytes) -> None:
        """A publisher goes."""
        self.sources[topic] = [one for one in self.sources[topic] if one.gid != gid]
        self.latched.pop((topic, gid), None)

    def listens(
        self,
        topic: str,
        *,
        node: str = "/rviz",
        reliable: bool = False,
        transient_local: bool = False,
        asks: tuple[str, ...] = (),
        gid: bytes = b"",
    ) -> None:
        """An operator subscribes."""
        endpoint = Endpoint(
            node=node, type_name=TEXT, reliable=reliable, transient_local=transient_local, asks=asks, gid=gid
        )
        self.operators.setdefault(topic, []).append(endpoint)

    def sends(self, topic: str, gid: bytes, payload: bytes) -> None:
        """A publisher says something."""
        (publisher,) = (one for one in self.sources[topic] if one.gid == gid)
        if publisher.transient_local:
            self.latched[topic, gid] = payload
        for subscription in list(self.subscriptions):
            if subscription.topic == topic:
                subscription.receive(payload, gid if self.identifies_publishers else None)

    def subscribed(self) -> set[str]:
        return {subscription.topic for subscription in self.subscriptions}

    def for_late_subscribers(self, topic: str) -> list[bytes]:
        """What an operator gets who subscribes to a latched topic now."""
        return [
            payload for publisher in self.advertised if publisher.topic == topic for payload in publisher.kept
        ]

    # What the runtime asks.

    @property
    def name(self) -> str:
        return NODE

    @property
    def log(self) -> RobotLog:
        return self

    def info(self, message: str) -> None:
        self.lines.append(message)

    def warning(self, message: str) -> None:
        self.lines.append(message)

    @property
    def data_path(self) -> DataPath:
        return self

    def steady_ns(self) -> int:
        return self.time_ns

    def now_ns(self) -> int:
        return 1

    def resolve(self, topic: str) -> str:
        return topic

    def resolve_output(self, topic: str) -> str:
        return topic

    def publishers(self, topic: str) -> Sequence[Endpoint]:
        self.asked[topic] += 1
        return list(self.sources.get(topic, ()))

    def publisher_count(self, topic: str) -> int:
        return len(self.sources.get(topic, ()))

    def subscribers(self, topic: str) -> Sequence[Endpoint]:
        return list(self.operators.get(topic, ()))

    def subscriber_count(self, topic: str) -> int:
        return len(self.operators.get(topic, ()))

    def local_subscriber_count(self, topic: str) -> int:
        return self.subscriber_count(topic)

    def topics(self) -> Mapping[str, Sequence[str]]:
        return {topic: [one.type_name for one in publishers] for topic, publishers in self.sources.items()}

    def begins_with_header(self, type_name: str) -> bool:
        return False

    def type_definition(self, type_name: str) -> TypeDefinition | None:
        return STANDARD_TYPES.get(type_name)

    def diagnostics_publisher(self, topic: str) -> Callable[[Sequence[Diagnostic]], None]:
        return lambda diagnostics: None

    def text_publisher(self, topic: str, qos: Qos, *, goes_over_link: bool = True) -> Callable[[str], None]:
        return lambda text: None

    def every(self, period_s: float, act: Callable[[], float | None]) -> None: ...

    def poll_graph(self, poll: PollGraph) -> None: ...

    def wait(self, wake_ns: int | None, longest_s: float) -> None: ...

    def knows(self, type_name: str) -> bool:
        return type_name in self.installed

    def subscribe(
        self, topic: str, type_name: str, qos: Qos, receive: Receive, *, priority: float = 1.0
    ) -> Subscription:
        self._require(topic, type_name)
        subscription = MemorySubscription(self, topic, type_name, receive)
        self.subscriptions.append(subscription)
        if qos.transient_local:
            for (latched_topic, gid), payload in self.latched.items():
                if latched_topic == topic:
                    receive(payload, gid if self.identifies_publishers else None)
        return subscription

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        self._require(topic, type_name)
        publisher = MemoryPublisher(self, topic, type_name, qos)
        self.advertised.append(publisher)
        return publisher

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        raise RosError("nothing can be decoded here", place=topic)

    def _require(self, topic: str, type_name: str) -> None:
        if not self.knows(type_name):
            raise RosError(f"the message type {type_name} is not installed", place=topic)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A ROS graph in virtual time, as a ``Robot``: waiting is what makes time pass and messages come."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import cast

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

SECOND = 1_000_000_000
MESSAGE = bytes(250)


@dataclass(kw_only=True)
class Source:
    """A topic of ``nodes`` that publishes ``hz`` messages a second, from ``from_s`` on.

    Of ``one_of`` only one comes.
    """

    type_name: str = "sensor_msgs/msg/Imu"
    nodes: tuple[str, ...] = ("/driver",)
    hz: float = 0.0
    from_s: float = 0.0
    one_of: int = 1


@dataclass(kw_only=True)
class VirtualRobot(UnaskedRobot):
    """``sources`` by topic; ``texts`` are what text topics were told, ``log_lines`` the log."""

    sources: dict[str, Source] = field(default_factory=dict)
    missing_types: frozenset[str] = frozenset()
    start_ns: int = 1_700_000_000 * SECOND
    name: str = "/smarttestudo"
    listeners: int = 0
    has_output_domain: bool = False
    description: str = "in virtual time"
    identifies_publishers: bool = True
    can_pause: bool = False
    compiled: None = None
    keeps_newest: bool = False

    def __post_init__(self) -> None:
        self.elapsed_ns = 0
        self.texts: list[tuple[str, str]] = []
        self.diagnostics: list[Sequence[Diagnostic]] = []
        self.log_lines: list[str] = []
        self.receivers: dict[str, Receive] = {}
        self.sent: dict[str, int] = {}
        self.subscriptions: dict[str, SimpleNamespace] = {}
        append = self.log_lines.append
        self.log = cast("RobotLog", SimpleNamespace(info=append, warning=append))

    @property
    def data_path(self) -> DataPath:
        return self

    def now_ns(self) -> int:
        return self.start_ns + self.elapsed_ns if self.start_ns else 0

    def steady_s(self) -> float:
        return self.elapsed_ns / SECOND

    def steady_ns(self) -> int:
        return self.elapsed_ns

    def resolve(self, topic: str) -> str:
        return topic

    def resolve_output(self, topic: str) -> str:
        return topic

    def topics(self) -> Mapping[str, Sequence[str]]:
        return {topic: [source.type_name] for topic, source in self.sources.items() if self._is_there(source)}

    def publishers(self, topic: str) -> Sequence[Endpoint]:
        source = self.sources.get(topic)
        if source is None or not self._is_there(source):
            return []
        return [
            Endpoint(node=node, type_name=source.type_name, reliable=True, transient_local=source.hz == 0)
            for node in source.nodes
        ]

    def publisher_count(self, topic: str) -> int:
        return len(self.publishers(topic))

    def subscribers(self, topic: str) -> Sequence[Endpoint]:
        return []

    def subscriber_count(self, topic: str) -> int:
        return self.listeners

    def local_subscriber_count(self, topic: str) -> int:
        return self.subscriber_count(topic)

    def begins_with_header(self, type_name: str) -> bool:
        return False

    def type_definition(self, type_name: str) -> TypeDefinition | None:
        return STANDARD_TYPES.get(type_name)

    def knows(self, type_name: str) -> bool:
        return type_name not in self.missing_types

    def subscribe(
        self, topic: str, type_name: str, qos: Qos, receive: Receive, *, priority: float = 1.0
    ) -> Subscription:
        self._need(type_name, topic)
        self.receivers[topic] = receive
        self.sent[topic] = 0
        self.subscriptions[topic] = SimpleNamespace(close=lambda: None, sent=0, dropped=0)
        return cast("Subscription", self.subscriptions[topic])

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        raise NotImplementedError

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        return SimpleNamespace(data=payload[:].decode("utf-8"))

    def text_publisher(self, topic: str, qos: Qos, *, goes_over_link: bool = True) -> Callable[[str], None]:
        self._need("std_msgs/msg/String", topic)
        return lambda text: self.texts.append((topic, text))

    def diagnostics_publisher(self, topic: str) -> Callable[[Sequence[Diagnostic]], None]:
        self._need("diagnostic_msgs/msg/DiagnosticArray", topic)
        return self.diagnostics.append

    def every(self, period_s: float, act: Callable[[], float | None]) -> None:
        raise NotImplementedError

    def poll_graph(self, poll: PollGraph) -> None:
        raise NotImplementedError

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        self.elapsed_ns += round(longest_s * SECOND)
        for topic, receive in list(self.receivers.items()):
            source = self.sources[topic]
            due = int((self.elapsed_ns / SECOND - source.from_s) * source.hz) if source.hz else 1
            for _ in range(due - self.sent[topic]):
                self.sent[topic] += 1
                subscription = self.subscriptions[topic]
                subscription.sent += 1
                if self.sent[topic] % source.one_of:
                    subscription.dropped += 1
                else:
                    receive(MESSAGE, None)

    def say(self, topic: str, text: str, publisher: Hashable = None) -> None:
        """Somebody publishes ``text`` on a topic that is subscribed to."""
        self.receivers[topic](text.encode("utf-8"), publisher)

    def _is_there(self, source: Source) -> bool:
        return self.elapsed_ns >= source.from_s * SECOND

    def _need(self, type_name: str, topic: str) -> None:
        if not self.knows(type_name):
            raise RosError(f"the message type {type_name} is not installed", place=topic)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The data path through librcl: serialized messages in the middleware's own buffers."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any
from weakref import WeakSet

from rclpy.executors import TimeoutException

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Payload, Publisher, Qos, Receive, Subscription
from smarttestudo.robot.ros.message_types import decoded, is_installed
from smarttestudo.robot.ros.rcl.bindings import InfoLayout, RclLibrary
from smarttestudo.robot.ros.rcl.compiled_relays import RclRelays
from smarttestudo.robot.ros.rcl.graph import GraphEvents
from smarttestudo.robot.ros.rcl.publisher import RclPublisher, TimedCallbackGroup
from smarttestudo.robot.ros.rcl.relay_library import RelayLibrary
from smarttestudo.robot.ros.rcl.subscription import RclSource, RclSubscription, RclTaker, UnusedCallbackGroup
from smarttestudo.robot.ros.rcl.wake_ups import RclWakeUps
from smarttestudo.robot.ros.rclpy_path import ByteTopics
from smarttestudo.robot.ros.real_timers import LEAST_PERIOD_S

UNTOLD_PERIOD_S = 5.0
"""How often rclpy's executor checks for work without a wake-up, beside each change of the graph."""
WARNS_S = 2 * UNTOLD_PERIOD_S
"""How long after a change of the graph rclpy may warn of a subscriber that its publishers do not suit."""


class RclpyPart:
    """Runs rclpy's executor when a service, client or subscription of the node has something for it."""

    priority = 1.0

    def __init__(self, node: Any, executor: Any, library: RclLibrary, wake_ups: RclWakeUps) -> None:
        self._node = node
        self._executor = executor
        self._library = library
        self._wake_ups = wake_ups
        self._known: WeakSet[Any] = WeakSet()
        self._event_fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._poll_s = time.monotonic()
        wake_ups.add(self._event_fd, self)

    def serve(self, most: int) -> bool:
        """Run up to ``most`` callbacks; whether there may be more."""
        # In Humble a wake-up may come before what it is for can be taken.
        self._poll_s = min(self._poll_s, time.monotonic() + LEAST_PERIOD_S)
        return self._run(most)

    def _run(self, most: int) -> bool:
        for _ in range(most):
            try:
                task, _, _ = self._executor.wait_for_ready_callbacks(timeout_sec=0)
            except TimeoutException:
                return False
            task()
            if task.exception() is not None:
                raise task.exception()
        return True

    def poll_next(self) -> None:
        """Have the next ``poll`` do it."""
        self._poll_s = time.monotonic()

    def poll(self, period_s: float) -> None:
        """Do what nothing wakes for, if it is time; then again after ``period_s``."""
        if time.monotonic() >= self._poll_s:
            self._poll_s = time.monotonic() + period_s
            self._attend()
            while self._run(1):
                pass

    def close(self) -> None:
        """Run nothing more."""
        for wake_on, entity in self._entities():
            if entity in self._known:
                wake_on(entity.handle.pointer, None)
        self._wake_ups.remove(self._event_fd)
        os.close(self._event_fd)

    def _attend(self) -> None:
        for wake_on, entity in self._entities():
            if entity not in self._known:
                wake_on(entity.handle.pointer, self._event_fd)
                self._known.add(entity)

    def _entities(self) -> Iterator[tuple[Callable[[int, int | None], None], Any]]:
        """Entities for which rclpy has a callback, each after the function that has one woken for it."""
        for service in self._node.services:
            yield self._library.wake_on_request, service
        for client in self._node.clients:
            yield self._library.wake_on_answer, client
        for subscription in self._node.subscriptions:
            if not isinstance(subscription.callback_group, UnusedCallbackGroup):
                yield self._library.wake_on_message, subscription


class RclPath:
    """Subscriptions whose messages rclpy's executor never sees, and publishers that take them as they are.

    ``compiled`` is what relays topics without Python, where there is a library for it. ``on_graph_change`` is
    called when publishers or subscribers came or went, within ``wait``, while the path ``reports_graph``.
    """

    keeps_newest = False

    def __init__(
        self,
        node: Any,
        executor: Any,
        operators: Any,
        byte_topics: ByteTopics,
        *,
        library: RclLibrary,
        layout: InfoLayout,
        relays: RelayLibrary | None,
        on_graph_change: Callable[[], None],
    ) -> None:
        self._node = node
        self._operators = operators
        self._byte_topics = byte_topics
        self._library = library
        self._layout = layout
        self.identifies_publishers, self.can_pause = layout.gid_bytes > 0, layout.is_numbered
        self._failures: set[str] = set()
        self._wake_ups = RclWakeUps()
        self.compiled: RclRelays | None = None
        if relays is not None:
            self.compiled = RclRelays(relays, library, layout, self._is_simulated, self._failed)
            self._wake_ups.add(self.compiled.copies.event_fd, None)
        self._rclpy_part = RclpyPart(node, executor, library, self._wake_ups)
        self._on_graph_change = on_graph_change
        self._changed_s = -math.inf
        nodes = [node] if operators is node else [node, operators]
        self._graph = GraphEvents(nodes, library, self._wake_ups, self._changed)

    @property
    def description(self) -> str:
        """Which path this is, and what it can do."""
        publishers = "publishers told apart" if self.identifies_publishers else "publishers not told apart"
        numbered = f"messages {'' if self.can_pause else 'not '}numbered"
        compiled = f"{'no ' if self.compiled is None else ''}compiled relays"
        problem = self._graph.problem
        looks = "" if problem is None else f", the graph checked five times a second because {problem}"
        return f"librcl, {publishers}, {numbered}, {compiled}{looks}"

    @property
    def reports_graph(self) -> bool:
        """Whether ``on_graph_change`` is called."""
        return self._graph.problem is None

    def knows(self, type_name: str) -> bool:
        return is_installed(type_name)

    def subscribe(
        self, topic: str, type_name: str, qos: Qos, receive: Receive, *, priority: float = 1.0
    ) -> Subscription:
        if self._byte_topics.must_be_decoded(type_name):
            return self._byte_topics.subscribe(topic, type_name, qos, receive)
        return RclSource(
            partial(RclSubscription, self._node, self._library, topic, type_name),
            qos,
            receive,
            taker=RclTaker(self._library, self._layout, self._failed),
            wake_ups=self._wake_ups,
            priority=priority,
        )

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        events = TimedCallbackGroup(self._may_warn)
        return RclPublisher(self._operators, self._library, topic, type_name, qos, events=events)

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        return decoded(topic, type_name, payload)

    def wait(self, timeout_s: float) -> None:
        """Deliver what comes next; return after it or after ``timeout_s``."""
        self._wake_ups.wait(timeout_s)
        self._rclpy_part.poll(UNTOLD_PERIOD_S if self.reports_graph else LEAST_PERIOD_S)

    def close(self) -> None:
        """Deliver nothing more."""
        if self.compiled is not None:
            self.compiled.close()
        self._graph.close()
        self._rclpy_part.close()
        self._wake_ups.close()

    def _is_simulated(self) -> bool:
        is_simulated: bool = self._node.get_clock().ros_time_is_active
        return is_simulated

    def _changed(self) -> None:
        if self._graph.problem is not None:
            self._failed(RosError(f"changes of the graph are no longer reported: {self._graph.problem}"))
        # New services of ours change it, and so does what rclpy warns of: a subscriber with another QoS.
        self._changed_s = time.monotonic()
        self._rclpy_part.poll_next()
        self._on_graph_change()

    def _may_warn(self) -> bool:
        # The executor takes milliseconds to wait for the events of hundreds of publishers.
        return not self.reports_graph or time.monotonic() < self._changed_s + WARNS_S

    def _failed(self, error: RosError) -> None:
        if str(error) not in self._failures:
            self._failures.add(str(error))
            self._node.get_logger().warning(str(error))

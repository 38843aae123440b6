# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The node on the robot's graph."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from typing import TYPE_CHECKING, Any

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from smarttestudo.domain.errors import RosError, TestudoError
from smarttestudo.domain.names import is_known_to_ros
from smarttestudo.domain.parameter import (
    Accept,
    Parameter,
    ParameterValue,
    Refusals,
    RemoteParameters,
    Values,
)
from smarttestudo.domain.robot import (
    Called,
    DataPath,
    DataPathKind,
    Diagnostic,
    Endpoint,
    OutputDomain,
    PollGraph,
    Publisher,
    Qos,
)
from smarttestudo.domain.texts import in_utf_8
from smarttestudo.domain.type_definition import TypeDefinition
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.ros.contexts import operators_node, own_context
from smarttestudo.robot.ros.data_path import open_data_path
from smarttestudo.robot.ros.message_types import (
    begins_with_header,
    message_definition,
    message_type,
    type_definition,
)
from smarttestudo.robot.ros.node_log import node_log
from smarttestudo.robot.ros.parameters import NodeParameterClients, NodeParameters
from smarttestudo.robot.ros.qos import further_policies, is_reliable, is_transient_local, qos_profile
from smarttestudo.robot.ros.rclpy_path import RclpyPath, RclpyPublisher
from smarttestudo.robot.ros.real_timers import GraphPolls, RealTimers
from smarttestudo.robot.ros.ros_errors import ros_errors
from smarttestudo.robot.ros.service_clients import REMOTE_POLL_PERIOD_S, ServiceClients
from smarttestudo.robot.ros.shared_memory import is_fast_dds, room_for_large_messages, senders_remedy
from smarttestudo.robot.ros.status_players import StatusPlayers

if TYPE_CHECKING:
    from smarttestudo.robot.ros.rcl.path import RclPath


CLOCK_PERIOD_S = 1.0
"""How often to look whether time is simulated; a parameter of the node may change that."""
_HOST_BYTES = 4
"""Two of the vendor and two of the host, in a GID of Fast DDS."""

_DIAGNOSTICS_DEPTH = 10


@contextmanager
def open_node(
    ros_arguments: Sequence[str],
    name: str,
    output_domain: OutputDomain | None,
    make: Callable[[Any, Any, Any], RosNode],
    *,
    sends_large: bool = False,
) -> Iterator[RosNode]:
    """A node ``name`` with a context of its own, both gone at the end; signals are left to the caller.

    ``make`` makes it of the rclpy node, its executor and the node that publishes. The first node of a process
    says whether it ``sends_large`` messages.
    """
    with own_context(ros_arguments) as context:
        with ros_errors(name), room_for_large_messages() if sends_large else nullcontext() as problem:
            node = Node(name, context=context)
        if problem is not None:
            node.get_logger().warning(problem)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        try:
            with operators_node(node, output_domain) as operators:
                robot = make(node, executor, operators)
                try:
                    yield robot
                finally:
                    robot.close()
        finally:
            executor.shutdown()
            node.destroy_node()


class RosNode:
    """An rclpy node with an executor of one thread, as a ``Robot``; the node ``operators`` publishes."""

    def __init__(self, node: Any, executor: Any, operators: Any, data_path_kind: DataPathKind) -> None:
        self._node = node
        self.log = node_log(node)
        self._operators = operators
        self._executor = executor
        self._clock = node.get_clock()
        self._data_path_kind = data_path_kind
        self._data_path: RclPath | RclpyPath | None = None
        self._opened = ExitStack()
        self._timers = RealTimers()
        self._graph_polls: GraphPolls | None = None
        self._host = _own_host(node)
        self._poll_clock()
        self.every(CLOCK_PERIOD_S, self._poll_clock)
        self._parameters = NodeParameters(node)
        self._services: ServiceClients | None = None
        self._status_players = StatusPlayers(time.monotonic)

    @property
    def name(self) -> str:
        name: str = self._node.get_fully_qualified_name()
        return name

    @property
    def fed_nodes(self) -> frozenset[str]:
        """None, without a link."""
        return frozenset()

    @property
    def doubted_nodes(self) -> frozenset[str]:
        """Nodes that may be players."""
        return self._status_players.doubted

    def players(self, nodes: Collection[str]) -> frozenset[str]:
        """Players among ``nodes``."""
        return self._status_players.among(nodes, self._open_data_path)

    @property
    def data_path(self) -> DataPath:
        """Messages in and out, by the path that works here. Raises ``RosError``."""
        return self._open_data_path()

    @property
    def has_output_domain(self) -> bool:
        return self._operators is not self._node

    @property
    def senders_remedy(self) -> str | None:
        return senders_remedy() if is_fast_dds() else None

    def now_ns(self) -> int:
        # Unless simulated, the clock of ROS is the system's, and that is asked for every message.
        now_ns: int = self._clock.now().nanoseconds if self.is_time_simulated else time.time_ns()
        return now_ns

    def resolve(self, topic: str) -> str:
        return full_name(self._node, topic)

    def resolve_output(self, topic: str) -> str:
        return full_name(self._operators, topic)

    def publishers(self, topic: str) -> Sequence[Endpoint]:
        with ros_errors(topic):
            return [_endpoint(one, self._host) for one in self._node.get_publishers_info_by_topic(topic)]

    def publisher_count(self, topic: str) -> int:
        handle = self._node.handle
        with ros_errors(topic), handle:
            count: int = handle.get_count_publishers(topic)
        return count

    def subscribers(self, topic: str) -> Sequence[Endpoint]:
        """Subscribers of ``topic`` now, as far as discovered."""
        with ros_errors(topic):
            return [
                _endpoint(one, self._host) for one in self._operators.get_subscriptions_info_by_topic(topic)
            ]

    def subscriber_count(self, topic: str) -> int:
        handle = self._operators.handle
        with ros_errors(topic), handle:
            count: int = handle.get_count_subscribers(topic)
        return count

    def local_subscriber_count(self, topic: str) -> int:
        """How many subscribe to ``topic`` on the graph that the node publishes on."""
        return self.subscriber_count(topic)

    def own_subscribers(self, topic: str) -> Sequence[Endpoint]:
        with ros_errors(topic):
            return [_endpoint(one, self._host) for one in self._node.get_subscriptions_info_by_topic(topic)]

    def own_publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        return RclpyPublisher(self._node, topic, type_name, qos)

    def topics(self) -> Mapping[str, Sequence[str]]:
        with ros_errors():
            found = dict(self._node.get_topic_names_and_types())
        return {name: types for name, types in found.items() if is_known_to_ros(name)}

    def begins_with_header(self, type_name: str) -> bool:
        return begins_with_header(type_name)

    def definition(self, type_name: str) -> str:
        return message_definition(type_name)

    def type_definition(self, type_name: str) -> TypeDefinition | None:
        return type_definition(type_name)

    def diagnostics_publisher(self, topic: str) -> Callable[[Sequence[Diagnostic]], None]:
        return diagnostics_publisher(self._operators, topic, self._clock)

    def text_publisher(
        self,
        topic: str,
        qos: Qos,
        *,
        goes_over_link: bool = True,  # noqa: ARG002 - this one has no link
    ) -> Callable[[str], None]:
        text_type = message_type("std_msgs/msg/String", topic)
        with ros_errors(topic):
            publisher = self._operators.create_publisher(text_type, topic, qos_profile(qos))

        def publish(text: str) -> None:
            with ros_errors(topic):
                publisher.publish(text_type(data=in_utf_8(text)))

        return publish

    def steady_ns(self) -> int:
        if sys.platform == "linux":
            return time.clock_gettime_ns(time.CLOCK_BOOTTIME)
        return time.monotonic_ns()

    def declare(self, parameters: Sequence[Parameter], accept: Accept) -> Mapping[str, ParameterValue]:
        return self._parameters.declare(parameters, accept)

    def show(self, name: str, value: ParameterValue) -> None:
        """Give a parameter another value without acceptance."""
        self._parameters.show(name, value)

    def parameters(self, names: Sequence[str]) -> Values:
        return self._parameters.values(names)

    def set_parameters(self, values: Values) -> Refusals:
        return self._parameters.set(values)

    def offer_trigger(self, name: str, act: Callable[[], str]) -> None:
        """Offer a std_srvs/srv/Trigger service that calls ``act``. Raises ``RosError``."""
        offer_trigger(self._node, name, act)

    @property
    def remote_parameters(self) -> RemoteParameters:
        """Parameters of other nodes."""
        return NodeParameterClients(self._open_services())

    def call_service(self, service: str, *, argument: bool | None, called: Called) -> None:
        self._open_services().call(service, argument=argument, called=called)

    def every(self, period_s: float, act: Callable[[], float | None]) -> None:
        """Have ``act`` called again and again, in real time; after what it returns, or ``period_s``."""
        self._timers.add(period_s, act, time.monotonic())

    def poll_graph(self, poll: PollGraph) -> None:
        """Have ``poll`` called soon after publishers or subscribers came or went, and now and then."""
        path = self._open_data_path()
        self._graph_polls = GraphPolls(self._timers, poll, lambda: path.reports_graph, time.monotonic)

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        timeout_s = min(longest_s, max(self._timers.due_s - time.monotonic(), 0.0))
        # Simulated time moves only with a message on /clock, and that ends the wait.
        if wake_ns is not None and not self.is_time_simulated:
            timeout_s = min(timeout_s, max(wake_ns - time.time_ns(), 0) / NS_PER_S)
        if self._data_path is None:
            self._executor.spin_once(timeout_sec=timeout_s)
        else:
            self._data_path.wait(timeout_s)
        now_s = time.monotonic()
        if now_s >= self._timers.due_s:
            self._timers.act(now_s)

    def close(self) -> None:
        """Receive and send nothing more."""
        self._opened.close()

    def _open_services(self) -> ServiceClients:
        if self._services is None:
            self._services = ServiceClients(self._node, time.monotonic)
            self.every(REMOTE_POLL_PERIOD_S, self._services.poll)
        return self._services

    def _open_data_path(self) -> RclPath | RclpyPath:
        if self._data_path is None:
            self._data_path = open_data_path(
                self._node,
                self._executor,
                self._data_path_kind,
                self._operators,
                opened=self._opened,
                on_graph_change=self._hasten_poll,
            )
        return self._data_path

    def _hasten_poll(self) -> None:
        if self._graph_polls is not None:
            self._graph_polls.changed()

    def _poll_clock(self) -> None:
        self.is_time_simulated: bool = self._clock.ros_time_is_active


def _endpoint(info: Any, host: bytes) -> Endpoint:
    gid = bytes(info.endpoint_gid)
    return Endpoint(
        node=_node_of(info),
        type_name=info.topic_type,
        reliable=is_reliable(info.qos_profile),
        transient_local=is_transient_local(info.qos_profile),
        gid=gid,
        asks=further_policies(info.qos_profile),
        is_local=bool(host) and gid.startswith(host),
    )


def _own_host(node: Any) -> bytes:
    """How the GIDs of this machine begin, with Fast DDS: by its vendor and the host; empty where unknown."""
    if not is_fast_dds():
        return b""
    # Each node publishes its parameters' events.
    found = node.get_publishers_info_by_topic("/parameter_events")
    own = [one for one in found if _node_of(one) == node.get_fully_qualified_name()]
    return bytes(own[0].endpoint_gid[:_HOST_BYTES]) if own else b""


def _node_of(info: Any) -> str:
    return f"{info.node_namespace.rstrip('/')}/{info.node_name}"


def full_name(node: Any, topic: str) -> str:
    """The full name of ``topic`` in the namespace of ``node``, remapped. Raises ``RosError``."""
    with ros_errors(topic):
        name: str = node.resolve_topic_name(topic)
    return name


def offer_trigger(node: Any, name: str, act: Callable[[], str]) -> None:
    """Offer a std_srvs/srv/Trigger service that calls ``act``. Raises ``RosError``.

    It succeeds with the message that ``act`` returns, and fails with its ``TestudoError``.
    """
    try:
        from std_srvs.srv import Trigger  # noqa: PLC0415  a robot may lack it
    except ImportError as error:
        remedy = "install the ROS package std_srvs"
        raise RosError("the type of this service is not installed", place=name, remedy=remedy) from error

    def called(_request: Any, response: Any) -> Any:
        try:
            response.message = in_utf_8(act())
            response.success = True
        except TestudoError as error:
            response.message = in_utf_8(str(error))
            response.success = False
        return response

    with ros_errors(name):
        node.create_service(Trigger, name, called)


def diagnostics_publisher(node: Any, topic: str, clock: Any) -> Callable[[Sequence[Diagnostic]], None]:
    """Sender of a DiagnosticArray, stamped by ``clock``, on ``topic``; both may raise ``RosError``."""
    array_type = message_type("diagnostic_msgs/msg/DiagnosticArray", topic)
    status_type = message_type("diagnostic_msgs/msg/DiagnosticStatus", topic)
    value_type = message_type("diagnostic_msgs/msg/KeyValue", topic)
    with ros_errors(topic):
        publisher = node.create_publisher(array_type, topic, _DIAGNOSTICS_DEPTH)

    def publish(diagnostics: Sequence[Diagnostic]) -> None:
        message = array_type()
        message.header.stamp = clock.now().to_msg()
        message.status = [
            status_type(
                level=bytes([one.level]),
                name=one.name,
                message=one.message,
                hardware_id=one.hardware_id,
                values=[value_type(key=key, value=value) for key, value in one.values.items()],
            )
            for one in diagnostics
        ]
        with ros_errors(topic):
            publisher.publish(message)

    return publish

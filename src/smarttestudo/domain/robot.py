# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Interface of a robot's ROS graph to the live runtime."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum, auto
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

from smarttestudo.domain.parameter import (
    Accept,
    Parameter,
    ParameterValue,
    Refusals,
    RemoteParameters,
    Values,
)

if TYPE_CHECKING:
    from smarttestudo.domain.compiled_relay import CompiledRelays
    from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.names import NAME_OPTION, STATUS_TOPIC
from smarttestudo.domain.type_definition import TypeDefinition


class Payload(Protocol):
    """The bytes of a serialized message: ``bytes`` itself, or a buffer of the middleware.

    Its content never changes while somebody holds it. ``payload[a:b]`` copies a part, and ``payload[:]``,
    unless it is ``bytes``, all of it: a large message is copied only where somebody looks.
    """

    def __len__(self) -> int: ...

    def __getitem__(self, part: slice, /) -> bytes: ...


Receive = Callable[[Payload, Hashable], None]
"""Takes a serialized message and the identity of its publisher, or ``None``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Qos:
    """Quality of service of a publisher or subscriber with history KEEP_LAST ``depth``."""

    reliable: bool
    transient_local: bool
    depth: int = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Endpoint:
    """A publisher or subscriber of a topic, with the full name of its node.

    ``gid`` is unique to it, and what ``Receive`` gets of a publisher where the data path tells publishers
    apart. ``asks`` are further policies by which a subscriber asks for more than a publisher of ours offers.
    It ``is_local`` where its process is known to be one of this machine. It has no depth: that cannot be
    discovered of a remote one.
    """

    node: str
    type_name: str
    reliable: bool
    transient_local: bool
    gid: bytes = b""
    asks: tuple[str, ...] = ()
    is_local: bool = False


class DiscoveryRange(Enum):
    """How far a node looks for others."""

    LOCALHOST = "localhost"
    SUBNET = "subnet"


LAST_DOMAIN = 232
"""The last ROS domain whose ports exist."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputDomain:
    """The ROS domain of the operators, and how far it reaches; ``None``: as the environment sets it."""

    number: int
    discovery: DiscoveryRange | None = None


class Instant(NamedTuple):
    """A moment on two clocks: the node's, which may be set, and the steady one (``Robot.steady_ns``)."""

    clock_ns: int
    steady_ns: int


class Subscription(Protocol):
    """A subscription to a source."""

    @property
    def sent(self) -> int | None:
        """Messages that the source has sent since the first received, taken or not; ``None`` if unknown."""

    @property
    def dropped(self) -> int:
        """Messages that were lost on their way or in a full queue; not those skipped during a pause."""

    def close(self) -> None:
        """Receive nothing more."""


@runtime_checkable
class PausableSubscription(Subscription, Protocol):
    """A subscription that can pause: messages cause no wake-up then, and all but the newest are skipped."""

    def pause(self) -> None:
        """Wake for no message from now on."""

    def arm(self) -> None:
        """Receive the next message, then pause again; the newest that came in the pause is kept for now."""

    def take_pending(self) -> bool:
        """Receive what ``arm`` kept, since nothing newer came; whether there was anything."""

    def resume(self) -> None:
        """Receive every message again."""


class Publisher(Protocol):
    """A publisher of an output topic."""

    def publish(self, payload: Payload) -> None:
        """Send a serialized message. Raises ``RosError``."""

    def close(self) -> None: ...


class DataPathKind(Enum):
    """How messages come in and go out; ``AUTO`` is the first of the others that works.

    ``FAST`` is without Python where nothing needs the messages, ``RCL`` through Python and librcl.
    """

    AUTO = "auto"
    FAST = "fast"
    RCL = "librcl"
    RCLPY = "rclpy"


class DataPath(Protocol):
    """How serialized messages come in and go out. Callbacks run within ``Robot.wait``."""

    def knows(self, type_name: str) -> bool:
        """Whether the message type is installed."""

    @property
    def description(self) -> str:
        """Which path this is, and why or what it can do, for the log."""

    @property
    def identifies_publishers(self) -> bool:
        """Whether ``receive`` gets the publisher of each message: its GID, as ``bytes``."""

    @property
    def can_pause(self) -> bool:
        """Whether subscriptions can pause, and still count what their source sends."""

    @property
    def keeps_newest(self) -> bool:
        """Whether a message that waits to be sent is replaced by a newer one of its publisher."""

    @property
    def compiled(self) -> CompiledRelays | None:
        """Maker of relays that need no Python, if there is one."""

    def subscribe(
        self, topic: str, type_name: str, qos: Qos, receive: Receive, *, priority: float = 1.0
    ) -> Subscription:
        """Have ``receive`` called with each message. Raises ``RosError``.

        When messages pile up, those of the highest ``priority`` are served first.
        """

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Publish on ``topic``. Raises ``RosError``."""

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        """The message of a payload of ``topic``. Raises ``RosError``."""


class DiagnosticLevel(IntEnum):
    """The levels of diagnostic_msgs/msg/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceAnswer:
    """Answer of a service of std_srvs; one of Empty is always a success."""

    is_success: bool
    message: str


Called = Callable[["ServiceAnswer | TestudoError"], None]
"""Takes the answer of a service, or why there is none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnostic:
    """One diagnostic_msgs/msg/DiagnosticStatus: ``name`` is what it is about, ``values`` are for reading."""

    name: str
    level: DiagnosticLevel
    message: str
    hardware_id: str
    values: Mapping[str, str]


class RobotLog(Protocol):
    """The node's log."""

    def info(self, message: str) -> None: ...

    def warning(self, message: str) -> None: ...


class GraphChange(Enum):
    """Knowledge of changes of the graph since the last poll."""

    REPORTED = auto()
    """There was one."""
    UNREPORTED = auto()
    """Nothing: they are not reported."""
    NONE = auto()
    """None was reported."""


PollGraph = Callable[[GraphChange], None]
"""Takes what is known since the last poll."""


class Robot(Protocol):
    """A node among the robot's own.

    What it publishes goes to the operators, who may be in another domain, and so may be the subscribers.
    """

    @property
    def name(self) -> str:
        """The full name of the node."""

    @property
    def fed_nodes(self) -> frozenset[str]:
        """The nodes on the robot's own graph that publish what this one sends over a link."""

    @property
    def doubted_nodes(self) -> frozenset[str]:
        """Nodes of which it is not known yet whether they are ``players``."""

    def players(self, nodes: Collection[str]) -> frozenset[str]:
        """Players among ``nodes``, which publish statuses: theirs are those of a recording."""

    @property
    def log(self) -> RobotLog: ...

    @property
    def data_path(self) -> DataPath:
        """Messages in and out. May raise ``RosError``."""

    @property
    def has_output_domain(self) -> bool:
        """Whether the operators are in another domain than the robot."""

    @property
    def senders_remedy(self) -> str | None:
        """Environment variable for a process of this machine whose large messages are lost on the way.

        ``None`` where the middleware is not known to need any of that.
        """

    @property
    def is_time_simulated(self) -> bool:
        """Whether its clock shows simulated time."""

    def now_ns(self) -> int:
        """The node's clock, which is 0 while simulated time has not begun."""

    def resolve(self, topic: str) -> str:
        """The full name of ``topic`` in the node's namespace, remapped."""

    def resolve_output(self, topic: str) -> str:
        """The full name that a publisher of ``topic`` has where the operators are, remapped."""

    def publishers(self, topic: str) -> Sequence[Endpoint]:
        """Publishers of ``topic`` now, as far as discovered."""

    def publisher_count(self, topic: str) -> int:
        """How many publishers ``publishers`` would find, for a fraction of its cost."""

    def subscribers(self, topic: str) -> Sequence[Endpoint]:
        """Which operators subscribe to ``topic``, an output, now, as far as discovered."""

    def subscriber_count(self, topic: str) -> int:
        """How many subscribers ``subscribers`` would find, for a fraction of its cost."""

    def local_subscriber_count(self, topic: str) -> int:
        """How many on the graph subscribe to ``topic``, which the node publishes of itself: its status."""

    def own_subscribers(self, topic: str) -> Sequence[Endpoint]:
        """Which of the robot's own nodes subscribe to ``topic`` now, as far as discovered."""

    def own_publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Publisher of ``topic`` among the robot's own nodes, for any thread. Raises ``RosError``."""

    def topics(self) -> Mapping[str, Sequence[str]]:
        """The types of each topic that somebody publishes or subscribes to, by its full name."""

    def begins_with_header(self, type_name: str) -> bool:
        """Whether messages of that type begin with a std_msgs/Header; not where it is not installed."""

    def definition(self, type_name: str) -> str:
        """The definition of a message type with those of its parts, as bags store it; empty where unknown."""

    def type_definition(self, type_name: str) -> TypeDefinition | None:
        """The fields and constants of a message type; ``None`` where it is not installed."""

    def diagnostics_publisher(self, topic: str) -> Callable[[Sequence[Diagnostic]], None]:
        """Sender of a diagnostic_msgs/msg/DiagnosticArray on ``topic``; both may raise ``RosError``."""

    def text_publisher(self, topic: str, qos: Qos, *, goes_over_link: bool = True) -> Callable[[str], None]:
        """Sender of a std_msgs/msg/String on ``topic``; both may raise ``RosError``.

        It also goes over a link, if there is one, unless not ``goes_over_link``.
        """

    def steady_ns(self) -> int:
        """Time that passes, from an unknown start; on Linux also while the machine sleeps."""

    def declare(self, parameters: Sequence[Parameter], accept: Accept) -> Mapping[str, ParameterValue]:
        """Have these parameters, to be called once; their values. Raises ``UsageError`` for a wrong one.

        ``accept`` is asked before any that are open to change take another value.
        """

    def show(self, name: str, value: ParameterValue) -> None:
        """Give a parameter another value without asking ``accept``."""

    def parameters(self, names: Sequence[str]) -> Values:
        """The values of declared parameters; ``None`` for others."""

    def set_parameters(self, values: Values) -> Refusals:
        """Set declared parameters as somebody on the graph may, each by itself; why some were refused."""

    def offer_trigger(self, name: str, act: Callable[[], str]) -> None:
        """Offer a std_srvs/srv/Trigger service. Raises ``RosError``.

        It succeeds with the message that ``act`` returns, and fails with its ``TestudoError``.
        """

    @property
    def remote_parameters(self) -> RemoteParameters: ...

    def call_service(self, service: str, *, argument: bool | None, called: Called) -> None:
        """Call a std_srvs service: Trigger or Empty, or SetBool with ``argument``.

        ``called`` gets the answer or why there is none, once, within ``wait``; nothing else waits for it.
        """

    def every(self, period_s: float, act: Callable[[], float | None]) -> None:
        """Have ``act`` called again and again, in real time.

        The next time is after as many seconds as it returns, or after ``period_s`` where that is ``None``.
        """

    def poll_graph(self, poll: PollGraph) -> None:
        """Have ``poll`` called now, and soon after publishers or subscribers came or went; to be asked once.

        That is five times a second at most. It is called once a second at least, changed or not, and as often
        as it may be where changes are not reported.
        """

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        """Handle what comes next; return after it, at ``wake_ns`` or after ``longest_s`` in real time."""


_OF_ROS = frozenset({"/rosout", "/parameter_events"})
UNKNOWN_NODE = "/_NODE_NAME_UNKNOWN_"
"""How the name ends that an endpoint has until its node is discovered, too."""


def receiving_node(receiver: int) -> str:
    """The name of the node that publishes what the operator's end of that number receives."""
    return f"testudo_receive_{receiver}"


_RECEIVING_NODE = re.compile(r"/testudo_receive_\d+", re.ASCII)


def relaying_nodes(robot: Robot, warn: Callable[[str], None] | None = None) -> frozenset[str]:
    """The nodes that relay, this one among them: they publish their status, or what this one sends.

    A player of a recording publishes the statuses of others, and relays nothing. ``warn`` is called where
    another node has the name of this one.
    """
    relaying = [endpoint.node for endpoint in robot.publishers(STATUS_TOPIC)]
    known = {robot.name, *robot.fed_nodes, *filter(_RECEIVING_NODE.fullmatch, relaying)}
    players = robot.players(set(relaying) - known)
    if warn is not None and relaying.count(robot.name) > 1:
        warn(
            f"another {robot.name} relays on this ROS graph, or was killed a moment ago: "
            "end one of them, as what both relay arrives twice; or, for two robots, give each a name, as "
            f"with {NAME_OPTION}: rules can be pushed to neither so"
        )
    return frozenset({*relaying, *known} - players)


def visible_topics(robot: Robot) -> dict[str, list[Endpoint]]:
    """The publishers of each topic, without hidden topics, those of ROS and those of SmartTestudo nodes."""
    testudos = relaying_nodes(robot)
    names = [name for name in robot.topics() if is_visible(name)]
    published = {
        name: [endpoint for endpoint in robot.publishers(name) if endpoint.node not in testudos]
        for name in sorted(names)
    }
    return {name: endpoints for name, endpoints in published.items() if endpoints}


def topic_types(robot: Robot) -> dict[str, str]:
    """The types of the visible topics."""
    return {topic: publishers[0].type_name for topic, publishers in visible_topics(robot).items()}


def is_visible(name: str) -> bool:
    """Whether a topic is neither ROS's own nor hidden; a part of a hidden name begins with an underscore."""
    return name not in _OF_ROS and "/_" not in name

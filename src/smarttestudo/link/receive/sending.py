# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of nodes at the operator's end, sent to the robots that accept them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.link import (
    MAX_COMMAND_BYTES,
    CommandTopic,
    ReceivedMessage,
    SentCounts,
    StreamInfo,
    TooOld,
)
from smarttestudo.domain.names import output_name
from smarttestudo.domain.robot import Payload, Qos, Robot, Subscription
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.commands import CommandedRobot
from smarttestudo.link.protocol.keys import Boot

if TYPE_CHECKING:
    # It needs Zenoh, which tests of this do without.
    from smarttestudo.link.zenoh.commands import CommandOutbox

QOS = Qos(reliable=False, transient_local=False, depth=10)
"""Nothing latched, and nothing that is sent again after a loss: both may be old."""
STALL_NS = 200 * NS_PER_MS
"""After so long without a poll, this process stood still, and messages waited."""
SETTLE_NS = NS_PER_S // 2
SAY_AFTER_NS = 5 * NS_PER_S
"""For how long something must be so that it is said: an end may just start, or its old run just end."""
_WAIT_S = 0.05
_POLL_NS = NS_PER_S // 2
_MANY_ROBOTS = "tell them apart with --output-topic '/{robot}{topic}'"
_ONE_NAME = "give each a name of its own with --robot of 'testudo run'"


class StallGuard:
    """Tells whether a message that is taken now may have waited because this process stood still.

    ``polled`` is to be called many times a second. How long a message waited in the middleware is not
    known, so all that is taken for ``SETTLE_NS`` after a pause is suspect.
    """

    def __init__(self, now_ns: int) -> None:
        self._polled_ns = now_ns
        self._calm_ns = now_ns

    def polled(self, now_ns: int) -> bool:
        """Whether all is well at ``now_ns``."""
        if now_ns - self._polled_ns > STALL_NS:
            self._calm_ns = now_ns + SETTLE_NS
        self._polled_ns = now_ns
        return now_ns >= self._calm_ns


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandRoute:
    """A topic here and the one of a robot that it goes to; ``problem`` says why nothing does.

    ``suspect`` messages were dropped because this process stood still before they were heard. ``is_quiet``
    problems are none that somebody need mend.
    """

    source: str
    boot: Boot
    accepted: CommandTopic
    counts: SentCounts
    round_trip_ms: float | None
    suspect: int = 0
    problem: str | None = None
    is_quiet: bool = False


@dataclass(slots=True, eq=False)
class _Source:
    """A topic that is subscribed to here."""

    type_name: str
    subscription: Subscription


class Sending:
    """Subscribes to what is sent, as a node of its own, and gives it to the robots that accept it.

    As a ``Sink`` it hears what robots send here, which must not go back to them. ``own_nodes`` tells the
    nodes of SmartTestudo. ``clock`` gives ns that pass while the machine is suspended, too. All but the
    methods of a ``Sink`` and ``routes`` are for one thread.
    """

    def __init__(
        self,
        robot: Robot,
        commands: CommandOutbox,
        warn: Callable[[str], None],
        *,
        pattern: str,
        own_nodes: Callable[[], Collection[str]],
        clock: Callable[[], int],
    ) -> None:
        self.routes: Sequence[CommandRoute] = ()
        """Where everything goes, as of the last poll."""
        self._robot = robot
        self._commands = commands
        self._warn = warn
        self._pattern = pattern
        self._own_nodes = own_nodes
        self._clock = clock
        self._guard = StallGuard(clock())
        self._suspect: Counter[str] = Counter()
        self._relayed: dict[tuple[str, str, int], str] = {}
        self._robots: set[str] = set()
        self._accepting: set[str] = set()
        self._sources: dict[str, _Source] = {}
        self._open_routes: dict[str, CommandRoute] = {}
        self._too_old: dict[Boot, TooOld] = {}
        self._since_ns: dict[str, int] = {}
        self._said: set[str] = set()
        self._polled_ns = clock() - _POLL_NS

    def open(self, robot: str, stream: StreamInfo) -> None:
        """A robot has this stream: its name here is not sent."""
        self._robots.add(robot)
        try:
            name = output_name(stream.topic, self._pattern, robot)
            self._relayed[robot, stream.topic, stream.publisher] = name
        except TestudoError:
            # It is not published here either, which is said there.
            return

    def write(self, message: ReceivedMessage) -> None:
        """Do nothing: what arrives is not sent."""

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """The name is nobody's: it may be sent."""
        self._relayed.pop((robot, stream.topic, stream.publisher), None)

    def close(self) -> None:
        for name in list(self._sources):
            self._close(name)

    def step(self) -> float:
        """Wait for messages for a moment, and send; in how many seconds to go on. Raises ``TestudoError``."""
        self._robot.wait(None, _WAIT_S)
        now_ns = self._clock()
        self._guard.polled(now_ns)
        self._commands.pump()
        if now_ns - self._polled_ns >= _POLL_NS:
            self._polled_ns = now_ns
            self.poll(now_ns)
        return 0.0

    def poll(self, now_ns: int) -> None:
        robots = self._commands.robots()
        targets: dict[str, list[tuple[CommandedRobot, CommandTopic]]] = {}
        for robot in robots:
            for topic in robot.topics.values():
                if topic.topic in self._commands.names and (name := self._name(robot, topic)):
                    targets.setdefault(name, []).append((robot, topic))
        own_nodes = set(self._own_nodes()) if targets else set()
        routes = [route for name, found in targets.items() for route in self._routes(name, found, own_nodes)]
        self._open_routes = {route.source: route for route in routes if route.problem is None}
        self.routes = tuple(routes)
        for name in self._sources.keys() - self._open_routes.keys():
            self._close(name)
        self._say_problems(robots, now_ns)

    def _name(self, robot: CommandedRobot, topic: CommandTopic) -> str | None:
        try:
            return output_name(topic.topic, self._pattern, robot.boot.robot)
        except TestudoError as error:
            self._say(str(error))
            return None

    def _routes(
        self, name: str, targets: list[tuple[CommandedRobot, CommandTopic]], own_nodes: set[str]
    ) -> list[CommandRoute]:
        routes = [
            CommandRoute(
                source=name,
                boot=robot.boot,
                accepted=topic,
                counts=robot.counts[topic.topic],
                round_trip_ms=robot.round_trip_ms,
                suspect=self._suspect[name],
            )
            for robot, topic in targets
        ]
        if len(routes) > 1:
            has_twins = len({route.boot.robot for route in routes}) < len(routes)
            remedy = _ONE_NAME if has_twins else _MANY_ROBOTS
            problem = f"{len(routes)} robots accept it, and nothing tells which is meant: {remedy}"
            return [replace(route, problem=problem) for route in routes]
        return [self._checked(routes[0], own_nodes)]

    def _checked(self, route: CommandRoute, own_nodes: set[str]) -> CommandRoute:
        """``route`` with its source open, or why it is not."""
        accepted, robot = route.accepted, route.boot.robot
        # Another thread opens and forgets streams.
        if route.source in list(self._relayed.values()):
            return replace(route, problem="it comes from a robot under that name, so it would go round")
        if accepted.problem is not None:
            return replace(route, problem=f"at {robot}, {accepted.problem}")
        if accepted.type_name is None:
            return replace(route, problem=f"no node of {robot} subscribes to it", is_quiet=True)
        try:
            publishers = self._robot.publishers(route.source)
            types = sorted({publisher.type_name for publisher in publishers})
            if not own_nodes.isdisjoint(publisher.node for publisher in publishers):
                return replace(route, problem="SmartTestudo itself publishes it here, so it would go round")
            if not types:
                return replace(route, problem="nobody publishes it here", is_quiet=True)
            if types != [accepted.type_name]:
                problem = f"it is {' and '.join(types)} here and {accepted.type_name} at {robot}"
                return replace(route, problem=problem)
            self._subscribe(route.source, accepted.type_name)
        except TestudoError as error:
            return replace(route, problem=str(error))
        return route

    def _subscribe(self, name: str, type_name: str) -> None:
        source = self._sources.get(name)
        if source is not None and source.type_name == type_name:
            return
        if source is not None:
            self._close(name)

        def receive(payload: Payload, publisher: Hashable) -> None:
            self._receive(name, payload, publisher)

        subscription = self._robot.data_path.subscribe(name, type_name, QOS, receive)
        self._sources[name] = _Source(type_name, subscription)

    def _close(self, name: str) -> None:
        try:
            self._sources.pop(name).subscription.close()
        except TestudoError as error:
            self._say(str(error))

    def _receive(self, name: str, payload: Payload, publisher: Hashable) -> None:
        if not self._guard.polled(self._clock()):
            self._suspect[name] += 1
            return
        route = self._open_routes.get(name)
        if route is not None and not self._commands.send(
            route.boot, route.accepted.topic, publisher, payload[:]
        ):
            self._say(
                f"{name}: a message of {len(payload)} bytes is too large to be sent; "
                f"the largest has {MAX_COMMAND_BYTES}"
            )

    def _say_problems(self, robots: Sequence[CommandedRobot], now_ns: int) -> None:
        lasting = {
            f"{route.source} is not sent to {route.boot.robot}: {route.problem}"
            for route in self.routes
            if route.problem is not None and not route.is_quiet
        }
        accepting = {robot.boot.robot for robot in robots}
        self._too_old = {robot.boot: self._too_old.get(robot.boot, TooOld()) for robot in robots}
        for robot in robots:
            name, accepted = robot.boot.robot, robot.topics.keys()
            for topic in accepted and set(self._commands.names) - accepted:
                lasting.add(f"{name} does not accept {topic}: name it there in 'testudo run --accept'")
            for topic in accepted - set(self._commands.names):
                lasting.add(f"{name} accepts {topic}, which is not sent: name it in 'testudo receive --send'")
            for sentence in self._too_old[robot.boot].new_sentences(list(robot.topics.values())):
                trip_ms = robot.round_trip_ms
                trip = "" if trip_ms is None else f"; the round trip takes {trip_ms:.0f} ms"
                self._say(f"What is sent to {name} on {sentence}{trip}", again=True)
        self._accepting |= accepting
        for name in self._robots - self._accepting:
            lasting.add(
                f"{name} accepts nothing: name {' '.join(self._commands.names)} there in "
                "'testudo run --accept'"
            )
        self._since_ns = {line: self._since_ns.get(line, now_ns) for line in lasting}
        for line, since_ns in sorted(self._since_ns.items()):
            if now_ns - since_ns >= SAY_AFTER_NS:
                self._say(line)

    def _say(self, line: str, *, again: bool = False) -> None:
        if again or line not in self._said:
            self._said.add(line)
            self._warn(line)

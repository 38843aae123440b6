# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Between the robot's own nodes and what operators send to them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.link import IncomingCommands, OutgoingLink, TooOld
from smarttestudo.domain.names import OWN_TOPICS
from smarttestudo.domain.robot import Publisher, Qos, Robot
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.texts import SayOnce
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.part import Part

QOS = Qos(reliable=True, transient_local=False, depth=1)
"""It serves subscribers of any reliability; who comes late gets nothing old, and who is slow the newest."""
SAY_AFTER_NS = 5 * NS_PER_S
"""For how long nobody may send before that is said: the other end may just start."""


@dataclass(slots=True)
class _Served:
    """State of a topic at the last poll, and its publisher where all is well."""

    type_name: str | None = None
    problem: str | None = None
    publisher: Publisher | None = None


class CommandSubscribers(Part):
    """Publishes accepted topics among the robot's own nodes, with the type that they subscribe with."""

    def __init__(self, robot: Robot, commands: IncomingCommands, link: OutgoingLink | None = None) -> None:
        self._robot = robot
        self._link = link
        self._relayed: frozenset[str] = frozenset()
        self._commands = commands
        self._served = {topic.topic: _Served() for topic in commands.topics}
        self._too_old = TooOld()
        self._say = SayOnce(robot.log.warning)
        self._without_ns: dict[str, int] = {}

    def follow(self, rules: LiveRules, now_ns: int) -> None:  # noqa: ARG002 - a part's
        self._relayed = frozenset(rules.output_topics.values())

    def on_graph(self) -> None:
        is_connected = self._link is not None and self._link.state.is_connected
        self.poll_graph(self._relayed, is_connected=is_connected)

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        return replace(status, accepted=tuple(self._commands.topics))

    def poll_graph(self, relayed: Collection[str], *, is_connected: bool) -> None:
        """Follow the graph; ``relayed`` are the names of what goes to operators."""
        for topic, served in self._served.items():
            type_name, problem = self._found(topic, relayed)
            if (type_name, problem) != (served.type_name, served.problem):
                self._serve(topic, served, type_name, problem)
        for sentence in self._too_old.new_sentences(self._commands.topics):
            self._robot.log.warning(f"What an operator sends on {sentence}")
        self._poll_operators(is_connected=is_connected)

    def close(self) -> None:
        # What operators send is published by another thread, which must not outlive the node.
        for topic, served in self._served.items():
            self._serve(topic, served, None, None)

    def _found(self, topic: str, relayed: Collection[str]) -> tuple[str | None, str | None]:
        """The type of ``topic``, or why nothing of it is delivered; neither where nobody subscribes to it."""
        if topic in relayed or topic in OWN_TOPICS:
            return None, "it is relayed to operators under the same name, so it would come back"
        try:
            found = self._robot.own_subscribers(topic)
        except RosError as error:
            return None, str(error)
        types = sorted({endpoint.type_name for endpoint in found if endpoint.node != self._robot.name})
        if len(types) > 1:
            return None, f"nodes subscribe to it as {' and as '.join(types)}"
        if types and not self._robot.data_path.knows(types[0]):
            return None, f"its type {types[0]} is not installed where 'testudo run' runs"
        return (types[0] if types else None), None

    def _serve(self, topic: str, served: _Served, type_name: str | None, problem: str | None) -> None:
        before = served.publisher
        served.type_name, served.problem, served.publisher = type_name, problem, None
        if type_name is not None:
            try:
                served.publisher = self._robot.own_publisher(topic, type_name, QOS)
            except RosError as error:
                problem = str(error)
        is_served = served.publisher is not None
        self._commands.follow(topic, type_name if is_served else None, served.publisher, problem)
        try:
            if before is not None:
                before.close()
        except RosError as error:
            self._robot.log.warning(str(error))
        if problem is not None:
            self._say(f"{topic} is not accepted from operators: {problem}")

    def _poll_operators(self, *, is_connected: bool) -> None:
        """Say what is named at one end only."""
        sent = self._commands.sent_names()
        named = {topic for names in sent for topic in names}
        for topic in self._served:
            if not is_connected or topic in named or (self._commands.has_operator and not sent):
                self._without_ns.pop(topic, None)
                continue
            since_ns = self._without_ns.setdefault(topic, self._robot.steady_ns())
            if self._robot.steady_ns() - since_ns >= SAY_AFTER_NS:
                self._say(
                    f"{topic} is accepted, but no operator sends it: name it in 'testudo receive --send'"
                )
        for topic in sorted(named - self._served.keys()):
            self._say(f"An operator sends {topic}, which is not accepted: name it in 'testudo run --accept'")

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a robot while it runs: watched on the graph, opened, and opened anew where they changed."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass

from smarttestudo.composition.live_source import LiveSource, live_source, suits
from smarttestudo.composition.topic_link import TopicLink, topic_link
from smarttestudo.composition.visible_topics import testudo_nodes
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.observation import SourceChanged, Undecodable
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Inlet, Outlet, Robot
from smarttestudo.runtime.execute.relay import Relayed

Received = Callable[[str, Payload, Hashable], None]
"""Takes a message: its topic, its payload, and its publisher where that is known."""


@dataclass(slots=True, kw_only=True)
class _Open:
    """What is open for one topic."""

    source: LiveSource
    inlet: Inlet
    outlet: Outlet | None

    def close(self) -> None:
        self.inlet.close()
        if self.outlet is not None:
            self.outlet.close()


class LiveTopics:
    """Subscriptions to all sources of a rule set and publishers of their monitored topics.

    ``monitored`` names the monitored topic of each relayed source; ``watched`` are those that checks read.
    What goes wrong with one topic is said once and costs that topic only.
    """

    def __init__(
        self, robot: Robot, monitored: Mapping[str, str], watched: Iterable[str], receive: Received
    ) -> None:
        self._robot = robot
        self._receive = receive
        self._monitored: Mapping[str, str] = {}
        self._topics: tuple[str, ...] = ()
        self._sources: dict[str, LiveSource] = {}
        self._open: dict[str, _Open] = {}
        self._problems: dict[str, str] = {}
        self._said: set[str] = set()
        self.follow(monitored, watched)

    def follow(self, monitored: Mapping[str, str], watched: Iterable[str]) -> None:
        """Serve these topics from now on; what is open for others is closed, or for another output."""
        before, self._monitored = self._monitored, monitored
        self._topics = tuple(dict.fromkeys([*monitored, *watched]))
        for topic in list(self._sources):
            if topic not in self._topics or monitored.get(topic) != before.get(topic):
                del self._sources[topic]
                self._problems.pop(topic, None)
                if topic in self._open:
                    self._open.pop(topic).close()

    def look(self) -> list[SourceChanged]:
        """Follow the graph: what changed since the last look."""
        testudos = testudo_nodes(self._robot)
        changes = (self._look_at(topic, testudos) for topic in self._topics)
        return [change for change in changes if change is not None]

    def decoded(self, topic: str, payload: Payload) -> object:
        """The message of a payload that just came, or ``Undecodable``."""
        try:
            return self._robot.data_path.decode(topic, self._sources[topic].type_name, payload)
        except RosError:
            self._warn_once(f"{topic}: a message could not be decoded; what checks read is unknown then")
            return Undecodable()

    def publish(self, relayed: Relayed) -> None:
        """Send a message on its monitored topic."""
        opened = self._open.get(relayed.topic)
        if opened is None or opened.outlet is None:
            return
        try:
            opened.outlet.publish(relayed.payload)
        except RosError as error:
            self._warn_once(str(error))

    def links(self) -> dict[str, TopicLink]:
        """What each relayed topic is connected to."""
        return {
            topic: topic_link(self._robot, output, self._sources.get(topic), self._problems.get(topic))
            for topic, output in self._monitored.items()
        }

    def _look_at(self, topic: str, testudos: frozenset[str]) -> SourceChanged | None:
        endpoints = self._robot.publishers(topic)
        own = [endpoint for endpoint in endpoints if endpoint.node not in testudos]
        if endpoints and not own:
            self._warn_once(f"{topic}: published by SmartTestudo only, so it is not relayed")
        before = self._sources.get(topic)
        source = live_source(own, before)
        if source is None or source == before:
            return None
        self._sources[topic] = source
        self._report(topic, source, before)
        self._reopen(topic, source)
        return SourceChanged(
            topic=topic,
            publishers=source.publishers,
            transient_local=source.qos.transient_local,
            type_name=source.type_name,
        )

    def _reopen(self, topic: str, source: LiveSource) -> None:
        opened = self._open.get(topic)
        if opened is not None and suits(opened.source, source):
            return
        if opened is not None:
            self._open.pop(topic).close()
        try:
            self._open[topic] = self._opened(topic, source)
            self._problems.pop(topic, None)
        except RosError as error:
            self._problems[topic] = error.cause
            self._warn_once(str(error))

    def _opened(self, topic: str, source: LiveSource) -> _Open:
        path, output = self._robot.data_path, self._monitored.get(topic)
        outlet = None if output is None else path.advertise(output, source.type_name, source.qos)
        try:
            inlet = path.subscribe(
                topic,
                source.type_name,
                source.qos,
                lambda payload, publisher: self._receive(topic, payload, publisher),
            )
        except RosError:
            if outlet is not None:
                outlet.close()
            raise
        return _Open(source=source, inlet=inlet, outlet=outlet)

    def _report(self, topic: str, source: LiveSource, before: LiveSource | None) -> None:
        log = self._robot.log
        if source.publishers == 0:
            log.info(f"{topic}: no publisher left")
        elif before is None or before.publishers == 0 or not suits(before, source):
            delivery = "reliable" if source.qos.reliable else "best effort"
            latched = ", transient local" if source.qos.transient_local else ""
            log.info(f"{topic}: {source.type_name}, {delivery}{latched}")
        if source.publishers > 1:
            self._warn_once(f"{topic}: its {source.publishers} publishers share one rate")
        for other in source.other_types:
            self._warn_once(f"{topic}: also published as {other}; only {source.type_name} is relayed")

    def _warn_once(self, message: str) -> None:
        if message not in self._said:
            self._said.add(message)
            self._robot.log.warning(message)

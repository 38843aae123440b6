# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a robot while it runs: watched on the graph, opened, and opened anew where they changed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from functools import partial

from smarttestudo.composition.live_source import LiveSource, live_source, not_offered, suits
from smarttestudo.composition.live_topic import LiveTopic
from smarttestudo.composition.roster import Roster
from smarttestudo.composition.topic_link import TopicLink, topic_link
from smarttestudo.composition.visible_topics import testudo_nodes
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.observation import SourceChanged, Undecodable
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Endpoint, Inlet, Robot
from smarttestudo.runtime.execute.relay import Relayed

Received = Callable[[str, Payload, Hashable], None]
"""Takes a message: its topic, its payload, and its publisher where that is known."""


class LiveTopics:
    """Subscriptions to the sources of a rule set and publishers of their monitored topics.

    Unless ``is_lazy`` is false, a source that no check reads is subscribed to only while its monitored topic,
    or that of a topic paced with it, has a subscriber. When messages pile up, the topics of the highest
    ``priority_of`` are served first. What goes wrong with one topic is said once and costs that topic only.
    """

    def __init__(
        self,
        robot: Robot,
        receive: Received,
        priority_of: Callable[[str], float],
        *,
        is_lazy: bool = True,
    ) -> None:
        self._robot = robot
        self._priority_of = priority_of
        self._data_path = robot.data_path
        self._receive = receive
        self._is_lazy = is_lazy
        self._topics: dict[str, LiveTopic] = {}
        self._watched: frozenset[str] = frozenset()
        self._leaders: Mapping[str, str] = {}
        self._publishers = Roster(robot.publisher_count, robot.publishers)
        self._subscribers = Roster(robot.subscriber_count, robot.subscribers)
        self._testudos: frozenset[str] = frozenset()
        self._said: set[str] = set()

    def follow(
        self, monitored: Mapping[str, str], watched: Collection[str], leaders: Mapping[str, str]
    ) -> None:
        """Serve these topics from now on; what is open for others is closed, or for another output.

        ``monitored`` names the monitored topic of each relayed source; ``watched`` are the sources that are
        read by checks; ``leaders`` says with which topic others are paced.
        """
        before, self._topics = self._topics, {}
        self._watched, self._leaders = frozenset(watched), leaders
        for topic in dict.fromkeys([*monitored, *watched]):
            live, output = before.get(topic), monitored.get(topic)
            if live is None or live.output != output:
                live = self._new(topic, output)
            self._topics[topic] = live
        for topic, live in before.items():
            if self._topics.get(topic) is not live:
                live.close()

    def look(self) -> list[SourceChanged]:
        """Follow the graph: what changed since the last look."""
        self._look_at_operators()
        testudos = testudo_nodes(self._robot)
        moved = self._publishers.look(self._topics)
        unseen = [topic for topic, live in self._topics.items() if live.source is None]
        if testudos != self._testudos:
            moved, self._testudos = list(self._topics), testudos
        changes = [self._look_at(self._topics[topic]) for topic in dict.fromkeys([*moved, *unseen])]
        return [change for change in changes if change is not None]

    def inlets(self) -> dict[str, Inlet]:
        """All subscriptions that are open."""
        return {topic: live.inlet for topic, live in self._topics.items() if live.inlet is not None}

    def inlets_of_one(self) -> dict[str, Inlet]:
        """The subscriptions to topics that have one publisher, or none any more."""
        return {
            topic: inlet for topic, inlet in self.inlets().items() if len(self._publishers.of(topic)) <= 1
        }

    def decoded(self, topic: str, payload: Payload) -> object:
        """The message of a payload that just came, or ``Undecodable``."""
        source = self._topics[topic].source
        assert source is not None
        try:
            return self._data_path.decode(topic, source.type_name, payload)
        except RosError:
            self._warn_once(f"{topic}: a message could not be decoded; what checks read is unknown then")
            return Undecodable()

    def publish(self, relayed: Relayed) -> None:
        """Send a message on its monitored topic."""
        live = self._topics.get(relayed.topic)
        if live is None:
            return
        try:
            live.publish(relayed.payload, relayed.publisher)
        except RosError as error:
            self._warn_once(str(error))

    def links(self) -> dict[str, TopicLink]:
        """What each relayed topic is connected to."""
        return {
            topic: topic_link(
                self._robot, live.output, live.source, self._subscribers.of(live.output), live.problem
            )
            for topic, live in self._topics.items()
            if live.output is not None
        }

    def _new(self, topic: str, output: str | None) -> LiveTopic:
        priority = self._priority_of(topic)
        return LiveTopic(topic, output, self._data_path, partial(self._receive, topic), priority)

    def _look_at_operators(self) -> None:
        outputs = {live.output: live for live in self._topics.values() if live.output is not None}
        for output in self._subscribers.look(outputs):
            self._name_unserved(outputs[output])
        wanted = self._wanted(live.topic for output, live in outputs.items() if self._subscribers.of(output))
        for topic, live in self._topics.items():
            self._want(live, is_wanted=topic in wanted)

    def _wanted(self, heard: Iterable[str]) -> Collection[str]:
        if not self._is_lazy:
            return self._topics
        listened = set(heard)
        return self._watched | listened | {self._leaders.get(topic, topic) for topic in listened}

    def _want(self, live: LiveTopic, *, is_wanted: bool) -> None:
        try:
            has_changed = live.want(is_wanted=is_wanted)
        except RosError as error:
            self._warn_once(str(error))
            return
        if has_changed:
            what = (
                "subscribed, as an operator listens"
                if is_wanted
                else "not subscribed, as no operator listens"
            )
            self._robot.log.info(f"{live.topic}: {what}")

    def _look_at(self, live: LiveTopic) -> SourceChanged | None:
        endpoints = self._publishers.of(live.topic)
        own = [endpoint for endpoint in endpoints if endpoint.node not in self._testudos]
        live.unheard = frozenset(endpoint.gid for endpoint in endpoints) - {endpoint.gid for endpoint in own}
        self._report_others(live.topic, endpoints, own)
        before = live.source
        source = live_source(own, before)
        if source is None:
            return None
        if source != before:
            self._report(live, source)
        try:
            live.follow(source)
        except RosError as error:
            self._warn_once(str(error))
        self._name_unserved(live)
        return None if source == before else _changed(live.topic, source)

    def _report_others(self, topic: str, endpoints: Sequence[Endpoint], own: Sequence[Endpoint]) -> None:
        if endpoints and not own:
            self._warn_once(f"{topic}: published by SmartTestudo only, so it is not relayed")
        elif len(endpoints) > len(own) and self._data_path.tells_publishers:
            self._warn_once(f"{topic}: also published by a SmartTestudo, whose messages are not relayed")
        elif len(endpoints) > len(own):
            self._warn_once(f"{topic}: also published by a SmartTestudo, whose messages cannot be told apart")
        if len(own) > 1 and not self._data_path.tells_publishers:
            self._warn_once(f"{topic}: its {len(own)} publishers cannot be told apart and share one rate")

    def _report(self, live: LiveTopic, source: LiveSource) -> None:
        log, topic, before = self._robot.log, live.topic, live.source
        if source.publishers == 0:
            log.info(f"{topic}: no publisher left")
        elif before is None or before.publishers == 0 or not suits(before, source):
            delivery = "reliable" if source.qos.reliable else "best effort"
            latched = ", transient local" if source.qos.transient_local else ""
            unheard = "" if live.is_wanted else "; not subscribed, as no operator listens"
            log.info(f"{topic}: {source.type_name}, {delivery}{latched}{unheard}")
        for other in source.other_types:
            self._warn_once(f"{topic}: also published as {other}; only {source.type_name} is relayed")

    def _name_unserved(self, live: LiveTopic) -> None:
        if live.source is None or live.output is None:
            return
        for subscriber in self._subscribers.of(live.output):
            asked = " and ".join(not_offered(live.source.qos, subscriber))
            if asked:
                self._warn_once(
                    f"{live.output}: {subscriber.node} asks for {asked}, which {live.topic} does not offer; "
                    "it receives nothing"
                )

    def _warn_once(self, message: str) -> None:
        if message not in self._said:
            self._said.add(message)
            self._robot.log.warning(message)


def _changed(topic: str, source: LiveSource) -> SourceChanged:
    return SourceChanged(
        topic=topic,
        publishers=source.publishers,
        transient_local=source.qos.transient_local,
        type_name=source.type_name,
    )

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The subscriptions and publishers of all topics of a live run, following the ROS graph."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from functools import partial

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.observation import ListenersChanged, SourceChanged, Undecodable
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Endpoint, GraphChange, Publisher, Robot, Subscription
from smarttestudo.domain.visible_topics import relaying_nodes
from smarttestudo.loop.relay import Relayed
from smarttestudo.robot.topic import LiveSource, OpenTopic, live_source, suits
from smarttestudo.robot.topic_link import TopicLink, not_offered, topic_link

LOOKS_PER_ROUND = 5


class EndpointCache:
    """A cache of the endpoints of topics, of which ``count`` gives the number, and ``find`` all.

    ``find`` costs several times as much. Where changes of the graph are told, it is called for all topics
    after one. Where they are not, each look counts, and finds anew where the number changed and for a fifth
    of the others in turn, so that one that was replaced by another is noticed too. Where none was told, a
    look does that for a fifth of the topics: what was not told all the same is found then.
    """

    def __init__(self, count: Callable[[str], int], find: Callable[[str], Sequence[Endpoint]]) -> None:
        self._count = count
        self._find = find
        self._found: dict[str, Sequence[Endpoint]] = {}
        self._looks = 0

    def look(self, topics: Iterable[str], graph: GraphChange) -> list[str]:
        """Topics among ``topics`` whose endpoints are not what they were at the last look."""
        counted = LOOKS_PER_ROUND if graph is GraphChange.NONE else 1
        found = 1 if graph is GraphChange.TOLD else counted * LOOKS_PER_ROUND
        looks = self._looks
        self._looks += 1
        return [
            topic
            for place, topic in enumerate(topics)
            if (place - looks) % counted == 0 or topic not in self._found
            if self._is_new(topic, is_to_be_found=(place - looks) % found == 0)
        ]

    def of(self, topic: str) -> Sequence[Endpoint]:
        """The endpoints of ``topic`` as of the last look."""
        return self._found.get(topic, ())

    def _is_new(self, topic: str, *, is_to_be_found: bool) -> bool:
        known = self._found.get(topic)
        if known is not None and not is_to_be_found and self._count(topic) == len(known):
            return False
        self._found[topic] = found = self._find(topic)
        return found != known


Received = Callable[[str, Payload, Hashable], None]
"""Takes a message: its topic, its payload, and its publisher where that is known."""


class LiveTopics:
    """Subscriptions to the sources of a rule set and publishers of their output topics.

    Unless ``is_lazy`` is false, a source that no check reads is subscribed to only while its output topic, or
    that of a topic paced with it, has a subscriber. When messages pile up, the topics of the highest
    ``priority_of`` are served first. An error of one topic is logged once and affects that topic only.
    ``recorded`` are those that are recorded, relayed or not.
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
        self._topics: dict[str, OpenTopic] = {}
        self._watched: frozenset[str] = frozenset()
        self.recorded: frozenset[str] = frozenset()
        self._leaders: Mapping[str, str] = {}
        self._publishers = EndpointCache(robot.publisher_count, robot.publishers)
        self._subscribers = EndpointCache(robot.subscriber_count, robot.subscribers)
        self._heard: dict[str, frozenset[bytes]] = {}
        self._testudos: frozenset[str] = frozenset()
        self._said: set[str] = set()

    def follow(
        self,
        output_topics: Mapping[str, str],
        watched: Collection[str],
        leaders: Mapping[str, str],
        *,
        recorded: Collection[str] = (),
    ) -> None:
        """Serve these topics from now on; what is open for others is closed, or for another output.

        ``output_topics`` names the output topic of each relayed source; ``watched`` are the sources that are
        read by checks; ``leaders`` says with which topic others are paced. ``recorded`` are received whole,
        and so is what is latched, if there are any.
        """
        before, self._topics = self._topics, {}
        given = self._watched | {topic for topic, live in before.items() if live.output is not None}
        self._watched, self._leaders = frozenset(watched), leaders
        self.recorded = frozenset(recorded)
        for topic in dict.fromkeys([*output_topics, *watched, *sorted(recorded)]):
            live, output = before.get(topic), output_topics.get(topic)
            is_recorded = topic in self.recorded
            if live is None:
                live = self._new(topic, output)
            elif live.output != output:
                live = self._with_output(live, output, is_recorded=is_recorded)
            if topic not in given and (output is not None or topic in self._watched):
                # Only what records it was told of its source, perhaps.
                live.is_told = False
            live.is_recorded = is_recorded
            self._topics[topic] = live
        for topic, live in before.items():
            if self._topics.get(topic) is not live:
                live.close()

    def look(self, graph: GraphChange) -> list[SourceChanged]:
        """Follow the graph: what changed since the last look."""
        self._look_at_operators(graph)
        testudos = relaying_nodes(self._robot, self._warn_once)
        moved = self._publishers.look(self._topics, graph)
        unseen = [topic for topic, live in self._topics.items() if live.source is None or not live.is_told]
        if testudos != self._testudos:
            moved, self._testudos = list(self._topics), testudos
        changes = [self._look_at(self._topics[topic]) for topic in dict.fromkeys([*moved, *unseen])]
        now_ns = self._robot.steady_ns()
        for live in self._topics.values():
            self._forget_undiscovered(live, now_ns)
        return [change for change in changes if change is not None]

    def listeners(self) -> list[ListenersChanged]:
        """Which relayed topics have, as of the last look, gained a subscriber or lost their last one."""
        heard = {
            topic: frozenset(one.gid for one in self._subscribers.of(live.output))
            for topic, live in self._topics.items()
            if live.output is not None
        }
        before, self._heard = self._heard, heard
        return [
            ListenersChanged(topic=topic, are_there=bool(now))
            for topic, now in heard.items()
            if (now - before.get(topic, now)) or (not now and before.get(topic, True))
        ]

    def heard_here(self) -> frozenset[str]:
        """The relayed topics that have, as of the last look, a subscriber on a ROS graph."""
        return frozenset(
            topic
            for topic, live in self._topics.items()
            if live.output is not None and any(one.gid for one in self._subscribers.of(live.output))
        )

    def subscription(self, topic: str) -> Subscription | None:
        """The subscription to a topic, if there is one."""
        live = self._topics.get(topic)
        return None if live is None else live.subscription

    def subscriptions(self) -> dict[str, Subscription]:
        """All subscriptions that are open."""
        return {
            topic: live.subscription for topic, live in self._topics.items() if live.subscription is not None
        }

    def pausable(self) -> dict[str, Subscription]:
        """The subscriptions to topics that are not recorded and have one publisher, or none any more."""
        return {
            topic: subscription
            for topic, subscription in self.subscriptions().items()
            if topic not in self.recorded and len(self._publishers.of(topic)) <= 1
        }

    def ends(self, *, is_published: bool) -> dict[str, tuple[Subscription, Publisher | None]]:
        """Where messages come in and go out, of topics that have one place for each, or are recorded only.

        Unless what passes ``is_published``, they go out nowhere.
        """
        ends = {topic: live.ends(is_published=is_published) for topic, live in self._topics.items()}
        read_only = {topic for topic in self._watched if self._topics[topic].output is None}
        return {topic: one for topic, one in ends.items() if one is not None and topic not in read_only}

    def heard(self) -> Iterator[tuple[str, LiveSource]]:
        """The topics whose messages are received, with their sources."""
        for topic, live in self._topics.items():
            if live.subscription is not None and live.source is not None:
                yield topic, live.source

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
        """Send a message on its output topic."""
        live = self._topics.get(relayed.topic)
        if live is None:
            return
        try:
            live.publish(relayed.payload, relayed.publisher)
        except RosError as error:
            self._warn_once(str(error))

    def links(self) -> dict[str, TopicLink]:
        """Connections of each relayed topic."""
        return {
            topic: topic_link(live, live.output, self._subscribers.of(live.output))
            for topic, live in self._topics.items()
            if live.output is not None
        }

    def _new(self, topic: str, output: str | None) -> OpenTopic:
        priority = self._priority_of(topic)
        return OpenTopic(topic, output, self._data_path, partial(self._receive, topic), priority)

    def _with_output(self, live: OpenTopic, output: str | None, *, is_recorded: bool) -> OpenTopic:
        if not live.keeps_subscription(is_recorded=is_recorded):
            return self._new(live.topic, output)
        try:
            live.serve(output)
        except RosError as error:
            self._warn_once(str(error))
        return live

    def _look_at_operators(self, graph: GraphChange) -> None:
        outputs = {live.output: live for live in self._topics.values() if live.output is not None}
        for output in self._subscribers.look(outputs, graph):
            self._name_unserved(outputs[output])
        wanted = self._wanted(live.topic for output, live in outputs.items() if self._subscribers.of(output))
        for topic, live in self._topics.items():
            self._want(live, is_wanted=topic in wanted)

    def _wanted(self, heard: Iterable[str]) -> Collection[str]:
        if not self._is_lazy:
            return self._topics
        listened = set(heard)
        leaders = {self._leaders.get(topic, topic) for topic in listened}
        return self._watched | self.recorded | self._latched() | listened | leaders

    def _latched(self) -> frozenset[str]:
        """Latched topics, which every incident holds, if there can be any."""
        if not self.recorded:
            return frozenset()
        topics = self._topics.items()
        return frozenset(
            topic for topic, live in topics if live.source is not None and live.source.qos.transient_local
        )

    def _want(self, live: OpenTopic, *, is_wanted: bool) -> None:
        try:
            has_changed = live.want(is_wanted=is_wanted)
        except RosError as error:
            self._warn_once(str(error))
            return
        if has_changed:
            self._robot.log.info(f"{live.topic}: {self._why(live)}")

    def _why(self, live: OpenTopic) -> str:
        if not live.is_wanted:
            return "not subscribed, because there is no subscriber"
        has_subscriber = live.output is not None and self._subscribers.of(live.output)
        why = "there is a subscriber" if has_subscriber else "rules read or record it"
        return f"subscribed, because {why}"

    def _look_at(self, live: OpenTopic) -> SourceChanged | None:
        endpoints = self._publishers.of(live.topic)
        own = [endpoint for endpoint in endpoints if endpoint.node not in self._testudos]
        live.unheard = frozenset(endpoint.gid for endpoint in endpoints) - {endpoint.gid for endpoint in own}
        self._report_others(live.topic, endpoints, own)
        before = live.source
        source = live_source(own, before)
        if source is None:
            return None
        if source != before:
            live.has_header = self._robot.begins_with_header(source.type_name)
            self._report(live, source)
        try:
            live.follow(source)
        except RosError as error:
            self._warn_once(str(error))
        self._name_unserved(live)
        is_told, live.is_told = live.is_told, True
        return None if source == before and is_told else _changed(live.topic, source)

    def _forget_undiscovered(self, live: OpenTopic, now_ns: int) -> None:
        try:
            live.forget_undiscovered(partial(self._robot.publishers, live.topic), now_ns)
        except RosError as error:
            self._warn_once(str(error))

    def _report_others(self, topic: str, endpoints: Sequence[Endpoint], own: Sequence[Endpoint]) -> None:
        if endpoints and not own:
            self._warn_once(f"{topic}: only SmartTestudo nodes publish it, so it is not relayed")
        elif len(endpoints) > len(own) and self._data_path.tells_publishers:
            self._warn_once(f"{topic}: a SmartTestudo node publishes it too; its messages are not relayed")
        elif len(endpoints) > len(own):
            self._warn_once(f"{topic}: a SmartTestudo node publishes it too; they cannot be told apart")
        if len(own) > 1 and not self._data_path.tells_publishers:
            self._warn_once(f"{topic}: its {len(own)} publishers cannot be told apart and share one rate")

    def _report(self, live: OpenTopic, source: LiveSource) -> None:
        log, topic, before = self._robot.log, live.topic, live.source
        if source.publishers == 0:
            log.info(f"{topic}: no publisher left")
        elif before is None or before.publishers == 0 or not suits(before, source):
            delivery = "reliable" if source.qos.reliable else "best effort"
            latched = ", transient local" if source.qos.transient_local else ""
            unheard = "" if live.is_wanted else "; not subscribed, because there is no subscriber"
            log.info(f"{topic}: {source.type_name}, {delivery}{latched}{unheard}")
        for other in source.other_types:
            self._warn_once(f"{topic}: also published as {other}; only {source.type_name} is relayed")

    def _name_unserved(self, live: OpenTopic) -> None:
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

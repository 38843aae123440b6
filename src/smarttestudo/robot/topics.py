# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The subscriptions and publishers of all topics of a live run, following the ROS graph."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from functools import partial
from typing import TypeVar

from smarttestudo.domain.errors import RosError, TestudoError, said
from smarttestudo.domain.names import MAX_NAME_LENGTH
from smarttestudo.domain.observation import ListenersChanged, SourceChanged, Undecodable
from smarttestudo.domain.robot import (
    UNKNOWN_NODE,
    Endpoint,
    GraphChange,
    Payload,
    Robot,
    Subscription,
    relaying_nodes,
)
from smarttestudo.domain.texts import SayOnce
from smarttestudo.loop.relay import Relayed
from smarttestudo.robot.endpoint_cache import EndpointCache
from smarttestudo.robot.settled_topics import Ends, SettledTopics
from smarttestudo.robot.status_topics import DIAGNOSTICS_TOPIC
from smarttestudo.robot.topic import LiveSource, OpenTopic, live_source, suits
from smarttestudo.robot.topic_link import TopicLink, instead_of, not_offered

_OF_EVERY_RUN = frozenset({"/rosout", "/parameter_events", DIAGNOSTICS_TOPIC})
"""What each SmartTestudo node publishes beside others."""
_Answer = TypeVar("_Answer")
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
        self._publishers = EndpointCache(
            self._asking(robot.publisher_count, 0), self._asking(robot.publishers, ())
        )
        self._subscribers = EndpointCache(
            self._asking(robot.subscriber_count, 0), self._asking(robot.subscribers, ())
        )
        self._heard: Mapping[str, frozenset[bytes]] = {}
        self._testudos: frozenset[str] = frozenset()
        self._warn_once = SayOnce(robot.log.warning)
        self._settled = self._settled_now()
        self._wanted_by: SettledTopics | None = None
        """Those of which the wanted ones are subscribed to."""

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
        self._settled = self._settled_now()

    def poll(self, graph: GraphChange) -> list[SourceChanged]:
        """Follow the graph: what changed since the last poll."""
        self._poll_operators(graph)
        testudos = self._relaying_nodes()
        moved = self._publishers.poll(self._topics, graph)
        unseen = self._settled.unseen
        if testudos != self._testudos:
            moved, self._testudos = list(self._topics), testudos
        changes = [self._look_at(self._topics[topic]) for topic in dict.fromkeys([*moved, *unseen])]
        told = [change for change in changes if change is not None]
        if moved or told:
            self._settled = self._settled_now()
        now_ns = self._robot.steady_ns()
        for live in self._settled.latched:
            self._forget_undiscovered(live, now_ns)
        return told

    def listeners(self) -> list[ListenersChanged]:
        """Which relayed topics have, as of the last poll, gained a subscriber or lost their last one."""
        heard = self._settled.listeners
        before, self._heard = self._heard, heard
        if heard is before:
            return []
        return [
            ListenersChanged(topic=topic, are_there=bool(now))
            for topic, now in heard.items()
            if (now - before.get(topic, now)) or (not now and before.get(topic, True))
        ]

    def heard_here(self) -> frozenset[str]:
        """The relayed topics that have, as of the last poll, a subscriber on a ROS graph."""
        return frozenset(
            topic
            for topic, live in self._topics.items()
            if live.output is not None and any(one.gid for one in self._subscribers.of(live.output))
        )

    def publishers(self, topic: str) -> Sequence[Endpoint]:
        """The publishers of a topic, as of the last poll."""
        return self._publishers.of(topic)

    def subscription(self, topic: str) -> Subscription | None:
        """The subscription to a topic, if there is one."""
        live = self._topics.get(topic)
        return None if live is None else live.subscription

    def subscriptions(self) -> Mapping[str, Subscription]:
        """All subscriptions that are open."""
        return self._settled.subscriptions

    def pausable(self) -> Mapping[str, Subscription]:
        """The subscriptions to topics that are not recorded and have one publisher, or none any more."""
        return self._settled.pausable

    def ends(self, *, is_published: bool) -> Ends:
        """Where messages come in and go out, of topics that have one place for each, or are recorded only.

        Unless what passes ``is_published``, they go out nowhere.
        """
        return self._settled.ends if is_published else self._settled.beginnings

    def heard(self) -> Sequence[tuple[str, LiveSource]]:
        """The topics whose messages are received, with their sources."""
        return self._settled.heard

    def decoded(self, topic: str, payload: Payload) -> object:
        """The message of a payload that just came, or ``Undecodable``."""
        source = self._topics[topic].source
        assert source is not None
        try:
            return self._data_path.decode(topic, source.type_name, payload)
        except Exception:  # noqa: BLE001 - whatever it fails of, the message is what is not known
            self._warn_once(f"{topic}: a message could not be decoded; what checks read is unknown then")
            return Undecodable()

    def publish(self, relayed: Relayed) -> None:
        """Send a message on its output topic."""
        live = self._topics.get(relayed.topic)
        if live is not None:
            live.publish(relayed.payload, relayed.publisher)

    def links(self) -> Mapping[str, TopicLink]:
        """Connections of each relayed topic."""
        return self._settled.links

    def _settled_now(self) -> SettledTopics:
        return SettledTopics(
            self._topics,
            self._publishers.of,
            self._subscribers.of,
            recorded=self.recorded,
            watched=self._watched,
        )

    def _new(self, topic: str, output: str | None) -> OpenTopic:
        return OpenTopic(
            topic,
            output,
            self._data_path,
            partial(self._receive, topic),
            on_problem=self._note_problem,
            priority=self._priority_of(topic),
        )

    def _with_output(self, live: OpenTopic, output: str | None, *, is_recorded: bool) -> OpenTopic:
        if not live.keeps_subscription(is_recorded=is_recorded):
            return self._new(live.topic, output)
        live.serve(output)
        return live

    def _poll_operators(self, graph: GraphChange) -> None:
        outputs = self._settled.outputs
        moved = self._subscribers.poll(outputs, graph)
        for output in moved:
            self._name_unserved(outputs[output])
        if moved:
            self._settled = self._settled_now()
        if self._wanted_by is self._settled:
            return
        self._wanted_by = self._settled
        wanted = self._wanted(live.topic for output, live in outputs.items() if self._subscribers.of(output))
        for topic, live in self._topics.items():
            if self._want(live, is_wanted=topic in wanted):
                self._settled = self._settled_now()

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

    def _want(self, live: OpenTopic, *, is_wanted: bool) -> bool:
        """Whether that changes what is open."""
        has_changed = live.want(is_wanted=is_wanted)
        if has_changed and (live.subscription is not None) is is_wanted:
            self._robot.log.info(f"{live.topic}: {self._why(live)}")
        return has_changed

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
            self._report(live, source)
        live.follow(source, self._refusal(live.topic, endpoints, own))
        if source != before:
            live.note_header(self._robot.begins_with_header)
        self._name_unserved(live)
        is_told, live.is_told = live.is_told, True
        if source == before and is_told:
            return None
        return SourceChanged(
            topic=live.topic,
            publishers=source.publishers,
            transient_local=source.qos.transient_local,
            type_name=source.type_name,
        )

    def _refusal(
        self, topic: str, endpoints: Sequence[Endpoint], own: Sequence[Endpoint]
    ) -> TestudoError | None:
        """Why a topic is not relayed: what is sent of it would come back without end."""
        if self._data_path.tells_publishers or len(endpoints) == len(own):
            return None
        if self._robot.fed_nodes.isdisjoint(one.node for one in endpoints):
            return None
        return RosError(
            "what is sent of it is published here again, and rclpy does not tell publishers apart",
            place=topic,
            remedy="start 'testudo receive' with a ROS_DOMAIN_ID of its own",
        )

    def _forget_undiscovered(self, live: OpenTopic, now_ns: int) -> None:
        live.forget_undiscovered(partial(self._robot.publishers, live.topic), now_ns)

    def _report_others(self, topic: str, endpoints: Sequence[Endpoint], own: Sequence[Endpoint]) -> None:
        if any(one.node.endswith(UNKNOWN_NODE) for one in endpoints):
            # Whose they are is known a moment later.
            return
        if topic in _OF_EVERY_RUN and self._data_path.tells_publishers:
            # Nothing is amiss, and its own messages are left out.
            return
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
            asked = not_offered(live.source.qos, subscriber)
            if asked:
                self._warn_once(
                    f"{live.output}: {subscriber.node} asks for {' and '.join(asked)}, which this relay does "
                    f"not offer, and receives nothing; have it ask for {instead_of(asked)}"
                )

    def _asking(self, ask: Callable[[str], _Answer], nothing: _Answer) -> Callable[[str], _Answer]:
        """``ask`` of the graph, which knows ``nothing`` of a topic for which that fails."""

        def asked(topic: str) -> _Answer:
            if len(topic) > MAX_NAME_LENGTH:
                # No publisher of that name can be opened, which is said.
                return nothing
            try:
                return ask(topic)
            except Exception as error:  # noqa: BLE001 - whatever it fails of costs the topic only
                live = self._settled.outputs.get(topic) or self._topics.get(topic)
                if live is not None:
                    live.fail(error)
                return nothing

        return asked

    def _relaying_nodes(self) -> frozenset[str]:
        try:
            return relaying_nodes(self._robot, self._warn_once)
        except Exception as error:  # noqa: BLE001 - then those are that were
            self._warn_once(said(error))
            return self._testudos | {self._robot.name}

    def _note_problem(self, error: TestudoError | None) -> None:
        self._settled = self._settled_now()
        if error is not None:
            self._warn_once(str(error))

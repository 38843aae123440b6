# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All topics of a live run, which follow the ROS graph."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import TypeVar

from smarttestudo.domain.errors import RosError, TestudoError, said
from smarttestudo.domain.names import MAX_NAME_LENGTH
from smarttestudo.domain.observation import ListenersChanged, SourceChanged
from smarttestudo.domain.robot import UNKNOWN_NODE, Endpoint, GraphChange, Robot, relaying_nodes
from smarttestudo.domain.texts import SayOnce
from smarttestudo.robot.source import LiveSource, instead_of, live_source, not_offered, suits
from smarttestudo.robot.status_topics import DIAGNOSTICS_TOPIC
from smarttestudo.robot.topic import OnMessage, Topic

POLLS_PER_ROUND = 5
QUIET_POLLS_PER_ROUND = 20
"""The same where no change was reported: the middleware compares a topic with all that are there."""


class EndpointCache:
    """A cache of the endpoints of topics, of which ``count`` gives the number, and ``find`` all.

    ``find`` costs several times as much. Where changes of the graph are reported, it is called for all topics
    after one. Where they are not, each poll counts, and finds anew where the number changed and for a fifth
    of the others in turn, so that one that was replaced by another is found too. Where none was reported, a
    look does that for a twentieth of the topics: what was not reported all the same is found then.
    """

    def __init__(self, count: Callable[[str], int], find: Callable[[str], Sequence[Endpoint]]) -> None:
        self._count = count
        self._find = find
        self._found: dict[str, Sequence[Endpoint]] = {}
        self._polls = 0

    def poll(self, topics: Iterable[str], graph: GraphChange) -> list[str]:
        """Topics among ``topics`` whose endpoints are not what they were at the last poll."""
        counted = QUIET_POLLS_PER_ROUND if graph is GraphChange.NONE else 1
        found = 1 if graph is GraphChange.REPORTED else counted * POLLS_PER_ROUND
        polls = self._polls
        self._polls += 1
        return [
            topic
            for place, topic in enumerate(topics)
            if (place - polls) % counted == 0 or topic not in self._found
            if self._is_new(topic, is_to_be_found=(place - polls) % found == 0)
        ]

    def of(self, topic: str) -> Sequence[Endpoint]:
        """The endpoints of ``topic`` as of the last poll."""
        return self._found.get(topic, ())

    def _is_new(self, topic: str, *, is_to_be_found: bool) -> bool:
        known = self._found.get(topic)
        if known is not None and not is_to_be_found and self._count(topic) == len(known):
            return False
        self._found[topic] = found = self._find(topic)
        return found != known


_OF_EVERY_RUN = frozenset({"/rosout", "/parameter_events", DIAGNOSTICS_TOPIC})
"""What each SmartTestudo node publishes beside others."""
_Answer = TypeVar("_Answer")


class LiveTopics:
    """Keeps the ``topics`` of a rule set, by their names, and follows the graph with them.

    Unless ``is_lazy`` is false, a source that no check reads is subscribed to only while its output topic, or
    that of a topic paced with it, has a subscriber. When messages pile up, the topics of the highest
    ``priority_of`` are served first. An error of one topic is logged once and affects that topic only.
    ``changes`` counts what changes about them but for messages: what is open, a source, an endpoint.
    """

    def __init__(
        self,
        robot: Robot,
        topics: dict[str, Topic],
        receive: OnMessage,
        priority_of: Callable[[str], float],
        *,
        is_lazy: bool = True,
    ) -> None:
        self.changes = 0
        self._robot = robot
        self._topics = topics
        self._priority_of = priority_of
        self._data_path = robot.data_path
        self._receive = receive
        self._is_lazy = is_lazy
        self._by_output: dict[str, Topic] = {}
        self._leaders: Mapping[str, str] = {}
        self._publishers = EndpointCache(
            self._asking(robot.publisher_count, 0), self._asking(robot.publishers, ())
        )
        self._subscribers = EndpointCache(
            self._asking(robot.subscriber_count, 0), self._asking(robot.subscribers, ())
        )
        self._testudos: frozenset[str] = frozenset()
        self._doubted: frozenset[str] = frozenset()
        self._warn_once = SayOnce(robot.log.warning)
        self._wanted_at = -1
        """The ``changes`` by which the wanted topics are subscribed to."""

    def follow(
        self,
        output_topics: Mapping[str, str],
        watched: Collection[str],
        leaders: Mapping[str, str],
        *,
        recorded: Collection[str] = (),
    ) -> Sequence[Topic]:
        """Serve these topics from now on; the others, which are closed and returned.

        ``output_topics`` names the output topic of each relayed source; ``watched`` are the sources that are
        read by checks; ``leaders`` says with which topic others are paced. ``recorded`` are received whole,
        and so is what is latched, if there are any.
        """
        before, self._leaders = dict(self._topics), leaders
        self._topics.clear()
        for name in dict.fromkeys([*output_topics, *watched, *sorted(recorded)]):
            topic = before.pop(name, None) or Topic(
                name, self._robot, self._receive, on_problem=self._note_problem
            )
            self._serve(
                topic, output_topics.get(name), is_recorded=name in recorded, is_watched=name in watched
            )
            self._topics[name] = topic
        self._by_output = {topic.output: topic for topic in self._topics.values() if topic.output is not None}
        for topic in before.values():
            topic.close()
        self.changes += 1
        return [*before.values()]

    def _serve(self, topic: Topic, output: str | None, *, is_recorded: bool, is_watched: bool) -> None:
        topic.priority, was_given = self._priority_of(topic.name), topic.is_given
        if topic.output != output:
            topic.serve(output, is_recorded=is_recorded)
            topic.subscribers = () if output is None else self._subscribers.of(output)
        if output is None:
            topic.listeners = None
        topic.is_watched = is_watched
        if topic.is_given and not was_given:
            # Only what records it knows its source, perhaps.
            topic.is_reported = False
        topic.is_recorded = is_recorded

    def poll(self, graph: GraphChange) -> list[SourceChanged]:
        """Follow the graph: what changed since the last poll."""
        self._poll_operators(graph)
        testudos = self._relaying_nodes()
        moved = self._publishers.poll(self._topics, graph)
        unseen = [name for name, one in self._topics.items() if one.source is None or not one.is_reported]
        doubted = self._robot.doubted_nodes
        if (testudos, doubted) != (self._testudos, self._doubted):
            moved, self._testudos, self._doubted = list(self._topics), testudos, doubted
        changes = [self._look_at(self._topics[name]) for name in dict.fromkeys([*moved, *unseen])]
        changed = [change for change in changes if change is not None]
        if moved or changed:
            self.changes += 1
        now_ns = self._robot.steady_ns()
        for topic in self._topics.values():
            if topic.is_latched:
                topic.forget_undiscovered(partial(self._robot.publishers, topic.name), now_ns)
        return changed

    def listeners(self) -> list[ListenersChanged]:
        """Which relayed topics have, as of the last poll, gained a subscriber or lost their last one."""
        changes = []
        for topic in self._by_output.values():
            now = frozenset(one.gid for one in topic.subscribers)
            before, topic.listeners = topic.listeners, now
            if now - (now if before is None else before) or (not now and before != now):
                changes.append(ListenersChanged(topic=topic.name, are_there=bool(now)))
        return changes

    def subscribed_here(self) -> frozenset[str]:
        """The relayed topics that have, as of the last poll, a subscriber on a ROS graph."""
        relayed = self._by_output.values()
        return frozenset(topic.name for topic in relayed if any(one.gid for one in topic.subscribers))

    def _poll_operators(self, graph: GraphChange) -> None:
        moved = self._subscribers.poll(self._by_output, graph)
        for output in moved:
            topic = self._by_output[output]
            topic.subscribers = self._subscribers.of(output)
            self._name_unserved(topic)
        if moved:
            self.changes += 1
        if self._wanted_at == self.changes:
            return
        self._wanted_at = self.changes
        wanted = self._wanted(topic.name for topic in self._by_output.values() if topic.subscribers)
        for name, topic in self._topics.items():
            if self._want(topic, is_wanted=name in wanted):
                self.changes += 1

    def _wanted(self, listened: Iterable[str]) -> Collection[str]:
        topics = self._topics
        if not self._is_lazy:
            return topics
        received = set(listened)
        leaders = {self._leaders.get(name, name) for name in received}
        read = {name for name, topic in topics.items() if topic.is_watched or topic.is_recorded}
        return read | self._latched() | received | leaders

    def _latched(self) -> frozenset[str]:
        """Latched topics, which every incident holds, if there can be any."""
        topics = self._topics.values()
        if not any(topic.is_recorded for topic in topics):
            return frozenset()
        return frozenset(
            topic.name for topic in topics if topic.source is not None and topic.source.qos.transient_local
        )

    def _want(self, topic: Topic, *, is_wanted: bool) -> bool:
        """Whether that changes what is open."""
        has_changed = topic.want(is_wanted=is_wanted)
        if has_changed and (topic.subscription is not None) is is_wanted:
            self._robot.log.info(f"{topic.name}: {self._why(topic)}")
        return has_changed

    def _why(self, topic: Topic) -> str:
        if not topic.is_wanted:
            return "not subscribed, because there is no subscriber"
        why = "there is a subscriber" if topic.subscribers else "rules read or record it"
        return f"subscribed, because {why}"

    def _look_at(self, topic: Topic) -> SourceChanged | None:
        endpoints = topic.publishers = self._publishers.of(topic.name)
        own = [endpoint for endpoint in endpoints if endpoint.node not in self._testudos]
        topic.ignored = frozenset(endpoint.gid for endpoint in endpoints) - {endpoint.gid for endpoint in own}
        self._report_others(topic.name, endpoints, own)
        before = topic.source
        source = live_source(own, before)
        if source is None:
            return None
        if source != before:
            self._report(topic, source)
        topic.follow(source, self._refusal(topic.name, endpoints, own))
        if source != before:
            topic.note_header(self._robot.begins_with_header)
        self._name_unserved(topic)
        is_reported, topic.is_reported = topic.is_reported, True
        if source == before and is_reported:
            return None
        return SourceChanged(
            topic=topic.name,
            publishers=source.publishers,
            transient_local=source.qos.transient_local,
            type_name=source.type_name,
        )

    def _refusal(
        self, topic: str, endpoints: Sequence[Endpoint], own: Sequence[Endpoint]
    ) -> TestudoError | None:
        """Why a topic is not relayed: what is sent of it would come back without end."""
        if self._data_path.identifies_publishers or len(endpoints) == len(own):
            return None
        if self._robot.fed_nodes.isdisjoint(one.node for one in endpoints):
            return None
        return RosError(
            "what is sent of it is published here again, and rclpy does not tell publishers apart",
            place=topic,
            remedy="start 'testudo receive' with a ROS_DOMAIN_ID of its own",
        )

    def _report_others(self, topic: str, endpoints: Sequence[Endpoint], own: Sequence[Endpoint]) -> None:
        if any(one.node.endswith(UNKNOWN_NODE) or one.node in self._doubted for one in endpoints):
            # Whose they are is known a moment later.
            return
        if topic in _OF_EVERY_RUN and self._data_path.identifies_publishers:
            # Nothing is amiss, and its own messages are left out.
            return
        if endpoints and not own:
            self._warn_once(f"{topic}: only SmartTestudo nodes publish it, so it is not relayed")
        elif len(endpoints) > len(own) and self._data_path.identifies_publishers:
            self._warn_once(f"{topic}: a SmartTestudo node publishes it too; its messages are not relayed")
        elif len(endpoints) > len(own):
            self._warn_once(f"{topic}: a SmartTestudo node publishes it too; they cannot be told apart")
        if len(own) > 1 and not self._data_path.identifies_publishers:
            self._warn_once(f"{topic}: its {len(own)} publishers cannot be told apart and share one rate")

    def _report(self, topic: Topic, source: LiveSource) -> None:
        log, name, before = self._robot.log, topic.name, topic.source
        if source.publishers == 0:
            log.info(f"{name}: no publisher left")
        elif before is None or before.publishers == 0 or not suits(before, source):
            delivery = "reliable" if source.qos.reliable else "best effort"
            latched = ", transient local" if source.qos.transient_local else ""
            unsubscribed = "" if topic.is_wanted else "; not subscribed, because there is no subscriber"
            log.info(f"{name}: {source.type_name}, {delivery}{latched}{unsubscribed}")
        for other in source.other_types:
            self._warn_once(f"{name}: also published as {other}; only {source.type_name} is relayed")

    def _name_unserved(self, topic: Topic) -> None:
        if topic.source is None or topic.output is None:
            return
        for subscriber in topic.subscribers:
            asked = not_offered(topic.source.qos, subscriber)
            if asked:
                self._warn_once(
                    f"{topic.output}: {subscriber.node} asks for {' and '.join(asked)}, which this relay "
                    f"does not offer, and receives nothing; have it ask for {instead_of(asked)}"
                )

    def _asking(self, ask: Callable[[str], _Answer], nothing: _Answer) -> Callable[[str], _Answer]:
        """``ask`` of the graph, which knows ``nothing`` of a topic for which that fails."""

        def asked(name: str) -> _Answer:
            if len(name) > MAX_NAME_LENGTH:
                # No publisher of that name can be opened, which is said.
                return nothing
            try:
                return ask(name)
            except Exception as error:  # noqa: BLE001 - whatever it fails of costs the topic only
                topic = self._by_output.get(name) or self._topics.get(name)
                if topic is not None:
                    topic.fail(error)
                return nothing

        return asked

    def _relaying_nodes(self) -> frozenset[str]:
        try:
            return relaying_nodes(self._robot, self._warn_once)
        except Exception as error:  # noqa: BLE001 - then those are that were
            self._warn_once(said(error))
            return self._testudos | {self._robot.name}

    def _note_problem(self, error: TestudoError | None) -> None:
        self.changes += 1
        if error is not None:
            self._warn_once(str(error))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is kept of live topics between two looks is what would be made of them anew."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

from hypothesis import given
from hypothesis import strategies as st

from robot.small_graph import TEXT, SmallGraph
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.robot import GraphChange
from smarttestudo.robot.topic import Topic
from smarttestudo.robot.topics import LiveTopics

TOPICS = ("/imu", "/map")
NOT_INSTALLED = "odd_msgs/msg/Odd"


class Followed:
    """Live topics on a graph of their own; where they are ``always_anew``, nothing is kept."""

    def __init__(self, *, always_anew: bool) -> None:
        self.graph = SmallGraph()
        self.known: dict[str, Topic] = {}
        self.topics = LiveTopics(self.graph, self.known, lambda *_: None, lambda _: 0.0)
        self._always_anew = always_anew
        self.follow((), (), ())

    def follow(self, relayed: tuple[str, ...], watched: tuple[str, ...], recorded: tuple[str, ...]) -> None:
        outputs = {topic: f"/testudo{topic}" for topic in relayed}
        self._follow_again = partial(self.topics.follow, outputs, watched, {}, recorded=recorded)
        self._follow_again()

    def answers(self) -> list[object]:
        """All that is asked of them, one after the other."""
        asked: list[Callable[[], object]] = [
            lambda: {one.name: one.link() for one in self.known.values() if one.output is not None},
            lambda: [one.ends(is_published=True) is not None for one in self.known.values()],
            lambda: [one.ends(is_published=False) is not None for one in self.known.values()],
            lambda: [(one.name, one.source, one.is_wanted, one.may_pause) for one in self.known.values()],
            self.topics.subscribed_here,
            self.topics.listeners,
        ]
        found = []
        for ask in asked:
            self._forget()
            found.append(ask())
        for topic in self.known.values():
            _, publisher = topic.ends(is_published=True) or (None, None)
            assert publisher is None or publisher in self.graph.advertised
        return [
            *found,
            self.graph.subscribed(),
            [one.topic for one in self.graph.advertised],
            self.graph.lines,
        ]

    def look(self, graph: GraphChange) -> list[object]:
        """What a look finds, and what follows from it."""
        self._forget()
        return [self.topics.poll(graph), *self.answers()]

    def _forget(self) -> None:
        if self._always_anew:
            self._follow_again()


Step = Callable[[Followed], object]


@cache
def steps() -> st.SearchStrategy[Step]:
    topic = st.sampled_from(TOPICS)
    some = st.lists(topic, unique=True).map(tuple)
    gid = st.sampled_from((b"first", b"second"))
    return st.one_of(
        st.builds(
            lambda topic, gid, type_name, latched, reliable: (
                lambda one: one.graph.joins(
                    topic, gid, type_name=type_name, transient_local=latched, reliable=reliable
                )
            ),
            topic,
            gid,
            st.sampled_from((TEXT, TEXT, NOT_INSTALLED)),
            st.booleans(),
            st.booleans(),
        ),
        st.builds(
            lambda topic, gid: lambda one: topic in one.graph.sources and one.graph.leaves(topic, gid),
            topic,
            gid,
        ),
        st.builds(
            lambda topic, gid, reliable: (
                lambda one: one.graph.listens(f"/testudo{topic}", gid=gid, reliable=reliable)
            ),
            topic,
            gid,
            st.booleans(),
        ),
        st.builds(lambda topic: lambda one: one.graph.operators.pop(f"/testudo{topic}", None), topic),
        st.builds(lambda gid: lambda one: one.graph.joins(STATUS_TOPIC, gid, node="/other_testudo"), gid),
        st.builds(lambda topic: lambda one: one.graph.joins(topic, b"relayed", node="/other_testudo"), topic),
        st.builds(
            lambda relayed, watched, recorded: lambda one: one.follow(relayed, watched, recorded),
            some,
            some,
            some,
        ),
    )


@cache
def scripts() -> st.SearchStrategy[list[tuple[Step, GraphChange]]]:
    """Changes, each with how the graph is looked at after it."""
    return st.lists(st.tuples(steps(), st.sampled_from(GraphChange)), min_size=10, max_size=40)


@given(script=scripts())
def test_what_is_kept_between_two_looks_is_what_would_be_made_anew(
    script: list[tuple[Step, GraphChange]],
) -> None:
    kept, anew = Followed(always_anew=False), Followed(always_anew=True)
    for step, graph in script:
        for one in (kept, anew):
            step(one)
        assert kept.answers() == anew.answers()
        assert kept.look(graph) == anew.look(graph)


def test_looks_at_a_quiet_graph_make_nothing_of_it_anew() -> None:
    followed = Followed(always_anew=False)
    followed.follow((*TOPICS, "/odom"), (), ())
    for topic in TOPICS:
        followed.graph.joins(topic, b"first")
        followed.graph.listens(f"/testudo{topic}", gid=b"rviz")
    for _ in range(3):
        followed.topics.poll(GraphChange.REPORTED)
    before = followed.topics.changes
    for graph in (GraphChange.NONE, GraphChange.UNREPORTED, GraphChange.REPORTED):
        followed.topics.poll(graph)
        assert followed.topics.changes == before

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which branches are near a place."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

from smarttestudo.checks.analysis.condition_boxes import ConditionBoxes
from smarttestudo.checks.analysis.topic_branches import Setter, TopicBranches, topic_branches
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import Box, Effort, Hull
from smarttestudo.language.boxes.index import Interval
from smarttestudo.language.recall import Recall
from smarttestudo.language.resolved_rules import Branch


class BranchIndex:
    """The boxes of all branches; topics that are set by the same branches share one index."""

    def __init__(self, setters: Sequence[Setter], recall: Recall) -> None:
        self._setters = {one.branch.order: one for one in setters}
        by_topic: dict[str, list[Setter]] = {}
        for run in recall.runs("setters by topic", _by_topic, setters):
            for topic, some in run.items():
                by_topic.setdefault(topic, []).extend(some)
        alike: dict[tuple[Setter, ...], list[str]] = {}
        for topic, setting in by_topic.items():
            alike.setdefault(tuple(setting), []).append(topic)
        self._by_topic: dict[str, TopicBranches] = {}
        for of_topics, topics in alike.items():
            near = _topic_branches(of_topics, tuple(topics), recall)
            self._by_topic.update(dict.fromkeys(topics, near))

    @property
    def topics(self) -> AbstractSet[str]:
        """The topics that branches set."""
        return self._by_topic.keys()

    @property
    def touched(self) -> AbstractSet[int]:
        """The orders of branches near to which something changed since the text before."""
        return set[int]().union(*(one.touched for one in self._by_topic.values()))

    def boxes(self, branch: Branch) -> ConditionBoxes:
        """Where ``branch`` applies."""
        return self._setters[branch.order].boxes

    def topic_branches(self, branch: Branch) -> tuple[TopicBranches, ...]:
        """The branches that set the topics of ``branch``, once for topics that are set alike."""
        found = {id(one): one for one in (self._by_topic[topic] for topic in branch.settings)}
        return tuple(found.values())

    def branches_of(self, topic: str) -> TopicBranches:
        """The branches that set ``topic``."""
        return self._by_topic[topic]

    def around(
        self, branch: Branch, hull: Hull, near: TopicBranches, effort: Effort
    ) -> Iterator[tuple[Branch, Box]]:
        """The branches near ``hull`` that set other rates than ``branch``, each with one of its boxes."""
        for entry in near.near(hull.get, effort, other_than=branch):
            yield self._setters[entry.owner].branch, entry.box

    def setters(self, topic: str) -> Iterator[Branch]:
        """The branches that set ``topic``, in their order."""
        return (one.branch for one in self._by_topic[topic].setters)

    def setters_near(
        self, topic: str, interval_of: Callable[[Signal], Interval], effort: Effort
    ) -> Iterator[Branch]:
        """The branches near a place that set ``topic``."""
        for entry in self._by_topic[topic].near(interval_of, effort):
            yield self._setters[entry.owner].branch


def _by_topic(setters: Iterable[Setter]) -> Mapping[str, Sequence[Setter]]:
    by_topic: dict[str, list[Setter]] = {}
    for one in setters:
        for topic in one.branch.settings:
            by_topic.setdefault(topic, []).append(one)
    return by_topic


def _topic_branches(setters: tuple[Setter, ...], topics: tuple[str, ...], recall: Recall) -> TopicBranches:
    name = "topic branches", topics
    before: TopicBranches | None = recall.before(name)
    known = None if before is None else before.with_setters(setters)
    return recall.keep(name, topic_branches(topics, setters) if known is None else known)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which branches are near a place."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from smarttestudo.checks.analysis.condition_boxes import ConditionBoxes
from smarttestudo.checks.analysis.topic_branches import TopicBranches, topic_branches
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import Box, Effort, Hull
from smarttestudo.language.boxes.index import Interval
from smarttestudo.language.recall import Recall
from smarttestudo.language.resolved_rules import Branch


class BranchIndex:
    """The boxes of all branches; topics that are set by the same branches share one index."""

    def __init__(
        self, branches: Sequence[Branch], boxes_by_branch: Mapping[int, ConditionBoxes], recall: Recall
    ) -> None:
        self._branches = {branch.order: branch for branch in branches}
        self._boxes = boxes_by_branch
        setters: dict[str, list[int]] = {}
        for branch in branches:
            for topic in branch.settings:
                setters.setdefault(topic, []).append(branch.order)
        alike: dict[tuple[int, ...], list[str]] = {}
        for topic, orders in setters.items():
            alike.setdefault(tuple(orders), []).append(topic)
        self._by_topic: dict[str, TopicBranches] = {}
        for setting, topics in alike.items():
            near = self._topic_branches(setting, tuple(topics), recall)
            self._by_topic.update(dict.fromkeys(topics, near))

    def boxes(self, branch: Branch) -> ConditionBoxes:
        """Where ``branch`` applies."""
        return self._boxes[branch.order]

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
            yield self._branches[entry.owner], entry.box

    def setters(self, topic: str) -> Iterator[Branch]:
        """The branches that set ``topic``, in their order."""
        return (branch for branch, _ in self._by_topic[topic].setters.values())

    def setters_near(
        self, topic: str, interval_of: Callable[[Signal], Interval], effort: Effort
    ) -> Iterator[Branch]:
        """The branches near a place that set ``topic``."""
        for entry in self._by_topic[topic].near(interval_of, effort):
            yield self._branches[entry.owner]

    def _topic_branches(
        self, orders: Sequence[int], topics: tuple[str, ...], recall: Recall
    ) -> TopicBranches:
        setters = {order: (self._branches[order], self._boxes[order]) for order in orders}
        before = recall.get("topic branches", key=topics)
        known = before.with_setters(setters) if isinstance(before, TopicBranches) else None
        found = topic_branches(topics, setters) if known is None else known
        recall.keep(found, "topic branches", key=topics)
        return found

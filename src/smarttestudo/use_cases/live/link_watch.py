# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Between the loop and the link that carries what it relays."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from smarttestudo.domain.decision import PlannedRate
from smarttestudo.domain.link import LinkNeeds, OutgoingLink
from smarttestudo.domain.link_state import StreamCounts, TopicOnLink
from smarttestudo.domain.observation import LinkBudget
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.use_cases.live.rules import LiveRules

LINK_PERIOD_S = 0.25
"""How often to look what the link carries."""
_FALL = 0.95
_RISE = 1.1
"""A budget that rises by less is not worth another plan."""


class LinkWatch:
    """Tells a link what its topics need, and the loop what the link carries."""

    def __init__(self, link: OutgoingLink) -> None:
        self._link = link
        self._needs: Mapping[str, LinkNeeds] = {}
        self._told_kb_per_s: float | None = None

    def follow(self, rules: LiveRules, plan: Mapping[str, PlannedRate]) -> None:
        """Have topics served by the floors of ``rules``, their priorities and the planned rates."""
        needs = {
            output: LinkNeeds(
                priority=rules.profile.topic(topic).priority,
                floor_hz=max(
                    rules.rule_set.floors_hz.get(topic, 0.0), rules.profile.topic(topic).min_hz or 0.0
                ),
                is_full=topic in plan and math.isinf(plan[topic].rate.hz),
            )
            for topic, output in rules.output_topics.items()
        }
        if needs != self._needs:
            self._needs = needs
            self._link.follow(needs)

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        """``status`` with the state of the link and of each topic on it."""
        counts = self._link.counts()
        topics = {
            source: replace(topic, on_link=self._on_link(topic.output, counts))
            for source, topic in status.topics.items()
        }
        return replace(status, topics=topics, link=self._link.state)

    def _on_link(self, output: str, counts: Mapping[str, StreamCounts]) -> TopicOnLink | None:
        known = counts.get(output)
        return None if known is None else TopicOnLink(counts=known, age_ms=self._link.age_ms(output))

    def changed_budget(self) -> LinkBudget | None:
        """What the link carries, where that is clearly another budget than was told last."""
        budget_kb_per_s, told = self._link.budget_kb_per_s, self._told_kb_per_s
        if budget_kb_per_s is None:
            return None
        if told is not None and _FALL * told <= budget_kb_per_s <= _RISE * told:
            return None
        self._told_kb_per_s = budget_kb_per_s
        return LinkBudget(link_kb_per_s=budget_kb_per_s, is_measured=True)

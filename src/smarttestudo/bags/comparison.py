# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One run against another, topic by topic: what was published, what was received."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated

from smarttestudo.bags.statistics import TopicStatistics
from smarttestudo.bags.targets import Target
from smarttestudo.domain.record import JsonEntry, derived


def change_percent(before: float | None, after: float | None) -> float | None:
    """How much ``after`` lies above ``before``, in percent of it; ``None`` where that has no meaning."""
    if before is None or after is None or before == 0:
        return None
    return 100 * (after / before - 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicComparison:
    """One topic in both runs; ``None`` where a run does not have it.

    ``after_topic`` is its name in the second run, ``target`` what was planned for it there. A topic that only
    the second run has is called ``/odom (B)`` where the first run has another ``/odom``.
    """

    topic: Annotated[str, JsonEntry(is_absent=True)]
    before: Annotated[TopicStatistics | None, JsonEntry(name="a")]
    after: Annotated[TopicStatistics | None, JsonEntry(name="b")]
    after_topic: Annotated[str | None, JsonEntry(name="b_topic")] = None
    target: Annotated[Target | None, JsonEntry(is_absent=True)] = None

    @property
    @derived()
    def change_percent(self) -> float | None:
        """The change of ``binned_hz``, in percent."""
        if self.before is None or self.after is None:
            return None
        return change_percent(self.before.binned_hz, self.after.binned_hz)

    @property
    @derived()
    def bandwidth_change_percent(self) -> float | None:
        """The change of ``kb_per_s`` (and so of kbit/s), in percent."""
        if self.before is None or self.after is None:
            return None
        return change_percent(self.before.kb_per_s, self.after.kb_per_s)

    @property
    def error_percent(self) -> float | None:
        """How far the second run's ``mean_hz`` lies from what was attainable, in percent of that."""
        if self.after is None or self.target is None:
            return None
        return change_percent(self.target.attainable_hz, self.after.mean_hz)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """All topics of two runs, and what both runs carried in all."""

    topics: Annotated[tuple[TopicComparison, ...], JsonEntry(keyed_by="topic")]

    @property
    def before_kb_per_s(self) -> float | None:
        """KB/s of all topics of the first run; ``None`` if none is known."""
        return _total(pair.before for pair in self.topics)

    @property
    def after_kb_per_s(self) -> float | None:
        """KB/s of all topics of the second run; ``None`` if none is known."""
        return _total(pair.after for pair in self.topics)

    @property
    def bandwidth_change_percent(self) -> float | None:
        """The change of the bandwidth of all topics together, in percent."""
        return change_percent(self.before_kb_per_s, self.after_kb_per_s)


def compare(
    before: Mapping[str, TopicStatistics],
    after: Mapping[str, TopicStatistics],
    targets: Mapping[str, Target | None] | None = None,
    *,
    mapping: Mapping[str, str] | None = None,
) -> Comparison:
    """Pair the topics of two runs, in the order of the first, then what only the second has.

    With the first run's ``/odom`` pairs what ``mapping`` names for it, else the second's ``/testudo/odom`` or
    ``/odom_receive``, else its ``/odom``. ``targets`` go by the first run's topic names.
    """
    targets, mapping = targets or {}, mapping or {}
    pairs = []
    alone = dict(after)
    mapped = {name: alone.pop(name) for name in mapping.values() if name in alone}
    for topic, statistics in before.items():
        if topic in mapping:
            partner: str | None = mapping[topic]
            other = mapped.get(mapping[topic])
        else:
            partner = next((name for name in _partners(topic) if name in alone), None)
            other = alone.pop(partner) if partner else None
        pairs.append(
            TopicComparison(
                topic=topic,
                before=statistics,
                after=other,
                after_topic=None if other is None else partner,
                target=targets.get(topic),
            )
        )
    pairs += [
        TopicComparison(
            topic=f"{topic} (B)" if topic in before else topic,
            before=None,
            after=statistics,
            after_topic=topic,
        )
        for topic, statistics in alone.items()
    ]
    return Comparison(topics=tuple(pairs))


def _partners(topic: str) -> tuple[str, str, str]:
    """The names under which a topic may have been relayed, best first."""
    return f"/testudo{topic}", f"{topic}_receive", topic


def _total(sides: Iterable[TopicStatistics | None]) -> float | None:
    known = [side.kb_per_s for side in sides if side is not None and side.kb_per_s is not None]
    return sum(known) if known else None

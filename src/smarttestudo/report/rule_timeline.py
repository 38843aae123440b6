# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which block decided when, from the decisions of a run."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from smarttestudo.domain.decision import Decision, Reason


@dataclass(frozen=True, slots=True, kw_only=True)
class DecidingBlock:
    """A block by its name and line; the line alone tells two blocks of one name apart.

    ``is_in_doubt``: whether it holds was not known, so that topics got the higher of the rates.
    """

    rule: str
    line: int | None
    is_in_doubt: bool = False

    @property
    def name(self) -> str:
        """The rule's name, and that it is in doubt."""
        return f"{self.rule} (in doubt)" if self.is_in_doubt else self.rule


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSpan:
    """From ``start_s`` to ``end_s`` the ``block`` decided; ``None`` stands for the defaults."""

    start_s: float
    end_s: float
    block: DecidingBlock | None


def by_topic(decisions: Iterable[Decision]) -> dict[str, list[Decision]]:
    """``decisions`` by the topic that they are about."""
    groups: dict[str, list[Decision]] = {}
    for decision in decisions:
        groups.setdefault(decision.topic, []).append(decision)
    return groups


def deciding_spans(decisions: Iterable[Decision], end_s: float) -> tuple[RuleSpan, ...]:
    """The block that decides most topics, over time, from the first decision to ``end_s``.

    Among several it is the one that decides the most topics at that time, and among equals the one that
    comes first in the file; those in doubt come after all others. Where no block decides any topic, it is
    the defaults. Decisions of one topic give the blocks of that topic.
    """
    ordered = sorted(decisions, key=_time)
    blocks: dict[str, DecidingBlock | None] = {}
    spans: list[RuleSpan] = []
    for index, decision in enumerate(ordered):
        blocks[decision.topic] = deciding_block(decision)
        start_s = max(decision.t_s, 0.0)
        next_s = ordered[index + 1].t_s if index + 1 < len(ordered) else end_s
        if start_s < min(next_s, end_s):
            _extend(spans, RuleSpan(start_s=start_s, end_s=min(next_s, end_s), block=_leading(blocks)))
    return tuple(spans)


def deciding_block(decision: Decision) -> DecidingBlock | None:
    """The block behind ``decision``; ``None`` where a default, a floor or no rule at all decided."""
    planned = decision.planned
    if planned.rule is None:
        return None
    is_in_doubt = planned.reason is Reason.UNKNOWN
    return DecidingBlock(rule=planned.rule, line=planned.line, is_in_doubt=is_in_doubt)


def most_topics(decisions: Iterable[Decision]) -> int:
    """How many topics one block decided at most at one time."""
    blocks: dict[str, DecidingBlock | None] = {}
    counts: Counter[DecidingBlock] = Counter()
    most = 0
    for decision in sorted(decisions, key=_time):
        before, now = blocks.get(decision.topic), deciding_block(decision)
        blocks[decision.topic] = now
        if before is not None:
            counts[before] -= 1
        if now is not None:
            counts[now] += 1
            most = max(most, counts[now])
    return most


def block_at(spans: Sequence[RuleSpan], t_s: float) -> DecidingBlock | None:
    """The block that decided at ``t_s``: that of the last span begun by then."""
    index = bisect_right(spans, t_s, key=_start)
    return spans[index - 1].block if index else None


def _leading(blocks: dict[str, DecidingBlock | None]) -> DecidingBlock | None:
    topics = Counter(block for block in blocks.values() if block is not None)
    return min(topics, key=lambda one: (one.is_in_doubt, -topics[one], one.line or 0, one.rule), default=None)


def _extend(spans: list[RuleSpan], span: RuleSpan) -> None:
    """Append ``span``, or lengthen the last one if the same block goes on."""
    if spans and spans[-1].block == span.block and spans[-1].end_s == span.start_s:
        spans[-1] = RuleSpan(start_s=spans[-1].start_s, end_s=span.end_s, block=span.block)
    else:
        spans.append(span)


def _start(span: RuleSpan) -> float:
    return span.start_s


def _time(decision: Decision) -> float:
    return decision.t_s

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which block decided when, and the style of each block: colour, dash and name, the same everywhere."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from smarttestudo.bags.comparison import TargetSpan
from smarttestudo.domain.action import ActionDecision, ActionEvent, ActionKind, value_text
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
    ordered = sorted(decisions, key=lambda decision: decision.t_s)
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
    for decision in sorted(decisions, key=lambda decision: decision.t_s):
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
    index = bisect_right(spans, t_s, key=lambda span: span.start_s)
    return spans[index - 1].block if index else None


def _leading(blocks: dict[str, DecidingBlock | None]) -> DecidingBlock | None:
    topics = Counter(block for block in blocks.values() if block is not None)
    return min(
        topics,
        key=lambda block: (block.is_in_doubt, -topics[block], block.line or 0, block.rule),
        default=None,
    )


def _extend(spans: list[RuleSpan], span: RuleSpan) -> None:
    """Append ``span``, or lengthen the last one if the same block goes on."""
    if spans and spans[-1].block == span.block and spans[-1].end_s == span.start_s:
        spans[-1] = RuleSpan(start_s=spans[-1].start_s, end_s=span.end_s, block=span.block)
    else:
        spans.append(span)


STYLED_BLOCKS = 6
"""How many blocks have a style of their own, as there are colours for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStyle:
    """The class that the style sheet knows a block by, and what a legend calls it."""

    css_class: str
    name: str

    @property
    def colour(self) -> str:
        """The name of its colour and dash in ``styles``."""
        return self.css_class.removeprefix("by-")


DEFAULTS = RuleStyle(css_class="by-default", name="Defaults")
OTHERS = RuleStyle(css_class="by-other", name="Other rules")


class RuleStyles:
    """The styles of a run's blocks: the longest deciding ones have their own, the rest share one.

    Blocks in doubt look alike, but not as one that decided.
    """

    __slots__ = ("_blocks", "_doubts", "_styles")

    def __init__(self, spans: Iterable[RuleSpan]) -> None:
        """Styles for the blocks of ``spans``, numbered in the order of their lines."""
        self._doubts: dict[DecidingBlock, RuleStyle] = {}
        seconds: dict[DecidingBlock, float] = {}
        for span in spans:
            if span.block is not None and span.block.is_in_doubt:
                self._doubts[span.block] = RuleStyle(css_class="by-doubt", name=span.block.name)
            elif span.block is not None:
                seconds[span.block] = seconds.get(span.block, 0.0) + span.end_s - span.start_s
        self._blocks = len(seconds)
        longest = sorted(seconds, key=lambda block: -seconds[block])[:STYLED_BLOCKS]
        shown = sorted(longest, key=lambda block: (block.line or 0, block.rule))
        names = Counter(block.rule for block in shown)
        self._styles: Mapping[DecidingBlock, RuleStyle] = {
            block: RuleStyle(css_class=f"by-rule-{index}", name=_name(block, unique=names[block.rule] == 1))
            for index, block in enumerate(shown, start=1)
        }

    def of(self, block: DecidingBlock | None) -> RuleStyle:
        """The style of ``block``, or of the defaults."""
        if block is None:
            return DEFAULTS
        return self._doubts.get(block) or self._styles.get(block, OTHERS)

    @property
    def all(self) -> tuple[RuleStyle, ...]:
        """Every style, as a legend lists them."""
        others = (OTHERS,) if self._blocks > len(self._styles) else ()
        return (*self._styles.values(), *others, *dict.fromkeys(self._doubts.values()), DEFAULTS)

    def of_zone(self, name: str) -> RuleStyle:
        """The style of the block that is named as a zone is, else that of the defaults."""
        return next((style for block, style in self._styles.items() if block.rule == name), DEFAULTS)


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionSpan:
    """From ``start_s`` to ``end_s`` the ``block`` did something, which ``text`` says, at a place."""

    place: str
    start_s: float
    end_s: float
    block: DecidingBlock
    text: str


_SHOWN_CALL_S = 0.5


def action_spans(actions: Iterable[ActionDecision], end_s: float) -> tuple[ActionSpan, ...]:
    """How long parameters were set and notices held, and when services were called, by their beginning."""
    spans: list[ActionSpan] = []
    begun: dict[str, ActionSpan] = {}
    for one in sorted(actions, key=lambda action: action.t_s):
        action, t_s = one.action, one.t_s
        if one.event.is_outcome or one.event is ActionEvent.NOT_ALLOWED or t_s > end_s:
            continue
        if (before := begun.pop(action.place, None)) is not None:
            spans.append(replace(before, end_s=t_s))
        if one.event is ActionEvent.END:
            continue
        block = DecidingBlock(rule=one.rule or "", line=one.line)
        word = value_text(action.value) if action.value is not None else one.event.value
        span = ActionSpan(place=action.place, start_s=t_s, end_s=end_s, block=block, text=word)
        if action.kind is ActionKind.CALL:
            spans.append(replace(span, end_s=min(end_s, t_s + _SHOWN_CALL_S)))
        else:
            begun[action.place] = span
    clipped = (replace(span, start_s=max(span.start_s, 0.0)) for span in (*spans, *begun.values()))
    return tuple(sorted((span for span in clipped if span.end_s > span.start_s), key=lambda one: one.start_s))


def styles_of(
    decisions: Sequence[Decision], duration_s: float, actions: Sequence[ActionDecision] = ()
) -> RuleStyles:
    """The styles of a run's blocks, by how long each decided a topic or did something else."""
    own = by_topic(decisions).values()
    deciding = [span for group in own for span in deciding_spans(group, duration_s)]
    acting = (
        RuleSpan(start_s=span.start_s, end_s=span.end_s, block=span.block)
        for span in action_spans(actions, duration_s)
    )
    return RuleStyles((*deciding, *acting))


def _name(block: DecidingBlock, *, unique: bool) -> str:
    return block.rule if unique or block.line is None else f"{block.rule} (line {block.line})"


@dataclass(frozen=True, slots=True, kw_only=True)
class StyleSpan:
    """From ``start_s`` to ``end_s``: the style of what is drawn, and what is written on it."""

    start_s: float
    end_s: float
    style: RuleStyle
    text: str = ""


def styled(spans: Iterable[RuleSpan], styles: RuleStyles) -> tuple[StyleSpan, ...]:
    """``spans`` in the style and with the name of their blocks."""
    return tuple(
        StyleSpan(start_s=span.start_s, end_s=span.end_s, style=style, text=style.name)
        for span in spans
        for style in [styles.of(span.block)]
    )


_Span = TypeVar("_Span", TargetSpan, StyleSpan)


def long_enough(spans: Iterable[_Span], shortest_s: float) -> Iterator[_Span]:
    """``spans`` without those shorter than ``shortest_s``, each of which becomes part of the next."""
    start_s: float | None = None
    for span in spans:
        start_s = span.start_s if start_s is None else start_s
        if span.end_s - start_s >= shortest_s:
            yield span if start_s == span.start_s else replace(span, start_s=start_s)
            start_s = None


def bounded(spans: Sequence[_Span], most: int) -> Sequence[_Span]:
    """``spans`` in at most about ``most``."""
    if len(spans) <= most:
        return spans
    return tuple(long_enough(spans, (spans[-1].end_s - spans[0].start_s) / most))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A style for each deciding block: colour, dash and name, the same everywhere on the page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.decision import Decision
from smarttestudo.report.rule_timeline import DecidingBlock, RuleSpan, by_topic, deciding_spans

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


def styles_of(decisions: Sequence[Decision], duration_s: float) -> RuleStyles:
    """The styles of a run's blocks, by how long each decided a topic."""
    own = by_topic(decisions).values()
    return RuleStyles(span for group in own for span in deciding_spans(group, duration_s))


def _name(block: DecidingBlock, *, unique: bool) -> str:
    return block.rule if unique or block.line is None else f"{block.rule} (line {block.line})"

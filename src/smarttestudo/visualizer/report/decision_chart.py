# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which rule decided which topic when, and the rates it gave: a lane for each topic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from smarttestudo.domain.decision import Decision
from smarttestudo.visualizer.report.markup import Markup, tag
from smarttestudo.visualizer.report.rule_styles import RuleStyles
from smarttestudo.visualizer.report.scale import (
    BOTTOM,
    LaneSpan,
    Scale,
    long_enough,
    time_axis,
    time_scale,
    wide_svg,
)
from smarttestudo.visualizer.rule_timeline import RuleSpan, block_at, by_topic, deciding_spans
from smarttestudo.visualizer.targets import target_spans

MAX_LANES = 24
LANE, GAP = 20.0, 4.0
LANES_LEFT = 210.0
MOST_DECIDED = "Most topics"
_MOST_SPANS = 600
_CHARACTER_WIDTH = 6.4
_LONGEST_NAME = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """One line of the chart."""

    name: str
    spans: tuple[LaneSpan, ...]


def lanes(decisions: Sequence[Decision], duration_s: float, styles: RuleStyles) -> tuple[Lane, ...]:
    """The rule that decided most topics, then each topic's rates; the topics with most changes if many."""
    leading = _named_lane(deciding_spans(decisions, duration_s), styles)
    groups = by_topic(decisions)
    busiest = set(sorted(groups, key=lambda topic: -len(groups[topic]))[: MAX_LANES - 1])
    own = [_topic_lane(topic, groups[topic], duration_s, styles) for topic in groups if topic in busiest]
    most = _MOST_SPANS // (1 + len(own))
    return tuple(_bounded(lane, duration_s, most) for lane in (leading, *own))


def decision_chart(rows: Sequence[Lane], duration_s: float) -> Markup:
    """The lanes as an SVG element."""
    x = time_scale(duration_s, LANES_LEFT)
    foot = len(rows) * (LANE + GAP)
    return wide_svg(
        *(part for index, row in enumerate(rows) for part in _lane(row, index * (LANE + GAP), x)),
        *time_axis(x, foot + BOTTOM),
        height=foot + BOTTOM,
        meaning="Rate given to each topic over time, in the colour of the rule that decided it",
        css_class="lanes",
    )


def _bounded(lane: Lane, duration_s: float, most: int) -> Lane:
    """``lane`` in at most about ``most`` spans."""
    if len(lane.spans) <= most:
        return lane
    return replace(lane, spans=tuple(long_enough(lane.spans, duration_s / most)))


def _named_lane(spans: Sequence[RuleSpan], styles: RuleStyles) -> Lane:
    return Lane(
        name=MOST_DECIDED,
        spans=tuple(
            LaneSpan(
                start_s=span.start_s,
                end_s=span.end_s,
                text=styles.of(span.block).name,
                css_class=styles.of(span.block).css_class,
            )
            for span in spans
        ),
    )


def _topic_lane(topic: str, decisions: Sequence[Decision], duration_s: float, styles: RuleStyles) -> Lane:
    blocks = deciding_spans(decisions, duration_s)
    return Lane(
        name=topic,
        spans=tuple(
            LaneSpan(
                start_s=span.start_s,
                end_s=span.end_s,
                text=str(span.rate),
                css_class=styles.of(block_at(blocks, span.start_s)).css_class,
            )
            for span in target_spans(decisions, duration_s)
        ),
    )


def _lane(row: Lane, top: float, x: Scale) -> Iterator[Markup]:
    name = row.name if len(row.name) <= _LONGEST_NAME else f"…{row.name[1 - _LONGEST_NAME :]}"
    yield tag("text", name, class_="lane-name", x=LANES_LEFT - 10, y=top + 14, text_anchor="end")
    for span in row.spans:
        left, width = x(span.start_s), x(span.end_s) - x(span.start_s)
        yield tag("rect", class_=f"bar {span.css_class}", x=left, y=top, width=width, height=LANE)
        if _CHARACTER_WIDTH * len(span.text) + 8 < width:
            yield tag("text", span.text, class_="bar-name", x=left + 6, y=top + 14)

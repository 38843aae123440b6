# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which rule decided which topic when, and the rates it gave: a lane for each topic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from smarttestudo.domain.decision import Decision
from smarttestudo.visualizer.report.markup import Markup, tag
from smarttestudo.visualizer.report.rule_styles import RuleStyles
from smarttestudo.visualizer.report.scale import LookSpan, bounded
from smarttestudo.visualizer.report.time_drawing import Frame, number, plot, share, time_svg
from smarttestudo.visualizer.rule_timeline import RuleSpan, block_at, by_topic, deciding_spans
from smarttestudo.visualizer.targets import target_spans

MAX_LANES = 24
MOST_DECIDED = "Most topics"
_LANE, _PITCH = 20.0, 24.0
_TIMES = 10
_MOST_SPANS = 600
_CHARACTER_WIDTH = 6.4
_USUAL_WIDTH = 820.0
_LONGEST_NAME = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """One line of the chart."""

    name: str
    spans: tuple[LookSpan, ...]


def lanes(decisions: Sequence[Decision], duration_s: float, styles: RuleStyles) -> tuple[Lane, ...]:
    """The rule that decided most topics, then each topic's rates; the topics with most changes if many."""
    leading = _named_lane(deciding_spans(decisions, duration_s), styles)
    groups = by_topic(decisions)
    busiest = set(sorted(groups, key=lambda topic: -len(groups[topic]))[: MAX_LANES - 1])
    own = [_topic_lane(topic, groups[topic], duration_s, styles) for topic in groups if topic in busiest]
    most = _MOST_SPANS // (1 + len(own))
    return tuple(replace(lane, spans=tuple(bounded(lane.spans, most))) for lane in (leading, *own))


def decision_chart(rows: Sequence[Lane], duration_s: float) -> Markup:
    """The lanes as an SVG element, in which a bar that is wide enough has its text on it."""
    duration_s = max(duration_s, 1e-3)
    height = len(rows) * _PITCH
    bars = (_bars(row, index * _PITCH) for index, row in enumerate(rows))
    return time_svg(
        plot(*bars, *_edges(rows), view=(0.0, 0.0, duration_s, height), y=0.0, height=height),
        *(part for index, row in enumerate(rows) for part in _words(row, index * _PITCH + 14, duration_s)),
        frame=Frame(css_class="lanes", top=0.0, height=height, times=_TIMES),
        duration_s=duration_s,
        meaning="Rate given to each topic over time, in the colour of the rule that decided it",
    )


def _named_lane(spans: Sequence[RuleSpan], styles: RuleStyles) -> Lane:
    return Lane(
        name=MOST_DECIDED,
        spans=tuple(
            LookSpan(
                start_s=span.start_s,
                end_s=span.end_s,
                look=styles.of(span.block),
                text=styles.of(span.block).name,
            )
            for span in spans
        ),
    )


def _topic_lane(topic: str, decisions: Sequence[Decision], duration_s: float, styles: RuleStyles) -> Lane:
    blocks = deciding_spans(decisions, duration_s)
    return Lane(
        name=topic,
        spans=tuple(
            LookSpan(
                start_s=span.start_s,
                end_s=span.end_s,
                look=styles.of(block_at(blocks, span.start_s)),
                text=str(span.rate),
            )
            for span in target_spans(decisions, duration_s)
        ),
    )


def _bars(row: Lane, top: float) -> Markup:
    return tag(
        "g",
        *(
            tag(
                "rect",
                class_=f"bar {span.look.css_class}",
                x=number(span.start_s),
                y=top,
                width=number(span.end_s - span.start_s),
                height=_LANE,
            )
            for span in row.spans
        ),
        class_="lane",
    )


def _edges(rows: Sequence[Lane]) -> Iterator[Markup]:
    """Where bars begin, so that a bar that is too short to be seen is."""
    spans = [(span, index * _PITCH) for index, row in enumerate(rows) for span in row.spans]
    for look in {span.look: None for span, _ in spans}:
        own = (f"M{number(span.start_s)} {top:g}v{_LANE:g}" for span, top in spans if span.look == look)
        yield tag("path", class_=f"edge {look.css_class}", d="".join(own))


def _words(row: Lane, at: float, duration_s: float) -> Iterator[Markup]:
    """The lane's name, and the text of each bar; a script shows those for which it makes room."""
    name = row.name if len(row.name) <= _LONGEST_NAME else f"…{row.name[1 - _LONGEST_NAME :]}"
    yield tag("text", name, class_="lane-name", x=-10.0, y=at, text_anchor="end")
    for span in row.spans:
        width = (span.end_s - span.start_s) / duration_s * _USUAL_WIDTH
        hidden = {} if _CHARACTER_WIDTH * len(span.text) + 8 < width else {"display": "none"}
        place = share(span.start_s, duration_s)
        yield tag("text", span.text, class_="bar-name", x=place, dx=6.0, y=at, **hidden)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which rule decided which topic when, and the rates it gave: a lane for each topic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from smarttestudo.bags.incident_mark import IncidentMark
from smarttestudo.bags.targets import target_spans
from smarttestudo.domain.decision import Decision
from smarttestudo.report.axes import number, percent_place, plot
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.rule_timeline import (
    RuleSpan,
    RuleStyles,
    StyleSpan,
    block_at,
    bounded,
    by_topic,
    deciding_spans,
)
from smarttestudo.report.time_drawing import Frame, incident_line, time_svg

MAX_LANES = 24
MOST_DECIDED = "Leading rule"
_LANE, _PITCH, _BASELINE = 20.0, 24.0, 14.0
_TIMES = 10
_MOST_SPANS = 600
_CHARACTER_WIDTH = 6.4
_USUAL_WIDTH, _NARROW_WIDTH = 820.0, 300.0
_LONGEST_NAME = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """One line of the chart."""

    name: str
    spans: tuple[StyleSpan, ...]


def lanes(decisions: Sequence[Decision], duration_s: float, styles: RuleStyles) -> tuple[Lane, ...]:
    """The rule that decided most topics, then each topic's rates; the topics with most changes if many."""
    leading = _named_lane(deciding_spans(decisions, duration_s), styles)
    groups = by_topic(decisions)
    busiest = set(sorted(groups, key=lambda topic: -len(groups[topic]))[: MAX_LANES - 1])
    own = [_topic_lane(topic, groups[topic], duration_s, styles) for topic in groups if topic in busiest]
    most = _MOST_SPANS // (1 + len(own))
    return tuple(replace(lane, spans=tuple(bounded(lane.spans, most))) for lane in (leading, *own))


def decision_chart(rows: Sequence[Lane], duration_s: float, incident: IncidentMark | None = None) -> Markup:
    """The lanes as an SVG element, in which a bar that is wide enough has its text on it.

    The style sheet places the lanes by their number: a lane's name is beside its bars, and above
    them on a narrow screen.
    """
    duration_s = max(duration_s, 1e-3)
    mark = tuple(incident_line(incident, duration_s, _LANE))
    return time_svg(
        *(_drawn(row, index, duration_s, mark) for index, row in enumerate(rows)),
        frame=Frame(
            css_class=f"lanes {_row_class(len(rows))}", top=0.0, height=len(rows) * _PITCH, times=_TIMES
        ),
        duration_s=duration_s,
        meaning="Rate given to each topic over time, in the colour of the rule that decided it",
    )


def row_sheet() -> str:
    """The style rules that number the lanes; the number of the drawing is that of its lanes."""
    return "\n".join(f".{_row_class(row)} {{ --row: {row}; }}" for row in range(MAX_LANES + 1))


def _row_class(row: int) -> str:
    return f"row-{row}"


def _named_lane(spans: Sequence[RuleSpan], styles: RuleStyles) -> Lane:
    return Lane(
        name=MOST_DECIDED,
        spans=tuple(
            StyleSpan(
                start_s=span.start_s,
                end_s=span.end_s,
                style=styles.of(span.block),
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
            StyleSpan(
                start_s=span.start_s,
                end_s=span.end_s,
                style=styles.of(block_at(blocks, span.start_s)),
                text=str(span.rate),
            )
            for span in target_spans(decisions, duration_s)
        ),
    )


def _drawn(row: Lane, index: int, duration_s: float, mark: Sequence[Markup]) -> Markup:
    name = row.name if len(row.name) <= _LONGEST_NAME else f"…{row.name[1 - _LONGEST_NAME :]}"
    bars = plot(*_bars(row), *_edges(row), *mark, view=(0.0, 0.0, duration_s, _LANE), y=0.0, height=_LANE)
    return tag(
        "g",
        tag("text", name, class_="lane-name", x=-10.0, y=_BASELINE, text_anchor="end"),
        tag("g", bars, *_bar_names(row, duration_s), class_="lane-bars"),
        class_=f"lane {_row_class(index)}",
    )


def _bars(row: Lane) -> Iterator[Markup]:
    for span in row.spans:
        width = number(span.end_s - span.start_s)
        style = f"bar {span.style.css_class}"
        yield tag("rect", class_=style, x=number(span.start_s), y=0.0, width=width, height=_LANE)


def _edges(row: Lane) -> Iterator[Markup]:
    """Where bars begin, so that a bar that is too short to be seen is."""
    for style in {span.style: None for span in row.spans}:
        own = (f"M{number(span.start_s)} 0v{_LANE:g}" for span in row.spans if span.style == style)
        yield tag("path", class_=f"edge {style.css_class}", d="".join(own))


def _bar_names(row: Lane, duration_s: float) -> Iterator[Markup]:
    """The text of each bar that has room for it; a script shows those for which it makes room."""
    for span in row.spans:
        part = (span.end_s - span.start_s) / duration_s
        needed = _CHARACTER_WIDTH * len(span.text) + 8
        hidden = {} if needed < part * _USUAL_WIDTH else {"display": "none"}
        style = "bar-name short" if needed < part * _NARROW_WIDTH else "bar-name"
        place = percent_place(span.start_s, duration_s)
        yield tag("text", span.text, class_=style, x=place, dx=6.0, y=_BASELINE, **hidden)

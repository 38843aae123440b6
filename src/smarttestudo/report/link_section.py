# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The load of the link between robot and operator, and the ages of messages behind it."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.domain.units import grouped
from smarttestudo.report.axes import legend, line_entry
from smarttestudo.report.link_history import LinkHistory, TopicOverLink, link_table
from smarttestudo.report.markup import Markup, html_table, name_parts, tag
from smarttestudo.report.rule_timeline import RuleStyle, StyleSpan, bounded
from smarttestudo.report.run_report import MAX_CHARTS
from smarttestudo.report.sections import figure, section
from smarttestudo.report.series import Series
from smarttestudo.report.table import format_number
from smarttestudo.report.time_chart import BANDWIDTH, ChartLine, Run, TimeChart, value_heights
from smarttestudo.report.time_drawing import SMALL, WIDE, draw_chart

_OUTAGE = RuleStyle(css_class="by-other", name="Nothing arrived")
_WIDE_POINTS = 400
_POINTS_OF_ALL_CHARTS = 2000
_MOST_SPANS = 120
_AGE = "ms"
_EXPLANATION = (
    "What the robot told each second: the link's capacity, and the budget that rates are planned within; and "
    "what the operator received, before compression. Below, how old messages were when they arrived."
)


def link_section(history: LinkHistory, received: Series, duration_s: float) -> Markup:
    """The link over time, its outages, and the ages of each topic."""
    silences = _silences(history, duration_s)
    link, ages = link_chart(history, received, duration_s), age_charts(history, duration_s)
    lines = [line_entry("before", "Capacity"), line_entry("after", "Received")]
    if history.budget:
        lines.append(line_entry("budget", "Budget"))
    if silences:
        lines.append(line_entry(f"strip {_OUTAGE.css_class}", _OUTAGE.name))
    points = max(_POINTS_OF_ALL_CHARTS // max(len(ages), 1), 40)
    left_out = sum(bool(topic.ages) for topic in history.topics) - len(ages)
    more = [tag("p", f"{grouped(left_out)} more topics are in the table.", class_="note")] if left_out else []
    return section(
        "What the link did",
        legend(*lines),
        figure("rate", [tag("span", link.name, class_="name")], draw_chart(link, WIDE, _WIDE_POINTS)),
        tag("p", _outages(history), class_="note"),
        tag(
            "div",
            *(
                figure(
                    "rate",
                    [
                        tag("span", *name_parts(chart.name), class_="words name"),
                        tag("span", class_="quiet readout"),
                    ],
                    draw_chart(chart, SMALL, points),
                )
                for chart in ages
            ),
            class_="charts",
        ),
        *more,
        html_table(link_table(history)),
        explanation=_EXPLANATION,
    )


def link_chart(history: LinkHistory, received: Series, duration_s: float) -> TimeChart:
    """Capacity, budget and what was received over time."""
    lines = ((Run.BEFORE, history.capacity), (Run.AFTER, received), (Run.BUDGET, history.budget))
    highest = max((point.highest for _, points in lines for point in points), default=1.0)
    return TimeChart(
        name="Capacity and what was received",
        meaning="What the link carries, the budget and what was received over time, in KB/s",
        unit=BANDWIDTH,
        duration_s=duration_s,
        heights=value_heights(highest, None),
        lines=tuple(ChartLine(run=run, points=points) for run, points in lines if points),
        tints=_silences(history, duration_s),
    )


def age_charts(history: LinkHistory, duration_s: float) -> list[TimeChart]:
    """For each topic whose ages are known, those, the oldest topics first; at most ``MAX_CHARTS``."""
    known = sorted((topic for topic in history.topics if topic.ages), key=_oldest, reverse=True)
    return [
        TimeChart(
            name=topic.topic,
            meaning=f"Age of the messages of {topic.topic} at the operator over time, in ms",
            unit=_AGE,
            duration_s=duration_s,
            heights=value_heights(_highest(topic.ages), None),
            lines=(ChartLine(run=Run.AFTER, points=topic.ages),),
            tints=_silences(history, duration_s),
        )
        for topic in known[:MAX_CHARTS]
    ]


def _oldest(topic: TopicOverLink) -> float:
    return topic.sorted_ages_ms[-1]


def _highest(points: Series) -> float:
    return max(point.highest for point in points)


def _silences(history: LinkHistory, duration_s: float) -> tuple[StyleSpan, ...]:
    spans: Sequence[StyleSpan] = [
        StyleSpan(start_s=start_s, end_s=min(end_s, duration_s), style=_OUTAGE)
        for start_s, end_s in history.silences
        if start_s < duration_s
    ]
    return tuple(bounded(spans, _MOST_SPANS))


def _outages(history: LinkHistory) -> str:
    silent_s = sum(end_s - start_s for start_s, end_s in history.silences)
    if not history.outages and not history.silences:
        return "No outage."
    return f"Outages: {grouped(history.outages)}; nothing arrived for {format_number(silent_s, 0)} s."

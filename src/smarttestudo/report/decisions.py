# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The decisions of rules: a lane for each topic with its rates over time, and a list."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from smarttestudo.bags.comparison import target_spans
from smarttestudo.bags.incident_record import IncidentMark
from smarttestudo.domain.action import ActionDecision, action_line
from smarttestudo.domain.decision import Decision, Reason
from smarttestudo.domain.remote_robots import RuleText
from smarttestudo.domain.signal import Value
from smarttestudo.domain.units import grouped
from smarttestudo.language.formatter import value_text
from smarttestudo.report.axes import label, number, percent_place, plot
from smarttestudo.report.markup import Markup, name_parts, tag
from smarttestudo.report.page import figure, folded, section
from smarttestudo.report.rule_timeline import (
    DEFAULTS,
    RuleStyles,
    StyleSpan,
    action_spans,
    block_at,
    bounded,
    by_topic,
    deciding_block,
    deciding_spans,
    styled,
)
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.styles import MAX_LANES, row_class
from smarttestudo.report.table import format_number
from smarttestudo.report.time_drawing import Frame, incident_line, time_svg

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
    leading = Lane(name=MOST_DECIDED, spans=styled(deciding_spans(decisions, duration_s), styles))
    groups = by_topic(decisions)
    busiest = set(sorted(groups, key=lambda topic: -len(groups[topic]))[: MAX_LANES - 1])
    own = [_topic_lane(topic, groups[topic], duration_s, styles) for topic in groups if topic in busiest]
    most = _MOST_SPANS // (1 + len(own))
    return tuple(replace(lane, spans=tuple(bounded(lane.spans, most))) for lane in (leading, *own))


def action_lanes(
    actions: Sequence[ActionDecision], duration_s: float, styles: RuleStyles
) -> tuple[Lane, ...]:
    """A line for each parameter, service and notice, in the order in which they began."""
    groups: dict[str, list[StyleSpan]] = {}
    for span in action_spans(actions, duration_s):
        groups.setdefault(span.place, []).append(
            StyleSpan(start_s=span.start_s, end_s=span.end_s, style=styles.of(span.block), text=span.text)
        )
    shown = [*groups.items()][: MAX_LANES // 2]
    return tuple(
        Lane(name=place, spans=tuple(bounded(spans, _MOST_SPANS // len(shown)))) for place, spans in shown
    )


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
            css_class=f"lanes {row_class(len(rows))}", top=0.0, height=len(rows) * _PITCH, times=_TIMES
        ),
        duration_s=duration_s,
        meaning="Rate given to each topic over time, in the colour of the rule that decided it",
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
        class_=f"lane {row_class(index)}",
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


MAX_DECISIONS = 200
_DIGITS = 5
_HEADINGS = ("Time", "Topic", "Rate", "Decided by, and what it read")
_NOTES = {
    Reason.UNKNOWN: "unknown",
    Reason.FLOOR: "KeepAtLeast",
    Reason.BUDGET: "budget",
    Reason.LINK: "link",
    Reason.FALLBACK: "fallback",
    Reason.RELOAD: "reload",
}


def decision_list(decisions: Sequence[Decision], styles: RuleStyles) -> Markup:
    """The first ``MAX_DECISIONS`` decisions, and how many more there are."""
    shown = decisions[:MAX_DECISIONS]
    more = len(decisions) - len(shown)
    note = [tag("p", f"… and {grouped(more)} more in the decisions file.", class_="note")] if more else []
    head = (
        tag("th", heading, *_unit(heading), class_="right" if heading == "Time" else "left", scope="col")
        for heading in _HEADINGS
    )
    rows = (
        _row(decision, styles, is_first=before is None or before.t_s != decision.t_s)
        for before, decision in zip((None, *shown), shown, strict=False)
    )
    caption = tag("caption", "Decisions in the order of time", class_="unseen")
    table = tag("table", caption, tag("thead", tag("tr", *head)), tag("tbody", *rows))
    return tag("figure", table, *note, class_="wide decisions")


def action_list(actions: Sequence[ActionDecision]) -> Markup:
    """The first ``MAX_DECISIONS`` events of actions, with what came of them, and how many more there are."""
    more = len(actions) - len(actions[:MAX_DECISIONS])
    note = [tag("p", f"… and {grouped(more)} more in the decisions file.", class_="note")] if more else []
    head = (tag("th", "Time", *_unit("Time"), class_="right", scope="col"), tag("th", "Action", scope="col"))
    rows = (
        tag(
            "tr",
            tag("td", format_number(one.t_s, 1), class_="right"),
            tag("td", action_line(one), class_="left words"),
        )
        for one in actions[:MAX_DECISIONS]
    )
    caption = tag("caption", "Actions in the order of time", class_="unseen")
    table = tag("table", caption, tag("thead", tag("tr", *head)), tag("tbody", *rows))
    return tag("figure", table, *note, class_="wide decisions")


def _unit(heading: str) -> list[Markup]:
    return [tag("span", "s", class_="unit")] if heading == "Time" else []


def _row(decision: Decision, styles: RuleStyles, *, is_first: bool) -> Markup:
    planned = decision.planned
    before = "start" if decision.from_rate is None else str(decision.from_rate)
    return tag(
        "tr",
        tag("td", format_number(decision.t_s, 1), class_="right"),
        tag("td", *name_parts(decision.topic), class_="left words name"),
        tag("td", before, tag("span", " → ", class_="quiet"), str(planned.rate), class_="left steady"),
        tag("td", *_decider(decision, styles), *_values(decision), class_="left words"),
        class_="first" if is_first else "again",
        data_time=f"{decision.t_s:.3f}",
    )


def _text(value: Value | None) -> str:
    if value is None:
        return "unknown"
    return value_text(value) if isinstance(value, str) else label(value, _DIGITS)


def _values(decision: Decision) -> list[Markup]:
    """The values that the condition read; a topic is named once for all its properties in a row."""
    parts: list[str] = []
    last_topic = ""
    for signal, value in decision.values.items():
        topic, _, property_name = signal.partition(" ")
        shown = property_name if topic == last_topic else signal
        last_topic = topic
        parts.append(f"{shown} = {_text(value)}")
    return [tag("span", ", ".join(parts), class_="values quiet")] if parts else []


def _decider(decision: Decision, styles: RuleStyles) -> list[Markup | str]:
    """The block with its line and its colour, else the reason."""
    planned = decision.planned
    block = deciding_block(decision)
    parts: list[Markup | str] = [tag("span", class_=f"dot {styles.of(block).css_class}")]
    parts.append(DEFAULTS.name if block is None else block.rule)
    notes = [f"line {planned.line}"] if planned.line is not None else []
    if planned.reason in _NOTES:
        notes.append(_NOTES[planned.reason])
    return [*parts, tag("span", " · " + " · ".join(notes), class_="quiet")] if notes else parts


MAX_RULE_LINES = 400
MAX_RULE_CHARACTERS = 30_000
_EXPLANATION = "A decision changes the rate of a topic, because a rule begins or ceases to hold."


def decision_section(report: RunReport, styles: RuleStyles) -> Markup:
    """The decisions over time, then each of them and the rules, as far as there are any."""
    rules = list(_rule_files(report.rules))
    if not report.decisions and not report.actions:
        return section("The rules", *rules)
    rows = lanes(report.decisions, report.duration_s, styles)
    acting = action_lanes(report.actions, report.duration_s, styles)
    rows = (*rows[: MAX_LANES - len(acting)], *acting)
    return section(
        "What the rules decided",
        figure(decision_chart(rows, report.duration_s, report.incident), kind="lanes"),
        folded("Decisions", decision_list(report.decisions, styles)),
        *([folded("Actions", action_list(report.actions))] if report.actions else ()),
        *([folded("Rules", *rules)] if rules else ()),
        explanation=_EXPLANATION,
    )


def _rule_files(rules: Sequence[RuleText]) -> Iterator[Markup]:
    """The files with the line numbers that decisions name, as much of them all as there is room for."""
    lines_left, characters_left = MAX_RULE_LINES, MAX_RULE_CHARACTERS
    for rule in rules:
        lines = rule.text[:characters_left].splitlines()[:lines_left]
        lines_left -= len(lines)
        characters_left -= sum(map(len, lines))
        yield tag("h3", rule.name, class_="words name")
        yield tag("pre", *_numbered(lines), tabindex="0")
        if len(lines) < len(rule.text.splitlines()):
            yield tag("p", "The file goes on; this is its beginning.", class_="note")


def _numbered(lines: Sequence[str]) -> Iterator[Markup | str]:
    for line_number, line in enumerate(lines, start=1):
        yield tag("span", f"{line_number:>4}  ", class_="number")
        yield f"{line}\n"

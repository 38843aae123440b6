# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers behind the charts, for the scripts of the report."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from smarttestudo.domain.json_text import json_text
from smarttestudo.visualizer.floor import PathPoint
from smarttestudo.visualizer.report.bandwidth_chart import (
    highest_stacked_kb_per_s,
    highest_total_kb_per_s,
    layers,
)
from smarttestudo.visualizer.report.decision_chart import Lane
from smarttestudo.visualizer.report.map_frame import MapFrame
from smarttestudo.visualizer.report.rate_chart import rate_scale, rate_ticks
from smarttestudo.visualizer.report.run_report import RunReport, TopicSeries
from smarttestudo.visualizer.report.scale import Scale, long_enough, value_scale
from smarttestudo.visualizer.rule_timeline import by_topic
from smarttestudo.visualizer.series import Series, coarser
from smarttestudo.visualizer.table import printable
from smarttestudo.visualizer.targets import TargetSpan, target_spans

_MOST_NUMBERS = 12_000
_MOST_TARGETS = 600
_FEWEST_POINTS, _MOST_POINTS = 50, 1000
_ARRAYS_PER_TOPIC = 6
_DIGITS = 4


def chart_data(
    report: RunReport,
    shown: Sequence[TopicSeries],
    rows: Sequence[Lane],
    frame: MapFrame | None,
    path: Sequence[PathPoint],
) -> str:
    """JSON that may stand within a script element: it has no ``<`` in it.

    The more topics are ``shown``, the fewer points each has; the least and the greatest value of what a
    point stands for stay.
    """
    topics = max(len(shown), 1)
    fair_points = _MOST_NUMBERS // (_ARRAYS_PER_TOPIC * topics)
    max_points = min(max(fair_points, _FEWEST_POINTS), _MOST_POINTS)
    decisions = by_topic(report.decisions)
    numbers = {
        "duration": report.duration_s,
        "isPair": report.is_pair,
        "budget": report.budget_kb_per_s,
        "topics": [
            _topic(
                series,
                target_spans(decisions.get(series.topic, []), report.duration_s),
                max_points=max_points,
                most_targets=_MOST_TARGETS // topics,
            )
            for series in shown
        ],
        "total": _total(report, max_points),
        "stack": _stack(report, max_points),
        "lanes": [_lane(row) for row in rows],
        "path": [] if frame is None else [_place(point, frame) for point in path],
    }
    text = json_text(numbers, compact=True)
    return text.replace("<", "\\u003c")


def _total(report: RunReport, max_points: int) -> dict[str, object]:
    return {
        "top": value_scale(highest_total_kb_per_s(report), 0.0).values[-1],
        "before": _course(report.total.before.kb_per_s, max_points),
        "after": _course(report.total.after.kb_per_s, max_points),
    }


def _stack(report: RunReport, max_points: int) -> dict[str, object]:
    return {
        "top": value_scale(highest_stacked_kb_per_s(report), 0.0).values[-1],
        "layers": [
            {"name": printable(layer.name), **_course(layer.points, max_points, mean=True)}
            for layer in layers(report, of_second=report.is_pair)
        ],
    }


def _lane(row: Lane) -> dict[str, object]:
    return {
        "name": printable(row.name),
        "spans": [
            [_s(span.start_s), _s(span.end_s), printable(span.text), span.css_class] for span in row.spans
        ],
    }


def _topic(
    series: TopicSeries, targets: Sequence[TargetSpan], *, max_points: int, most_targets: int
) -> dict[str, object]:
    y = rate_scale(series, targets)
    return {
        "name": printable(series.topic),
        "values": [_round(value) for value in y.values],
        "places": _from_foot(y),
        "ticks": [_round(value) for value in rate_ticks(y, series)],
        "before": _course(series.before.rate_hz, max_points),
        "after": _course(series.after.rate_hz, max_points),
        "beforeKb": _course(series.before.kb_per_s, max_points, mean=True),
        "afterKb": _course(series.after.kb_per_s, max_points, mean=True),
        "targets": [
            [_s(span.start_s), _s(span.end_s), None if span.rate.is_full else span.rate.hz]
            for span in _bounded(targets, most_targets)
        ],
    }


def _bounded(targets: Sequence[TargetSpan], most: int) -> Iterable[TargetSpan]:
    if len(targets) <= most:
        return targets
    return long_enough(targets, (targets[-1].end_s - targets[0].start_s) / most)


def _from_foot(y: Scale) -> list[float]:
    """The places of a scale as shares of its height."""
    foot, top = y.places[0], y.places[-1]
    return [round((foot - place) / (foot - top), 4) for place in y.places]


def _course(series: Series, max_points: int, *, mean: bool = False) -> dict[str, object]:
    """First time and step, and least and greatest values, once where they are the same; or the means."""
    points = coarser(series, max_points)
    if not points:
        return {"start": 0, "step": 1, "high": []}
    highest = [_round(point.mean if mean else point.highest) for point in points]
    step_s = points[1].t_s - points[0].t_s if len(points) > 1 else 1
    drawn: dict[str, object] = {"start": _s(points[0].t_s), "step": _s(step_s), "high": highest}
    lowest = [_round(point.lowest) for point in points]
    if not mean and lowest != highest:
        drawn["low"] = lowest
    return drawn


def _round(value: float) -> float:
    rounded = float(f"{value:.{_DIGITS}g}")
    return int(rounded) if rounded.is_integer() else rounded


def _s(seconds: float) -> float:
    return _round_to(seconds, 2)


def _place(point: PathPoint, frame: MapFrame) -> list[float]:
    return [_s(point.t_s), *(_round_to(place, 1) for place in frame.place(point))]


def _round_to(value: float, decimals: int) -> float:
    rounded = round(value, decimals)
    return int(rounded) if rounded == int(rounded) else rounded

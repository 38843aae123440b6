# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Charts over time as SVG, in units of time and value, so that a script can show a part of one."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.bags.incident_record import IncidentMark
from smarttestudo.domain.texts import visible
from smarttestudo.report.axes import (
    DIGITS,
    area_entry,
    legend,
    number,
    percent_place,
    plot,
    tick_label,
    time_axis,
    value_axis,
)
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.run_report import coarser
from smarttestudo.report.time_chart import ChartLine, Layer, TimeChart, stacked_tops

_BOTTOM = 30.0
# Times are read in hundredths of a second.
_LINE_DIGITS, _TIME_DIGITS = 5, 9
# What a stroke on the edge of the plot, and the strip under it, take beyond it.
_ABOVE, _BELOW = 4.0, 8.0
_TICK_SPACE = 13.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """The height of a plot and what is above it, in pixels, its class, and how many times fit under it.

    The style sheet gives a class its sides, in which the labels of the values are.
    """

    css_class: str
    top: float
    height: float
    times: int

    @property
    def foot(self) -> float:
        """The place of the axis of times."""
        return self.top + self.height


SMALL = Frame(css_class="small", top=18.0, height=120.0, times=5)
STRIP = Frame(css_class="strip-chart", top=16.0, height=48.0, times=10)
WIDE = Frame(css_class="wide-chart", top=22.0, height=178.0, times=10)


def draw_chart(chart: TimeChart, frame: Frame, max_points: int) -> Markup:
    """The chart as an SVG element, in which each line has at most ``max_points``."""
    per_px = chart.top / frame.height
    inside = tag(
        "g",
        *_tints(chart, per_px),
        *_layers(chart, max_points),
        *_lines(chart, max_points),
        *incident_line(chart.incident, chart.duration_s, chart.top),
        *_stretches(chart),
        transform="scale(1 -1)",
    )
    height = frame.height + _ABOVE + _BELOW
    view = (0.0, -chart.top - _ABOVE * per_px, chart.duration_s, height * per_px)
    gap = (
        {}
        if chart.gap is None
        else {"data_heights": json.dumps([chart.heights.values, chart.heights.places])}
    )
    return time_svg(
        *_value_axis(chart, frame),
        plot(inside, view=view, y=frame.top - _ABOVE, height=height),
        *_budget(chart, frame),
        frame=frame,
        duration_s=chart.duration_s,
        meaning=chart.meaning,
        times=_stretch_labels(chart, frame.times - 1) if chart.stretches else None,
        data_unit=chart.unit,
        **gap,
    )


def incident_line(mark: IncidentMark | None, duration_s: float, height: float) -> Iterator[Markup]:
    """The moment of an incident, from the foot of a plot to ``height``, which says what it is."""
    if mark is not None:
        at = number(min(max(mark.at_s, 0.0), duration_s))
        for style, *words in (("incident-edge",), ("incident", tag("title", mark.text))):
            yield tag("line", *words, class_=style, x1=at, x2=at, y1=0.0, y2=number(height))


def time_svg(
    *content: Markup,
    frame: Frame,
    duration_s: float,
    meaning: str,
    times: Iterable[Markup] | None = None,
    **attributes: str,
) -> Markup:
    """A drawing over time that says what it shows, with the axis of ``times`` and the ground for a pointer.

    Without ``times`` they are seconds.
    """
    ground = tag("rect", class_="ground", x=0.0, y=frame.top, width="100%", height=frame.height)
    return tag(
        "svg",
        ground,
        *content,
        tag(
            "g",
            *(time_axis(duration_s, frame.times) if times is None else times),
            class_="times",
            transform=f"translate(0 {frame.foot + 22:g})",
        ),
        class_=f"over-time {frame.css_class}",
        height=frame.foot + _BOTTOM,
        role="img",
        aria_label=meaning,
        **attributes,
    )


def _stretch_labels(chart: TimeChart, most: int) -> Iterator[Markup]:
    """Labels in the middle of at most ``most`` stretches; a narrow screen leaves out every second one."""
    every = -(-len(chart.stretches) // most)
    for number_, stretch in enumerate(chart.stretches[::every]):
        middle = percent_place(number_ * every + 0.5, len(chart.stretches))
        classes = {"class_": "between"} if number_ % 2 else {}
        yield tag("text", stretch.label, x=middle, text_anchor="middle", **classes)


def _stretches(chart: TimeChart) -> Iterator[Markup]:
    """Areas that say what a stretch shows where a pointer rests on them."""
    for start, stretch in enumerate(chart.stretches):
        title = tag("title", stretch.meaning)
        yield tag(
            "rect", title, class_="stretch", x=number(start), y="0", width="1", height=number(chart.top)
        )


def _value_axis(chart: TimeChart, frame: Frame) -> Iterator[Markup]:
    """The axis of values, and the marks of a gap."""
    yield from value_axis(((tick_label(value), at) for value, at in _labelled(chart, frame)), chart.unit)
    if chart.gap is not None:
        middle = frame.foot - chart.gap / chart.top * frame.height
        for at in (middle - 2, middle + 2):
            yield tag("line", class_="gap", x1=-5.0, x2=5.0, y1=at + 2, y2=at - 2)


def _labelled(chart: TimeChart, frame: Frame) -> Iterator[tuple[float, float]]:
    """The ticks with their places, as many as there is room for; the last one in any case."""
    *others, last = ((value, _place(chart, frame, value)) for value in chart.ticks)
    before = frame.foot + _TICK_SPACE
    for value, at in others:
        if before - at >= _TICK_SPACE <= at - last[1]:
            before = at
            yield value, at
    yield last


def _place(chart: TimeChart, frame: Frame, value: float) -> float:
    return frame.foot - chart.heights(value) / chart.top * frame.height


def _tints(chart: TimeChart, per_px: float) -> Iterator[Markup]:
    """A tint behind the chart and a strip under it, in the style of the block that decided the topic."""
    top, strip = number(chart.top), number(-4 * per_px)
    for style in {span.style: None for span in chart.tints}:
        ends = [(number(span.start_s), number(span.end_s)) for span in chart.tints if span.style == style]
        tints = "".join(f"M{start} 0H{end}V{top}H{start}z" for start, end in ends)
        strips = "".join(f"M{start} {strip}H{end}" for start, end in ends)
        yield tag("path", class_=f"tint {style.css_class}", d=tints)
        yield tag("path", class_=f"strip {style.css_class}", d=strips)


def _lines(chart: TimeChart, max_points: int) -> Iterator[Markup]:
    before, after = chart.lines[:1], chart.lines[1:]
    yield from (_line(chart, line, max_points) for line in before)
    if chart.targets:
        yield _target_line(chart)
    yield from (_line(chart, line, max_points) for line in after)


def _line(chart: TimeChart, line: ChartLine, max_points: int) -> Markup:
    """A line, or the area between the least and the greatest value where a point stands for several."""
    line = ChartLine(run=line.run, points=coarser(line.points, max_points))
    there = [_point(point.t_s, chart.heights(point.highest), _LINE_DIGITS) for point in line.points]
    if not line.is_band:
        return tag("polyline", class_=line.run.value, points=" ".join(there))
    back = [_point(point.t_s, chart.heights(point.lowest), _LINE_DIGITS) for point in reversed(line.points)]
    return tag("polygon", class_=line.run.value, points=" ".join(there + back))


def _target_line(chart: TimeChart) -> Markup:
    """The planned rate in steps; a gap where it was Full."""
    steps = (
        f"M{_point(span.start_s, chart.heights(span.rate.hz))}H{number(span.end_s)}"
        for span in chart.targets
        if not span.rate.is_full
    )
    return tag("path", class_="target", d="".join(steps))


def _layers(chart: TimeChart, max_points: int) -> Iterator[Markup]:
    """From the top of the stack down, each down to the foot and covered by the next."""
    thinned = [coarser(layer.points, max_points) for layer in chart.layers]
    tops = stacked_tops(thinned)
    areas = []
    for index, (layer, points, top) in enumerate(zip(chart.layers, thinned, tops, strict=True), start=1):
        edge = [_point(point.t_s, height) for point, height in zip(points, top, strict=True)]
        foot = [_point(point.t_s, 0.0) for point in (*points[-1:], *points[:1])]
        style = f"layer share-{index}"
        areas.append(
            tag("polygon", class_=style, points=" ".join(edge + foot), data_name=visible(layer.name))
        )
    yield from reversed(areas)


def _point(t_s: float, height: float, digits: int = DIGITS) -> str:
    return f"{number(round(t_s, 2), _TIME_DIGITS)},{number(height, digits)}"


def _budget(chart: TimeChart, frame: Frame) -> Iterator[Markup]:
    if chart.budget is None:
        return
    at = _place(chart, frame, chart.budget)
    above = " (far above)" if chart.budget > chart.heights.values[-1] else ""
    text = f"budget {tick_label(chart.budget)} KB/s{above}"
    yield tag("line", class_="budget", x1=0.0, x2="100%", y1=at, y2=at)
    yield tag("text", text, class_="axis", x="100%", y=at - 5, text_anchor="end")


def layer_legend(stack: Sequence[Layer], amount: Callable[[Layer], str]) -> Markup:
    """The layers of a stacked chart from top to bottom, each with its ``amount`` in words."""
    entries = [
        area_entry(f"layer share-{index}", layer.name, amount(layer))
        for index, layer in enumerate(stack, start=1)
    ]
    return legend(*reversed(entries))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Charts over time as SVG, in units of time and value, so that a script can show a part of one."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from smarttestudo.bags.incident_mark import IncidentMark
from smarttestudo.domain.texts import visible
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.scale import label, multiples, round_step, tick_label
from smarttestudo.report.series import coarser
from smarttestudo.report.time_chart import ChartLine, TimeChart, stacked_tops

_BOTTOM = 30.0
_TIME_TOLERANCE = 1.005
# Layers are read as differences of heights, times in hundredths of a second.
_DIGITS, _LINE_DIGITS, _TIME_DIGITS, _MOST_DECIMALS = 7, 5, 9, 6
# What a stroke on the edge of the plot, and the strip under it, take beyond it.
_ABOVE, _BELOW = 4.0, 8.0


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
            *(_times(duration_s, frame.times) if times is None else times),
            class_="times",
            transform=f"translate(0 {frame.foot + 22:g})",
        ),
        class_=f"over-time {frame.css_class}",
        height=frame.foot + _BOTTOM,
        role="img",
        aria_label=meaning,
        **attributes,
    )


def plot(*content: Markup, view: tuple[float, float, float, float], y: float, height: float) -> Markup:
    """``content`` in its own units, ``view`` of which are as wide as the chart; the rest is cut off."""
    return tag(
        "svg",
        *content,
        class_="plot",
        viewBox=" ".join(map(number, view)),
        preserveAspectRatio="none",
        y=y,
        width="100%",
        height=height,
    )


def number(value: float, digits: int = _DIGITS) -> str:
    """``value`` in ``digits`` significant digits, at most six of them decimals, and no exponent."""
    if value == 0:
        return "0"
    whole = len(str(int(abs(value)))) if abs(value) >= 1 else 0
    text = f"{value:.{min(max(digits - whole, 0), _MOST_DECIMALS)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def share(part: float, whole: float) -> str:
    """``part`` in percent of ``whole``, which is a place at any width."""
    return f"{number(round(100 * part / whole, 2))}%"


def _times(duration_s: float, most: int) -> Iterator[Markup]:
    """Labels at round times; the last one has the unit."""
    times_s = multiples(round_step(duration_s / most), 0.0, duration_s * _TIME_TOLERANCE)
    for time_s in times_s:
        unit = " s" if time_s == times_s[-1] else ""
        yield tag("text", label(time_s) + unit, x=share(time_s, duration_s), text_anchor="middle")


def _stretch_labels(chart: TimeChart, most: int) -> Iterator[Markup]:
    """Labels in the middle of at most ``most`` stretches; a narrow screen leaves out every second one."""
    every = -(-len(chart.stretches) // most)
    for number_, stretch in enumerate(chart.stretches[::every]):
        middle = share(number_ * every + 0.5, len(chart.stretches))
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
    """Lines at round values, labelled to their left, the unit on top, and the marks of a gap."""
    for value in chart.ticks:
        at = _place(chart, frame, value)
        yield tag("line", class_="grid", x1=0.0, x2="100%", y1=at, y2=at)
        yield tag("text", tick_label(value), class_="tick", x=-6.0, y=at + 3.5, text_anchor="end")
    yield tag("text", chart.unit, class_="tick", x=-6.0, y=10.0, text_anchor="end")
    if chart.gap is not None:
        middle = frame.foot - chart.gap / chart.top * frame.height
        for at in (middle - 2, middle + 2):
            yield tag("line", class_="gap", x1=-5.0, x2=5.0, y1=at + 2, y2=at - 2)


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


def _point(t_s: float, height: float, digits: int = _DIGITS) -> str:
    return f"{number(round(t_s, 2), _TIME_DIGITS)},{number(height, digits)}"


def _budget(chart: TimeChart, frame: Frame) -> Iterator[Markup]:
    if chart.budget is None:
        return
    at = _place(chart, frame, chart.budget)
    above = " (far above)" if chart.budget > chart.heights.values[-1] else ""
    text = f"budget {tick_label(chart.budget)} KB/s{above}"
    yield tag("line", class_="budget", x1=0.0, x2="100%", y1=at, y2=at)
    yield tag("text", text, class_="axis", x="100%", y=at - 5, text_anchor="end")

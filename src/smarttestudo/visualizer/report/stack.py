# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which topics the bandwidth of a recording consists of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from smarttestudo.visualizer.report.run_report import RunReport, TopicSeries
from smarttestudo.visualizer.series import Series, SeriesPoint

MOST_LAYERS = 6
"""Topics that have a layer of their own; the style sheet defines one look more, for all others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """What one topic, or all others together, add to the bandwidth, in KB/s."""

    name: str
    points: Series

    @property
    def mean_kb_per_s(self) -> float:
        """The mean over the recording."""
        return fmean(point.mean for point in self.points) if self.points else 0.0


def layers(report: RunReport, *, of_second: bool) -> tuple[Layer, ...]:
    """The largest topics of one recording, and a layer for the rest, in one order for both recordings."""
    ranked = sorted(report.series, key=_size, reverse=True)
    own = [Layer(name=series.topic, points=_points(series, of_second=of_second)) for series in ranked]
    own = [layer for layer in own if layer.points]
    if len(own) <= MOST_LAYERS + 1:
        return tuple(own)
    rest = own[MOST_LAYERS:]
    others = Layer(name=f"{len(rest)} other topics", points=_sum([layer.points for layer in rest]))
    return (*own[:MOST_LAYERS], others)


def _size(series: TopicSeries) -> float:
    """The topic's mean bandwidth in both recordings together."""
    both = (series.before.kb_per_s, series.after.kb_per_s)
    return sum(fmean(point.mean for point in points) for points in both if points)


def _points(series: TopicSeries, *, of_second: bool) -> Series:
    return series.after.kb_per_s if of_second else series.before.kb_per_s


def _sum(parts: Sequence[Series]) -> Series:
    """The means added up; the least and the greatest of a sum are not known, and stand as its mean."""
    sums = []
    for points in zip(*parts, strict=True):
        mean = sum(point.mean for point in points)
        sums.append(SeriesPoint(t_s=points[0].t_s, lowest=mean, mean=mean, highest=mean))
    return tuple(sums)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's path as few lines, each decided by one block."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from smarttestudo.visualizer.floor import PathPoint
from smarttestudo.visualizer.rule_timeline import DecidingBlock, RuleSpan, block_at

MAX_POINTS = 1000
_FARTHEST_M = 1e7


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPiece:
    """A stretch of the path over which one block decided; ``None`` stands for the defaults."""

    block: DecidingBlock | None
    points: tuple[PathPoint, ...]


def known_places(path: Iterable[PathPoint]) -> list[PathPoint]:
    """``path`` without the points whose place is unknown or beyond any map."""
    return [one for one in path if abs(one.x_m) < _FARTHEST_M and abs(one.y_m) < _FARTHEST_M]


def thinned(path: Sequence[PathPoint], max_points: int = MAX_POINTS) -> list[PathPoint]:
    """``path`` with points left out that lie within a thousandth of its length of the last kept one."""
    if len(path) <= max_points:
        return list(path)
    spacing_m = sum(_distance_m(a, b) for a, b in pairwise(path)) / max_points
    kept = [path[0]]
    for point in path[1:-1]:
        if _distance_m(kept[-1], point) > spacing_m:
            kept.append(point)
    return [*kept, path[-1]]


def path_pieces(path: Sequence[PathPoint], spans: Sequence[RuleSpan]) -> Iterator[PathPiece]:
    """``path`` cut where another block begins to decide; each piece starts where the last one ended."""
    points: list[PathPoint] = []
    block: DecidingBlock | None = None
    for point in path:
        now = block_at(spans, point.t_s)
        if points and now != block:
            yield PathPiece(block=block, points=(*points, point))
            points = []
        block = now
        points.append(point)
    if points:
        yield PathPiece(block=block, points=tuple(points))


def _distance_m(a: PathPoint, b: PathPoint) -> float:
    return math.hypot(b.x_m - a.x_m, b.y_m - a.y_m)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An occupancy map as one shape."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

from smarttestudo.visualizer.floor import OccupancyMap
from smarttestudo.visualizer.report.map_frame import MapFrame
from smarttestudo.visualizer.report.markup import Markup, coordinate, tag

MOST_STRIPS = 5000


def occupied_cells(occupancy: OccupancyMap, frame: MapFrame) -> Markup:
    """The occupied cells as a path of strips; neighbouring cells are joined until it is short enough."""
    joined = 1
    while len(strips := list(_strips(_coarser(occupancy.rows, joined)))) > MOST_STRIPS:
        joined *= 2
    outline = "".join(f"M{start} {row}h{length}v1h-{length}z" for row, start, length in strips)
    return tag("path", class_="occupied", d=outline, transform=_from_cells(occupancy, joined, frame))


def _from_cells(occupancy: OccupancyMap, joined: int, frame: MapFrame) -> str:
    """From cells, counted from the lower left, to places on the map."""
    per_m = frame.per_m
    left, bottom = frame.x(occupancy.origin_x_m), frame.y(occupancy.origin_y_m)
    cell = occupancy.cell_m * joined * per_m
    turn = -math.degrees(occupancy.yaw_rad)
    return (
        f"translate({coordinate(left)} {coordinate(bottom)}) rotate({turn:.3f}) scale({cell:.4f} {-cell:.4f})"
    )


def _coarser(rows: Sequence[Sequence[bool]], joined: int) -> list[list[bool]]:
    """Squares of ``joined`` cells as one, occupied if any of them is."""
    if joined == 1:
        return [list(row) for row in rows]
    return [
        [
            any(any(row[left : left + joined]) for row in rows[top : top + joined])
            for left in range(0, len(rows[top]), joined)
        ]
        for top in range(0, len(rows), joined)
    ]


def _strips(rows: Sequence[Sequence[bool]]) -> Iterator[tuple[int, int, int]]:
    """Row, start and length of each run of occupied cells."""
    for number, row in enumerate(rows):
        start = 0
        for is_occupied, run in groupby(row):
            length = sum(1 for _ in run)
            if is_occupied:
                yield number, start, length
            start += length

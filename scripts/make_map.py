# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Write examples/warehouse_map.yaml and its image: the demo's warehouse as a map of nav2."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.simulation.warehouse import warehouse, warehouse_bounds

MAP = Path(__file__).resolve().parent.parent / "examples" / "warehouse_map.yaml"
CELL_M = 0.05
MARGIN_M = 0.5
FREE, UNKNOWN, OCCUPIED = 254, 205, 0


def header() -> str:
    """The YAML file of the map."""
    bounds = warehouse_bounds()
    return (
        "# Written by scripts/make_map.py; change src/smarttestudo/simulation/warehouse.py instead.\n"
        f"image: {MAP.with_suffix('.png').name}\n"
        f"resolution: {CELL_M}\n"
        f"origin: [{bounds.min_x_m - MARGIN_M}, {bounds.min_y_m - MARGIN_M}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )


def picture(plan: FloorPlan) -> Image.Image:
    """The cells of the map of ``plan``: obstacles are occupied, what lies outside the walls is unknown."""
    bounds = warehouse_bounds()
    left_m, low_m = bounds.min_x_m - MARGIN_M, bounds.min_y_m - MARGIN_M
    width = round((bounds.max_x_m + MARGIN_M - left_m) / CELL_M)
    height = round((bounds.max_y_m + MARGIN_M - low_m) / CELL_M)
    cells = np.full((height, width), UNKNOWN, np.uint8)
    marks = [(bounds, FREE), *((one.footprint, OCCUPIED) for one in plan.obstacles)]
    for area, value in marks:
        columns = slice(round((area.min_x_m - left_m) / CELL_M), round((area.max_x_m - left_m) / CELL_M))
        rows = slice(round((area.min_y_m - low_m) / CELL_M), round((area.max_y_m - low_m) / CELL_M))
        cells[rows, columns] = value
    # Rows of an image run downwards, those of a map upwards.
    return Image.fromarray(cells[::-1])


if __name__ == "__main__":
    MAP.write_text(header(), encoding="utf-8")
    picture(warehouse()).save(MAP.with_suffix(".png"), optimize=True)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zones: the rectangles of the floor that conditions on ``pose_x`` and ``pose_y`` mean."""

from smarttestudo.editing.zones.cover import Cover, PolygonError, covering_rectangles
from smarttestudo.editing.zones.zone import (
    Zone,
    ZoneReading,
    ZoneRectangle,
    axis_of,
    moved_zone,
    resized_zone,
    with_zone,
    zone_condition,
    zones_in,
)

__all__ = [
    "Cover",
    "PolygonError",
    "Zone",
    "ZoneReading",
    "ZoneRectangle",
    "axis_of",
    "covering_rectangles",
    "moved_zone",
    "resized_zone",
    "with_zone",
    "zone_condition",
    "zones_in",
]

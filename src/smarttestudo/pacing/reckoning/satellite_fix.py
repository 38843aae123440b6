# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Places that satellites say, and how many metres they are apart.

A place in degrees becomes one in metres as of WGS 84: X = (N + h) cos φ cos λ, Y = (N + h) cos φ sin λ,
Z = (N (1 − e²) + h) sin φ with N = a / √(1 − e² sin² φ) (NIMA TR8350.2, "Department of Defense World Geodetic
System 1984", 3rd ed., 4.3). The tangent plane at a place is these axes turned, so lengths are the same in
it, also at the poles and where longitudes begin anew.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from contextlib import suppress
from typing import NamedTuple

from smarttestudo.pacing.cdr import header_stamp_ns
from smarttestudo.pacing.cdr_walk import CdrWalk, byte_order
from smarttestudo.pacing.reckoning.gauges import Distance, MovingPart, Reading

_EQUATOR_M = 6_378_137.0
_FLATTENING = 1 / 298.257223563
_SQUARED_ECCENTRICITY = _FLATTENING * (2 - _FLATTENING)
_NO_FIX = -1


class Place(NamedTuple):
    """Where a receiver is; NaN stands for what it does not know, which is all of it without a fix."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float


_NOWHERE = Place(math.nan, math.nan, math.nan)


def places_distance_m(one: Place, other: Place) -> float:
    """The length of the way between two places; at the ellipsoid where the altitude of one is not known.

    NaN where one is nowhere.
    """
    if not (_is_on_earth(one) and _is_on_earth(other)):
        return math.nan
    has_altitudes = math.isfinite(one.altitude_m) and math.isfinite(other.altitude_m)
    return math.dist(_axes_m(one, has_altitude=has_altitudes), _axes_m(other, has_altitude=has_altitudes))


def _is_on_earth(place: Place) -> bool:
    return abs(place.latitude_deg) <= 90 and math.isfinite(place.longitude_deg)


def _axes_m(place: Place, *, has_altitude: bool) -> tuple[float, float, float]:
    latitude, longitude = math.radians(place.latitude_deg), math.radians(place.longitude_deg)
    height_m = place.altitude_m if has_altitude else 0.0
    normal_m = _EQUATOR_M / math.sqrt(1 - _SQUARED_ECCENTRICITY * math.sin(latitude) ** 2)
    from_axis_m = (normal_m + height_m) * math.cos(latitude)
    return (
        from_axis_m * math.cos(longitude),
        from_axis_m * math.sin(longitude),
        (normal_m * (1 - _SQUARED_ECCENTRICITY) + height_m) * math.sin(latitude),
    )


PLACE_DISTANCE = Distance(places_distance_m, _is_on_earth)


class FixGauge:
    """NavSatFix, which stays where it is."""

    is_shared = False
    needs_every_message = False

    def __init__(self, distances: Mapping[str, Distance]) -> None:
        self.distances = distances

    def read(self, payload: bytes, _message: object | None, now_ns: int) -> Reading | None:
        """The one part of the message, at its header's stamp, or at ``now_ns`` where that is not set."""
        place = _place(payload)
        if place is None:
            return None
        stamp_ns = header_stamp_ns(payload)
        return (MovingPart("", stamp_ns or now_ns, None, place, stamp_ns is not None),)

    def motion(self, _before: MovingPart | None, _part: MovingPart) -> None:
        """None is known."""

    def after(self, state: Place, _motion: None, _elapsed_s: float) -> Place:
        """The same."""
        return state

    def written(self, _payload: bytes, _parts: Reading, _within: Mapping[str, float]) -> bytes | None:
        """None, as nothing moves."""
        return None


def _place(payload: bytes) -> Place | None:
    order = byte_order(payload)
    if order is None:
        return None
    with suppress(struct.error):
        walk = CdrWalk(payload, order)
        walk.header()
        (status,) = struct.unpack_from(f"{order}b", payload, walk.skip(1, 1))
        walk.skip(2, 2)
        place = Place(*struct.unpack_from(f"{order}3d", payload, walk.skip(24, 8)))
        return _NOWHERE if status == _NO_FIX else place
    return None

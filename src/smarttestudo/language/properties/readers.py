# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of messages: poses, velocities, scans and batteries, and how a sensor says that it does not know."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Protocol, TypeVar

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties.field_path import MESSAGE_PREFIX, Reader, field_reader, number


class VectorMessage(Protocol):
    """A geometry_msgs Vector3 or Point."""

    x: float
    y: float
    z: float


class QuaternionMessage(VectorMessage, Protocol):
    """A geometry_msgs QuaternionMessage."""

    w: float


def length(vector: VectorMessage) -> float:
    """The Euclidean length."""
    x, y, z = number(vector.x), number(vector.y), number(vector.z)
    return math.sqrt(x * x + y * y + z * z)


def roll_degrees(q: QuaternionMessage) -> float:
    """Rotation about x of the intrinsic z-y-x angles, in (−180, 180]; NaN for the zero quaternion."""
    x, y, z, w = _numbers(q)
    return _degrees(2 * (w * x + y * z), w * w - x * x - y * y + z * z)


def pitch_degrees(q: QuaternionMessage) -> float:
    """Rotation about y, in [−90, 90]; NaN for the zero quaternion."""
    x, y, z, w = _numbers(q)
    sine = 2 * (w * y - z * x) / (w * w + x * x + y * y + z * z)
    # In this order NaN stays.
    return math.degrees(math.asin(max(min(sine, 1.0), -1.0)))


def yaw_degrees(q: QuaternionMessage) -> float:
    """Rotation about z, in (−180, 180]; NaN for the zero quaternion."""
    x, y, z, w = _numbers(q)
    return _degrees(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def _degrees(sine: float, cosine: float) -> float:
    degrees = math.degrees(math.atan2(sine, cosine))
    return 180.0 if degrees <= -180.0 else degrees


def _numbers(q: QuaternionMessage) -> tuple[float, float, float, float]:
    """The four numbers, all NaN for a quaternion of zeros or of numbers too large to be squared."""
    x, y, z, w = number(q.x), number(q.y), number(q.z), number(q.w)
    is_one = 0 < w * w + x * x + y * y + z * z < math.inf
    return (x, y, z, w) if is_one else (math.nan,) * 4


def greatest_magnitude(field: str) -> Reader:
    """Read the greatest absolute value of the array ``field``; NaN entries are skipped."""

    def read(message: object) -> float:
        values: Iterable[float] = getattr(message, field, ())
        return max((abs(float(value)) for value in values if not math.isnan(value)), default=math.nan)

    return read


class ScanMessage(Protocol):
    """A sensor_msgs LaserScan."""

    range_min: float
    range_max: float
    ranges: Iterable[float]


class Battery(Protocol):
    """A sensor_msgs BatteryState."""

    percentage: float


def nearest_distance_m(scan: ScanMessage) -> float:
    """The smallest range in m.

    −inf (too near, REP 117) counts as range_min, +inf (nothing there) as range_max; NaN, 0 and values
    out of range are skipped; NaN when nothing is left, or the scan has no range.
    """
    low, high = number(scan.range_min), number(scan.range_max)
    if not high > 0:
        return math.nan
    values = _plain(scan.ranges)
    kept = [value for value in values if value and low <= value <= high]
    kept += [limit for limit, infinite in ((low, -math.inf), (high, math.inf)) if infinite in values]
    return min(kept, default=math.nan)


def _plain(values: Iterable[float]) -> list[float]:
    """Python floats, which are much faster to compare one by one than an array's own."""
    to_list = getattr(values, "tolist", None)
    return to_list() if to_list else list(values)


class BatteryLevel:
    """Reads the battery level in percent.

    ``percentage`` is 0…1 by its definition, yet some robots (TurtleBot3) publish 0…100: once a value above 1
    was seen, this topic is in percent for good. ``unit`` settles it beforehand.
    """

    def __init__(self, unit: LevelUnit | None) -> None:
        self._unit = unit

    def __call__(self, message: Battery) -> float:
        """Percent, NaN where the robot does not know."""
        value = number(message.percentage)
        if self._unit is None and 1 < value < math.inf:
            self._unit = LevelUnit.PERCENT
        return value if self._unit is LevelUnit.PERCENT else value * 100


_Habit = Callable[[object], bool]
_T = TypeVar("_T")


def known_only(type_name: str, path: str, read: Callable[[object], _T]) -> Callable[[object], _T | float]:
    """``read``, the reader of the field at ``path``, but NaN where the message says that it is not known.

    That is said by the habits of each type: drivers that do not measure the charge of a battery say -1, a
    covariance that begins with -1 stands for no estimate, a negative status for no fix. Ranges beyond the
    limits that the message states are to be discarded; infinite ones are not (REP 117).
    """
    path = path.removeprefix(MESSAGE_PREFIX)
    habit = _HABITS.get((type_name, path.partition(".")[0].partition("[")[0]))
    if habit is None:
        return read
    is_unknown = habit(path)
    return lambda message: math.nan if is_unknown(message) else read(message)


def _negative(path: str) -> _Habit:
    read = field_reader(path)
    return lambda message: read(message) < 0


def _beyond(low: str, high: str) -> Callable[[str], _Habit]:
    read_low, read_high = field_reader(low), field_reader(high)

    def habit(path: str) -> _Habit:
        read = field_reader(path)

        def is_beyond(message: object) -> bool:
            value, low_m, high_m = read(message), read_low(message), read_high(message)
            return not high_m > 0 or (math.isfinite(value) and not low_m <= value <= high_m)

        return is_beyond

    return habit


def _said_by(path: str) -> Callable[[str], _Habit]:
    is_unknown = _negative(path)
    return lambda _: is_unknown


_IMU, _FIX = "sensor_msgs/msg/Imu", "sensor_msgs/msg/NavSatFix"
_HABITS: Mapping[tuple[str, str], Callable[[str], _Habit]] = MappingProxyType(
    {
        ("sensor_msgs/msg/BatteryState", "percentage"): _negative,
        ("sensor_msgs/msg/LaserScan", "ranges"): _beyond("range_min", "range_max"),
        ("sensor_msgs/msg/Range", "range"): _beyond("min_range", "max_range"),
        **{
            (_IMU, field): _said_by(f"{field}_covariance[0]")
            for field in ("orientation", "angular_velocity", "linear_acceleration")
        },
        **{(_FIX, field): _said_by("status.status") for field in ("latitude", "longitude", "altitude")},
    }
)

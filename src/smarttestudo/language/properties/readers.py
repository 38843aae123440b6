# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of messages: poses, velocities, scans and batteries, and how a sensor says that it does not know."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Protocol, TypeVar

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.units import NS_PER_S
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


class GoalMessage(Protocol):
    """An action_msgs GoalStatusArray."""

    status_list: Sequence[Any]


_ENDED = frozenset({4, 5, 6})
"""STATUS_SUCCEEDED, STATUS_CANCELED and STATUS_ABORTED."""


class LatestGoal:
    """Reads the status of the goal of an action that was accepted last.

    Goals that had ended in the first message are not looked at: they are of before. A goal that a newer one
    replaced is not looked at any more, whatever becomes of it.
    """

    def __init__(self) -> None:
        self._ended_before: frozenset[bytes] | None = None
        self._accepted_ns = 0
        self._status = math.nan

    def __call__(self, message: GoalMessage) -> float:
        """The status, NaN before there is such a goal."""
        goals = [
            (bytes(one.goal_info.goal_id.uuid), _stamp_ns(one.goal_info.stamp), number(one.status))
            for one in message.status_list
        ]
        if self._ended_before is None:
            self._ended_before = frozenset(goal_id for goal_id, _, status in goals if status in _ENDED)
        for goal_id, accepted_ns, status in goals:
            if goal_id not in self._ended_before and accepted_ns >= self._accepted_ns:
                self._accepted_ns, self._status = accepted_ns, status
        return self._status


def _stamp_ns(stamp: Any) -> int:
    return int(stamp.sec) * NS_PER_S + int(stamp.nanosec)


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


def known_elements(type_name: str, path: str) -> Callable[[object], Callable[[Any], bool]] | None:
    """Tell which values of all elements, ``path`` with ``[*]``, a message says to be known.

    ``None``: all are.
    """
    limits = _LIMITS.get((type_name, path.removeprefix(MESSAGE_PREFIX).partition("[")[0]))
    if limits is None:
        return None
    read_low, read_high = map(field_reader, limits)

    def known(message: object) -> Callable[[Any], bool]:
        low, high = read_low(message), read_high(message)
        return lambda value: high > 0 and (math.isinf(value) or low <= value <= high)

    return known


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


_LIMITS: Mapping[tuple[str, str], tuple[str, str]] = MappingProxyType(
    {
        ("sensor_msgs/msg/LaserScan", "ranges"): ("range_min", "range_max"),
        ("sensor_msgs/msg/Range", "range"): ("min_range", "max_range"),
    }
)
_IMU, _FIX = "sensor_msgs/msg/Imu", "sensor_msgs/msg/NavSatFix"
_HABITS: Mapping[tuple[str, str], Callable[[str], _Habit]] = MappingProxyType(
    {
        ("sensor_msgs/msg/BatteryState", "percentage"): _negative,
        **{field: _beyond(*limits) for field, limits in _LIMITS.items()},
        **{
            (_IMU, field): _said_by(f"{field}_covariance[0]")
            for field in ("orientation", "angular_velocity", "linear_acceleration")
        },
        **{(_FIX, field): _said_by("status.status") for field in ("latitude", "longitude", "altitude")},
    }
)

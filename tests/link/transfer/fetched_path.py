# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How far the path that an operator is shown of a gap is from the robot's, whatever came of it so far."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass

from link.protocol.simulated_link import S
from link.transfer.simulated_fetch import Contents
from smarttestudo.accuracy.reconstruction import field_error
from smarttestudo.accuracy.samples import Series
from smarttestudo.link.transfer.order import MessageRange


def path(stamp_ns: int) -> tuple[float, float]:
    """A robot that drives curves through a hall, waits and goes on."""
    t = stamp_ns / S
    driven = t - 3 * math.sin(t / 6)
    return 8 * math.cos(driven / 7), 5 * math.sin(driven / 5)


def rmse_m(messages: Sequence[MessageRange], there: Sequence[MessageRange]) -> float:
    """How far the path shown is from the robot's; the last position before the gap was known."""
    known = sorted({0, *(one.stamp_ns for one in there)})
    stamps = sorted(one.stamp_ns for one in messages)
    squares = 0.0
    for axis in (0, 1):
        truth, shown = (
            Series(stamps_ns=array("q", some), values=array("d", [path(stamp)[axis] for stamp in some]))
            for some in (stamps, known)
        )
        error = field_error(truth, shown, stamps[-1])
        assert error is not None
        squares += error.hold.rmse**2
    return math.sqrt(squares)


def first_of(messages: Sequence[MessageRange], size_bytes: int) -> list[MessageRange]:
    """Those that are whole after so many bytes."""
    there = []
    for one in messages:
        size_bytes -= one.size_bytes
        if size_bytes < 0:
            break
        there.append(one)
    return there


@dataclass(frozen=True, kw_only=True)
class PathErrors:
    """RMSE in m of the path of a gap by hold, by the order in which its bytes come."""

    nothing_m: float
    coarse_first_m: float
    in_order_m: float
    newest_first_m: float


def path_errors(contents: Contents, share: float) -> PathErrors:
    """After that share of all bytes."""
    size_bytes = int(contents.order.size_bytes * share)
    odometry = [one for one in contents.messages if one.topic == "/odom"]
    sizes = {one.offset: one.size_bytes for one in contents.messages}
    stretches = [one for one in contents.order.stretches(0, size_bytes) if not isinstance(one, bytes)]
    whole = {one.offset for one in stretches if one.size_bytes == sizes.get(one.offset)}
    in_order = first_of(contents.messages, size_bytes)
    newest_first = first_of(contents.messages[::-1], size_bytes)
    return PathErrors(
        nothing_m=rmse_m(odometry, []),
        coarse_first_m=rmse_m(odometry, [one for one in odometry if one.offset in whole]),
        in_order_m=rmse_m(odometry, [one for one in in_order if one.topic == "/odom"]),
        newest_first_m=rmse_m(odometry, [one for one in newest_first if one.topic == "/odom"]),
    )

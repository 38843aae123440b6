# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Units used everywhere: nanoseconds for stamps, hertz for rates, KB of 1000 bytes; and their texts."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

NS_PER_S = 1_000_000_000
NS_PER_MS = 1_000_000
S_PER_HOUR = 3600
BYTES_PER_KB = 1000
BITS_PER_BYTE = 8
BYTES_PER_MB = 1_000_000
BYTES_PER_GB = 1_000_000_000

LAST_STAMP_NS = 2**63 - 1
"""The latest time that ROS and recordings can represent, in the year 2262."""
FIRST_STAMP_NS = -(2**63)
"""The earliest one, before 1970."""


def ns_from_s(seconds: float) -> int:
    """Nanoseconds nearest to ``seconds``; longer than there are stamps is as long as there are."""
    return round(min(max(seconds * NS_PER_S, -LAST_STAMP_NS), LAST_STAMP_NS))


_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


def utc_time(stamp_ns: int) -> str:
    """``stamp_ns`` as date and time to the millisecond below; in seconds where the calendar ends."""
    try:
        time = _EPOCH + timedelta(microseconds=stamp_ns // 1000)
    except OverflowError:
        return f"{stamp_ns / 1e9:.3f} s"
    return f"{time:%Y-%m-%d %H:%M:%S}.{time.microsecond // 1000:03} UTC"


def grouped(number: float, decimals: int = 0) -> str:
    """``1 234 567.80``: thousands apart by spaces, because a comma stands before decimals to many readers."""
    return f"{number:,.{decimals}f}".replace(",", " ")


_UNITS_S = (("s", 1), ("min", 60), ("h", S_PER_HOUR), ("days", 86_400))


def duration_text(seconds: float) -> str:
    """A duration in its largest unit of which there are at least two: ``582 s`` is ``9 min``."""
    unit, unit_s = next(one for one in reversed(_UNITS_S) if seconds >= 2 * one[1] or one[1] == 1)
    return f"{int(seconds // unit_s)} {unit}"


def counted(count: int, noun: str) -> str:
    """``count`` with ``noun``, which takes an s where it is not one."""
    return f"{grouped(count)} {noun}" if count == 1 else f"{grouped(count)} {noun}s"

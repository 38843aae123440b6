# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Stamps as people write them."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


def utc_time(stamp_ns: int) -> str:
    """``stamp_ns`` as date and time to the millisecond below; in seconds where the calendar ends."""
    try:
        time = _EPOCH + timedelta(microseconds=stamp_ns // 1000)
    except OverflowError:
        return f"{stamp_ns / 1e9:.3f} s"
    return f"{time:%Y-%m-%d %H:%M:%S}.{time.microsecond // 1000:03} UTC"

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Signals with known answers, and what is received of them."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Sequence
from functools import cache

from hypothesis import strategies as st

from smarttestudo.accuracy.samples import Series
from smarttestudo.domain.units import NS_PER_S


def series(stamps_ns: Sequence[int], values: Sequence[float], *, wraps: bool = False) -> Series:
    return Series(stamps_ns=array("q", stamps_ns), values=array("d", values), wraps=wraps)


def sampled(signal: Callable[[float], float], *, hz: int, seconds: int, wraps: bool = False) -> Series:
    """``signal`` of time in s; the last sample is at ``seconds``."""
    numbers = range(hz * seconds + 1)
    return series([n * NS_PER_S // hz for n in numbers], [signal(n / hz) for n in numbers], wraps=wraps)


def every(count: int, sent: Series) -> Series:
    """What is received of ``sent`` if one message of ``count`` passes."""
    return series(sent.stamps_ns[::count], sent.values[::count], wraps=sent.wraps)


def sine(hz: float, amplitude: float = 1.0) -> Callable[[float], float]:
    return lambda t_s: amplitude * math.sin(math.tau * hz * t_s + 0.3)


def held_sine_rmse(step: float, count: int) -> float:
    """Of sin with ``step`` rad from sample to sample, one of ``count`` received, over whole turns.

    The mean of (sin(x + jd) − sin x)² over all x is 1 − cos jd.
    """
    return math.sqrt(sum(1 - math.cos(j * step) for j in range(count)) / count)


def line_sine_rmse(step: float, count: int) -> float:
    """The same for lines between those received: the mean is half the squared modulus of the phasors' gap."""
    gaps = (
        abs(
            complex(math.cos(j * step), math.sin(j * step))
            - (1 - j / count)
            - j / count * complex(math.cos(count * step), math.sin(count * step))
        )
        for j in range(count)
    )
    return math.sqrt(sum(gap * gap / 2 for gap in gaps) / count)


NUMBERS = st.integers(-1000, 1000).map(float)


@cache
@st.composite
def sent_series(draw: st.DrawFn, *, wraps: bool = False, known_only: bool = True) -> Series:
    """Up to 15 samples within 60 ns, so that a second opinion may look at every ns."""
    stamps_ns = sorted(draw(st.lists(st.integers(0, 60), min_size=1, max_size=15)))
    numbers = st.integers(-179, 180).map(float) if wraps else NUMBERS
    values = numbers if known_only else st.one_of(numbers, st.just(math.nan))
    return series(stamps_ns, [draw(values) for _ in stamps_ns], wraps=wraps)


@cache
@st.composite
def sent_and_received(draw: st.DrawFn, *, wraps: bool = False) -> tuple[Series, Series]:
    """A series with samples of different stamps, and some of its samples, the first always."""
    sent = draw(sent_series(wraps=wraps))
    by_stamp = dict(zip(sent.stamps_ns, sent.values, strict=True))
    sent = series(list(by_stamp), list(by_stamp.values()), wraps=wraps)
    kept = [True, *(draw(st.booleans()) for _ in range(len(by_stamp) - 1))]
    stamps_ns = [stamp for stamp, keep in zip(by_stamp, kept, strict=True) if keep]
    return sent, series(stamps_ns, [by_stamp[stamp] for stamp in stamps_ns], wraps=wraps)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recorded topic at a fixed rate, thinned by the pacer that relays use."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import cast

from smarttestudo.pacing.sample import Pass, Sample, StreamKind
from smarttestudo.pacing.topic_pacer import TopicPacer


@dataclass(frozen=True, slots=True, kw_only=True)
class Thinned:
    """Messages that passed: when, and the index of each among those of the source."""

    stamps_ns: array[int]
    indices: array[int]


def thinned(
    stamps_ns: Sequence[int],
    rate_hz: float,
    *,
    end_ns: int,
    kind: StreamKind,
    frames: Sequence[tuple[str, ...]] = (),
) -> Thinned:
    """Thin the messages at ``stamps_ns`` until ``end_ns`` to ``rate_hz``, infinite for all.

    ``frames`` are those of each message of a TFMessage topic.
    """
    passed = Thinned(stamps_ns=array("q"), indices=array("q"))
    if math.isinf(rate_hz):
        passed.stamps_ns.extend(stamps_ns)
        passed.indices.extend(range(len(stamps_ns)))
    elif stamps_ns:
        pacer = TopicPacer(kind=kind)
        pacer.set_rate(rate_hz, stamps_ns[0])
        _pace(pacer, stamps_ns, frames, passed)
        pacer.finish()
        _wake_until(pacer, end_ns, passed)
    return passed


@dataclass(slots=True, kw_only=True, eq=False)
class _Numbered(Sample):
    """The message of that index, without its bytes."""

    index: int


def _pace(
    pacer: TopicPacer, stamps_ns: Sequence[int], frames: Sequence[tuple[str, ...]], passed: Thinned
) -> None:
    for index, stamp_ns in enumerate(stamps_ns):
        _wake_until(pacer, stamp_ns, passed)
        sample = _Numbered(payload=b"", size_bytes=0, index=index)
        if frames:
            sample.frames = frames[index]
        _record(pacer.offer(sample, stamp_ns), stamp_ns, passed)


def _wake_until(pacer: TopicPacer, stamp_ns: int, passed: Thinned) -> None:
    for wake_ns, passes in pacer.wake_until(stamp_ns):
        _record(passes, wake_ns, passed)


def _record(passes: Iterable[Pass], now_ns: int, passed: Thinned) -> None:
    for sample, _ in passes:
        passed.stamps_ns.append(now_ns)
        passed.indices.append(cast("_Numbered", sample).index)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of one topic: kept for pictures of them, and thinned to a fixed rate."""

from __future__ import annotations

import math
from array import array
from collections.abc import Collection, Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from typing import NamedTuple, cast

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties import gauges_for, needs_decoded
from smarttestudo.pacing.reckoning.gauges import Gauge, Reading
from smarttestudo.pacing.sample import Pass, Sample, StreamKind
from smarttestudo.pacing.topic_pacer import TopicPacer

Readings = tuple[Reading | None, ...]


class Message(NamedTuple):
    """A message for a picture: when it came, and what was read of it, for each gauge of the picture.

    ``digest`` is the same for the same serialized message; ``frames`` are the streams that it names.
    """

    stamp_ns: int
    readings: Readings
    digest: int = 0
    frames: tuple[str, ...] = ()


class Track:
    """Messages of one topic, added one by one, for pictures of ``properties``.

    Kept is the serialized message, which is small where it can be read without decoding; else its readings.
    """

    __slots__ = ("_gauges", "_is_standard", "_level_unit", "_type_name", "is_used", "kept", "needs_decoded")

    def __init__(
        self,
        type_name: str,
        properties: Collection[str],
        level_unit: LevelUnit | None,
        *,
        is_standard: bool = True,
    ) -> None:
        self._type_name, self._level_unit, self._is_standard = type_name, level_unit, is_standard
        self._gauges = self.gauges(properties)
        self.is_used = bool(self._gauges)
        self.needs_decoded = needs_decoded(self._gauges)
        self.kept: list[tuple[int, bytes | Readings, int, tuple[str, ...]]] = []

    def __len__(self) -> int:
        """How many messages there are."""
        return len(self.kept)

    def gauges(self, properties: Iterable[str]) -> tuple[Gauge, ...]:
        """The gauges of a picture of these of its properties."""
        return gauges_for(self._type_name, properties, self._level_unit, is_standard=self._is_standard)

    def add(
        self, stamp_ns: int, payload: bytes, message: object | None = None, frames: tuple[str, ...] = ()
    ) -> None:
        """Keep a message; ``message`` is the decoded one where that is needed and possible."""
        kept = self._read(payload, message, stamp_ns) if self.needs_decoded else payload
        self.kept.append((stamp_ns, kept, hash(payload), frames))

    def thinned(self, passed: Thinned) -> Track:
        """The messages that ``passed``."""
        track = copy(self)
        if self.is_used:
            pairs = zip(passed.stamps_ns, passed.indices, strict=True)
            track.kept = [(stamp_ns, *self.kept[index][1:]) for stamp_ns, index in pairs]
        return track

    def messages(self, properties: Collection[str]) -> Iterator[Message]:
        """All messages, for a picture of ``properties``."""
        chosen = [
            number
            for number, gauge in enumerate(self._gauges)
            if not gauge.distances.keys().isdisjoint(properties)
        ]
        for stamp_ns, kept, digest, frames in self.kept:
            readings = kept if isinstance(kept, tuple) else self._read(kept, None, stamp_ns)
            yield Message(stamp_ns, tuple(readings[number] for number in chosen), digest, frames)

    def _read(self, payload: bytes, message: object | None, now_ns: int) -> Readings:
        return tuple(gauge.read(payload, message, now_ns) for gauge in self._gauges)


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

    ``frames`` are the streams that each message names, if it names any.
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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of one topic, kept for pictures of them."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

from smarttestudo.accuracy.thinning import Thinned
from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties import gauges_for, needs_decoded
from smarttestudo.pacing.reckoning.gauges import Gauge, Reading

Readings = tuple[Reading | None, ...]


class Message(NamedTuple):
    """A message for a picture: when it came, and what was read of it, for each gauge of the picture.

    ``digest`` is the same for the same serialized message; ``frames`` are those of a TFMessage.
    """

    stamp_ns: int
    readings: Readings
    digest: int = 0
    frames: tuple[str, ...] = ()


class Track:
    """Messages of one topic, added one by one, for pictures of ``properties``.

    Kept is the serialized message, which is small where it can be read without decoding; else its readings.
    """

    __slots__ = (
        "_digests",
        "_frames",
        "_gauges",
        "_kept",
        "_level_unit",
        "_stamps_ns",
        "_type_name",
        "is_used",
        "needs_decoded",
    )

    def __init__(self, type_name: str, properties: Collection[str], level_unit: LevelUnit | None) -> None:
        self._type_name, self._level_unit = type_name, level_unit
        self._gauges = gauges_for(type_name, properties, level_unit)
        self.is_used = bool(self._gauges)
        self.needs_decoded = needs_decoded(self._gauges)
        self._stamps_ns = array("q")
        self._digests = array("q")
        self._kept: list[bytes | Readings] = []
        self._frames: list[tuple[str, ...]] = []

    def __len__(self) -> int:
        """How many messages there are."""
        return len(self._kept)

    def add(
        self, stamp_ns: int, payload: bytes, message: object | None = None, frames: tuple[str, ...] = ()
    ) -> None:
        """Keep a message; ``message`` is the decoded one where that is needed and possible."""
        self._stamps_ns.append(stamp_ns)
        self._digests.append(hash(payload))
        self._kept.append(self._read(payload, message, stamp_ns) if self.needs_decoded else payload)
        self._frames.append(frames)

    def gauges(self, properties: Iterable[str]) -> tuple[Gauge, ...]:
        """The gauges of a picture of these of its properties."""
        return gauges_for(self._type_name, properties, self._level_unit)

    def messages(self, properties: Collection[str], passed: Thinned | None = None) -> Iterator[Message]:
        """All messages, or those that ``passed``, for a picture of ``properties``."""
        chosen = [
            number
            for number, gauge in enumerate(self._gauges)
            if not gauge.distances.keys().isdisjoint(properties)
        ]
        stamps_ns = self._stamps_ns if passed is None else passed.stamps_ns
        indices = range(len(self)) if passed is None else passed.indices
        for stamp_ns, index in zip(stamps_ns, indices, strict=True):
            kept = self._kept[index]
            readings = kept if isinstance(kept, tuple) else self._read(kept, None, stamp_ns)
            if len(chosen) < len(readings):
                readings = tuple(readings[number] for number in chosen)
            yield Message(stamp_ns, readings, self._digests[index], self._frames[index])

    def _read(self, payload: bytes, message: object | None, now_ns: int) -> Readings:
        return tuple(gauge.read(payload, message, now_ns) for gauge in self._gauges)

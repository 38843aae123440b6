# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rates that accuracies need, measured by pacing the messages of a topic to each of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from smarttestudo.domain.profile import AccuracyTiers, LevelledProperty
from smarttestudo.language.properties import gauges_for, properties_for_bounds
from smarttestudo.pacing.bound import HEARTBEAT_HZ
from smarttestudo.pacing.cdr import StreamReader
from smarttestudo.pacing.reckoning.picture import Picture
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.topic_pacer import Accuracy, TopicPacer

PROPOSED_BOUNDS: Mapping[LevelledProperty, tuple[float, ...]] = MappingProxyType(
    {
        LevelledProperty.POSITION: (0.5, 0.2, 0.1, 0.05, 0.02, 0.01),
        LevelledProperty.ORIENTATION: (20.0, 10.0, 5.0, 3.0, 2.0, 1.0),
        LevelledProperty.POSITIONS: (0.2, 0.1, 0.05, 0.03, 0.02, 0.01),
    }
)
"""α0 … α5 in m, degrees and rad: a first guess that only an engineer can replace by a better one."""


def levelled_properties(type_name: str) -> tuple[LevelledProperty, ...]:
    """The levelled properties of messages of ``type_name``."""
    names = {spec.name for spec in properties_for_bounds().get(type_name, ())}
    return tuple(one for one in LevelledProperty if one.value in names)


def bounds_need_hz(passed: Sequence[int], messages: int, source_hz: float) -> tuple[float, ...]:
    """The share of a source of ``source_hz`` that bounds need, the widest first: ``passed`` of ``messages``.

    A wider bound than another one may need a message more by chance: it counts as the tighter one does.
    """
    counts = list(itertools.accumulate(reversed(passed), min))
    return tuple(source_hz * count / messages for count in reversed(counts))


class AccuracyMeasure:
    """How many messages of one topic pass at each accuracy: with hold, the heartbeat, and no ceiling.

    Memory does not depend on how many messages there are.
    """

    __slots__ = ("_gauged", "_reader", "messages")

    def __init__(self, type_name: str, known: Mapping[LevelledProperty, AccuracyTiers]) -> None:
        """``known`` are accuracies that the engineer chose; others are proposed."""
        self.messages = 0
        self._reader = StreamReader(type_name)
        self._gauged = [
            _Gauged(type_name, one, known[one].bounds if one in known else PROPOSED_BOUNDS[one])
            for one in levelled_properties(type_name)
        ]

    def record(self, stamp_ns: int, payload: bytes) -> None:
        """Pace a serialized message; stamps never fall, but for a clock that jumps back."""
        self.messages += 1
        frames = self._reader.streams(payload)
        for one in self._gauged:
            one.offer(payload, frames, stamp_ns)

    @property
    def unread(self) -> int:
        """How many messages could not be read: as on a robot, they passed at each accuracy."""
        return max((one.unread for one in self._gauged), default=0)

    def tiers(self, source_hz: float) -> dict[LevelledProperty, AccuracyTiers]:
        """The accuracies with what they need of a source of ``source_hz``."""
        return {
            one.levelled: AccuracyTiers(
                bounds=one.bounds, needs_hz=bounds_need_hz(one.passed, self.messages, source_hz)
            )
            for one in self._gauged
            if self.messages
        }


class _Gauged:
    """One property, with a pacer for each of its accuracies."""

    __slots__ = ("_pacers", "_picture", "bounds", "levelled", "passed", "unread")

    def __init__(self, type_name: str, levelled: LevelledProperty, bounds: tuple[float, ...]) -> None:
        self.levelled = levelled
        self.bounds = bounds
        self.passed = [0] * len(bounds)
        self.unread = 0
        gauges = gauges_for(type_name, [levelled.value])
        self._picture = Picture(gauges, reckons=False)
        self._pacers = [TopicPacer(kind=_kind(type_name)) for _ in bounds]
        for pacer, bound in zip(self._pacers, bounds, strict=True):
            picture = Picture(gauges, reckons=False)
            accuracy = Accuracy(
                picture=picture, bounds={levelled.value: bound}, heartbeat_hz=HEARTBEAT_HZ, records={}
            )
            pacer.set_accuracy(accuracy, 0)
            pacer.set_rate(math.inf, 0)

    def offer(self, payload: bytes, frames: tuple[str, ...], now_ns: int) -> None:
        sample = Sample(payload, len(payload), frames=frames)
        sample.readings = self._picture.read(payload, None, now_ns)
        self.unread += None in sample.readings
        for number, pacer in enumerate(self._pacers):
            for _, passes in pacer.wake_until(now_ns):
                self.passed[number] += len(passes)
            self.passed[number] += len(pacer.offer(sample, now_ns))


def _kind(type_name: str) -> StreamKind:
    return StreamKind.of(type_name=type_name, transient_local=False)

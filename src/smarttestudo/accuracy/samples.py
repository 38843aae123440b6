# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The values of a topic's fields over time."""

from __future__ import annotations

import dataclasses
import itertools
import math
from array import array
from collections.abc import Collection, Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from numbers import Real
from typing import NamedTuple, cast

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.rate_meter import mean_hz
from smarttestudo.domain.recording import Channel
from smarttestudo.language.properties import (
    Reader,
    gauges_for,
    needs_decoded,
    properties_of,
    signal_reader,
    value_reader,
    wraps,
)
from smarttestudo.language.properties.field_path import MOST, PropertySpec
from smarttestudo.language.rule_set import WrittenCheck
from smarttestudo.pacing.cdr import STREAM_TYPES
from smarttestudo.pacing.coded_video import IMAGE_TYPES
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


FULL_TURN = 360.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """Values with their stamps, which never fall; a value that is not known is NaN.

    The field has a value from its sample on until the next one. Of several samples with one stamp the last
    counts. ``wraps`` says that the values are degrees in (−180, 180] that go round.
    """

    stamps_ns: array[int]
    values: array[float]
    wraps: bool = False

    @property
    def unknown(self) -> int:
        """How many samples are not known."""
        return sum(map(math.isnan, self.values))

    @property
    def value_range(self) -> float:
        """Greatest minus least known value; of a field that wraps, of its continuous course, up to 360."""
        known: Iterable[float] = itertools.filterfalse(math.isnan, self.values)
        if self.wraps:
            known = itertools.accumulate(known, lambda course, value: course + turn(course, value))
        listed = list(known)
        spread = max(listed) - min(listed) if listed else 0.0
        return min(spread, FULL_TURN) if self.wraps else spread

    def known(self) -> Series:
        """The samples that are known."""
        if not self.unknown:
            return self
        kept = [not math.isnan(value) for value in self.values]
        return Series(
            stamps_ns=array("q", itertools.compress(self.stamps_ns, kept)),
            values=array("d", itertools.compress(self.values, kept)),
            wraps=self.wraps,
        )


def usable(value: float) -> float:
    """``value``, or NaN where it is infinite or absurd."""
    return value if -MOST < value < MOST else math.nan


def turn(before: float, after: float) -> float:
    """The shorter way from one angle to another, in degrees of [−180, 180]."""
    return math.remainder(after - before, FULL_TURN)


MOST_FIELDS = 12
"""Fields of one topic that are looked at unasked, of a type without named properties."""

BULK_TYPES = IMAGE_TYPES | {"sensor_msgs/msg/PointCloud2", "nav_msgs/msg/OccupancyGrid"}
"""Types whose numbers are not in their scalar fields: not decoded unless a field is asked for."""

_DEEPEST = 8
_NO_MEASUREMENTS = frozenset({"header", "covariance"})
_TIME = frozenset({"sec", "nanosec"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A property or field path; ``unit`` is empty where unknown, ``wraps`` true of degrees that go round.

    With a ``word`` its values are 1 where the check of that name holds, else 0.
    """

    name: str
    unit: str = ""
    wraps: bool = False
    is_asked: bool = False
    word: WrittenCheck | None = None

    def reader(self, type_name: str, level_unit: LevelUnit | None) -> Reader:
        """Read it of messages of ``type_name``."""
        word = self.word
        if word is None:
            return value_reader(type_name, self.name, level_unit)
        read = signal_reader(type_name, word.signal, level_unit)

        def holds(message: object) -> float:
            values = read(message)
            if values is None or values != values:  # noqa: PLR0124 - NaN differs from itself
                return math.nan
            return float(word.holds_for(values))

        return holds


def fields_of(
    type_name: str, message: object, *, asked: Sequence[str] = (), needed: Sequence[Field] = ()
) -> tuple[Field, ...]:
    """The fields to look at of a topic of ``type_name``, of which ``message`` is one.

    Of a type with named properties those, else the first ``MOST_FIELDS`` scalar numbers; then what is
    ``asked`` for or ``needed`` beside them.
    """
    words = tuple(field for field in needed if field.word is not None)
    specs = properties_of(type_name)
    names = [*specs] if specs else [*scalar_paths(message)][:MOST_FIELDS]
    if type_name in BULK_TYPES:
        names = []
    numbers = (field.name for field in needed if field.word is None)
    chosen = dict.fromkeys([*names, *asked, *numbers])
    return *(_field(name, specs.get(name), is_asked=name in asked) for name in chosen), *words


def scalar_paths(message: object, *, deepest: int = _DEEPEST) -> Iterator[str]:
    """The paths of the numbers in a decoded message, without arrays, headers and times."""
    if not dataclasses.is_dataclass(message) or not deepest:
        return
    names = [field.name for field in dataclasses.fields(message) if not field.name.startswith("_")]
    if _TIME.issuperset(names):
        return
    for name in names:
        value = getattr(message, name)
        if isinstance(value, Real):
            yield name
        elif name not in _NO_MEASUREMENTS:
            yield from (f"{name}.{path}" for path in scalar_paths(value, deepest=deepest - 1))


def _field(name: str, spec: PropertySpec | None, *, is_asked: bool) -> Field:
    if spec is None:
        return Field(name=name, is_asked=is_asked)
    return Field(name=name, unit=spec.unit, wraps=wraps(spec), is_asked=is_asked)


class TopicSamples:
    """The messages of one topic, added one by one: 16 bytes for each, and 8 for each of its fields.

    ``undecodable`` counts messages that could not be decoded; what they said is not known. ``track`` has the
    messages for pictures of ``properties``, and also those of before the first one that counts.
    """

    __slots__ = (
        "_has_frames",
        "_readers",
        "channel",
        "columns",
        "fields",
        "frames",
        "sizes",
        "stamps_ns",
        "track",
        "undecodable",
    )

    def __init__(
        self,
        channel: Channel,
        properties: Collection[str] = (),
        level_unit: LevelUnit | None = None,
        *,
        is_standard: bool = True,
    ) -> None:
        self.channel = channel
        self.track = Track(channel.type_name, properties, level_unit, is_standard=is_standard)
        self.stamps_ns = array("q")
        self.sizes = array("q")
        self.frames: list[tuple[str, ...]] = []
        self.fields: tuple[Field, ...] = ()
        self.undecodable = 0
        self.columns: list[array[float]] = []
        self._readers: list[Reader] = []
        self._has_frames = channel.type_name in STREAM_TYPES

    @property
    def size_bytes(self) -> int:
        """All messages together."""
        return sum(self.sizes)

    @property
    def mean_hz(self) -> float | None:
        """(n − 1) / (last − first); ``None`` where that is not defined."""
        lasted_ns = self.stamps_ns[-1] - self.stamps_ns[0] if self.stamps_ns else 0
        return mean_hz(len(self.stamps_ns), lasted_ns)

    @property
    def kind(self) -> StreamKind:
        """How the topic is thinned."""
        return StreamKind.of(type_name=self.channel.type_name, transient_local=self.channel.transient_local)

    def look_at(self, fields: Sequence[Field], level_unit: LevelUnit | None) -> None:
        """Keep ``fields``, too, of every message from now on; what came before is not known."""
        type_name = self.channel.type_name
        known = {field.name for field in self.fields}
        new = [field for field in fields if field.name not in known]
        self.fields += tuple(new)
        self._readers += [field.reader(type_name, level_unit) for field in new]
        self.columns += [self._unknown() for _ in new]

    def add(self, stamp_ns: int, size_bytes: int, frames: tuple[str, ...] = ()) -> None:
        """Count a message; its fields are not known until ``read``."""
        self.stamps_ns.append(stamp_ns)
        self.sizes.append(size_bytes)
        if self._has_frames:
            self.frames.append(frames)
        for column in self.columns:
            column.append(math.nan)

    def read(self, message: object) -> None:
        """Take the fields of the message that was counted last."""
        for column, reader in zip(self.columns, self._readers, strict=True):
            column[-1] = usable(reader(message))

    def series(self, field: Field) -> Series:
        """A field over time; one that was not looked at is not known at any."""
        names = [one.name for one in self.fields]
        values = self.columns[names.index(field.name)] if field.name in names else self._unknown()
        return Series(stamps_ns=self.stamps_ns, values=values, wraps=field.wraps)

    def at_rate(self, rate_hz: float, end_ns: int) -> TopicSamples:
        """The messages of the topic that pass until ``end_ns`` at a fixed rate, infinite for all."""
        passed = thinned(self.stamps_ns, rate_hz, end_ns=end_ns, kind=self.kind, frames=self.frames)
        samples = copy(self)
        samples.stamps_ns = passed.stamps_ns
        samples.sizes = array("q", (self.sizes[index] for index in passed.indices))
        samples.columns = [array("d", (column[index] for index in passed.indices)) for column in self.columns]
        samples.track = self.track.thinned(passed)
        return samples

    def _unknown(self) -> array[float]:
        return array("d", [math.nan]) * len(self.stamps_ns)

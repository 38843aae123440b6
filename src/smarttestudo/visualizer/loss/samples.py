# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is kept of a topic of a recording: stamps and numbers, not messages."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence

from smarttestudo.adirf.properties import Reader, value_reader
from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.sample import StreamKind
from smarttestudo.visualizer.loss.fields import Field
from smarttestudo.visualizer.loss.series import Series, usable
from smarttestudo.visualizer.loss.thinning import Thinned, thinned


class TopicSamples:
    """The messages of one topic, told one by one: 16 bytes for each, and 8 for each of its fields.

    ``undecodable`` counts messages that could not be decoded; what they said is not known.
    """

    __slots__ = (
        "_columns",
        "_has_frames",
        "_readers",
        "channel",
        "fields",
        "frames",
        "sizes",
        "stamps_ns",
        "undecodable",
    )

    def __init__(self, channel: Channel) -> None:
        self.channel = channel
        self.stamps_ns = array("q")
        self.sizes = array("q")
        self.frames: list[tuple[str, ...]] = []
        self.fields: tuple[Field, ...] = ()
        self.undecodable = 0
        self._columns: list[array[float]] = []
        self._readers: list[Reader] = []
        self._has_frames = self.kind is StreamKind.TRANSFORMS

    @property
    def size_bytes(self) -> int:
        """All messages together."""
        return sum(self.sizes)

    @property
    def mean_hz(self) -> float | None:
        """(n − 1) / (last − first); ``None`` where that is not defined."""
        lasted_ns = self.stamps_ns[-1] - self.stamps_ns[0] if self.stamps_ns else 0
        return (len(self.stamps_ns) - 1) * NS_PER_S / lasted_ns if lasted_ns else None

    @property
    def kind(self) -> StreamKind:
        """How the topic is thinned."""
        return StreamKind.of(type_name=self.channel.type_name, transient_local=self.channel.transient_local)

    def look_at(self, fields: Sequence[Field], level_unit: LevelUnit | None) -> None:
        """Keep ``fields`` of every message from now on; what came before is not known."""
        type_name = self.channel.type_name
        self.fields = tuple(fields)
        self._readers = [value_reader(type_name, field.name, level_unit) for field in fields]
        self._columns = [self._unknown() for _ in fields]

    def add(self, stamp_ns: int, size_bytes: int, frames: tuple[str, ...] = ()) -> None:
        """Count a message; its fields are not known until ``read``."""
        self.stamps_ns.append(stamp_ns)
        self.sizes.append(size_bytes)
        if self._has_frames:
            self.frames.append(frames)
        for column in self._columns:
            column.append(math.nan)

    def read(self, message: object) -> None:
        """Take the fields of the message that was counted last."""
        for column, reader in zip(self._columns, self._readers, strict=True):
            column[-1] = usable(reader(message))

    def series(self, field: Field) -> Series:
        """A field over time; one that was not looked at is not known at any."""
        names = [one.name for one in self.fields]
        values = self._columns[names.index(field.name)] if field.name in names else self._unknown()
        return Series(stamps_ns=self.stamps_ns, values=values, wraps=field.wraps)

    def at_rate(self, rate_hz: float, end_ns: int) -> Thinned:
        """What passes of the topic until ``end_ns`` at a fixed rate, infinite for all."""
        return thinned(self.stamps_ns, rate_hz, end_ns=end_ns, kind=self.kind, frames=self.frames)

    def _unknown(self) -> array[float]:
        return array("d", [math.nan]) * len(self.stamps_ns)

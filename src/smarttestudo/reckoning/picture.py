# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a receiver shows of a topic, made from the messages that it got."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from typing import Any, NamedTuple

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.reckoning.gauges import Gauge, MovingPart, Reading

MAX_PARTS = 4096
"""Parts that are remembered of one topic; with more, all are forgotten, so that the next messages pass."""


class _Shown(NamedTuple):
    part: MovingPart
    motion: Any


class Picture:
    """The receiver's picture of one topic: the last value of each part, or what is reckoned from it.

    With ``reckons`` parts move on as ``Gauge.motion`` has it, at the time of the message that they are
    compared with. A topic with several gauges has a reading for each.
    """

    __slots__ = ("_gauges", "_reckons", "_shown")

    def __init__(self, gauges: Sequence[Gauge], *, reckons: bool) -> None:
        self._gauges = tuple(gauges)
        self._reckons = reckons
        self._shown: dict[Hashable, _Shown] = {}

    @property
    def needs_every_message(self) -> bool:
        """Whether what is shown after a message depends on earlier ones, too."""
        return self._reckons and any(gauge.needs_every_message for gauge in self._gauges)

    def read(self, payload: bytes, message: object | None, now_ns: int) -> tuple[Reading | None, ...]:
        """What a message says, a reading for each gauge; ``None`` where it cannot be read."""
        return tuple(gauge.read(payload, message, now_ns) for gauge in self._gauges)

    def errors(self, readings: Sequence[Reading | None], publisher: Hashable) -> dict[str, float]:
        """How far each property of the picture is from what was read: of the part that is farthest off.

        It is infinite where nothing is shown of a part, or where one of the two is not known.
        """
        errors: dict[str, float] = {}
        for number, (gauge, parts) in enumerate(zip(self._gauges, readings, strict=True)):
            for name in gauge.distances:
                errors[name] = 0.0 if parts is not None else math.inf
            source = None if gauge.is_shared else publisher
            for part in parts or ():
                shown = self._shown.get((number, source, part.name))
                if shown is None or shown.part.frames != part.frames:
                    errors.update(dict.fromkeys(gauge.distances, math.inf))
                    break
                state = self._state(gauge, shown, part.at_ns)
                for name, distance in gauge.distances.items():
                    error = distance(part.state, state)
                    if not error <= errors[name]:
                        errors[name] = math.inf if math.isnan(error) else error
        return errors

    def show(self, readings: Sequence[Reading | None], publisher: Hashable) -> None:
        """The receiver got the message that was read."""
        for number, (gauge, parts) in enumerate(zip(self._gauges, readings, strict=True)):
            source = None if gauge.is_shared else publisher
            if parts is None:
                self._shown.clear()
            for part in parts or ():
                key = (number, source, part.name)
                before = self._shown.get(key)
                if before is None and len(self._shown) >= MAX_PARTS:
                    self._shown.clear()
                motion = gauge.motion(before.part if before else None, part) if self._reckons else None
                self._shown[key] = _Shown(part, motion)

    def reckoned(
        self, payload: bytes, publisher: Hashable, at_ns: int, within: Mapping[str, float]
    ) -> bytes | None:
        """What a receiver shows at ``at_ns`` of the parts in ``payload``, which it got, as a message.

        ``None`` where it shows nothing, or what it got. ``within`` is how far the parts may be off.
        """
        gauge = self._gauges[0]
        source = None if gauge.is_shared else publisher
        parts: list[MovingPart] = []
        for part in gauge.read(payload, None, at_ns) or ():
            shown = self._shown.get((0, source, part.name))
            if shown is None or shown.part.frames != part.frames:
                return None
            parts.append(part._replace(at_ns=at_ns, state=self._state(gauge, shown, at_ns)))
        return gauge.written(payload, parts, at_ns, within) if parts else None

    def forget(self) -> None:
        """A receiver came that has got nothing yet."""
        self._shown.clear()

    def _state(self, gauge: Gauge, shown: _Shown, at_ns: int) -> object:
        if not self._reckons:
            return shown.part.state
        return gauge.after(shown.part.state, shown.motion, (at_ns - shown.part.at_ns) / NS_PER_S)

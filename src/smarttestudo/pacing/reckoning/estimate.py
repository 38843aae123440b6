# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Estimate that a receiver shows of a topic, made from the messages that it got."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.reckoning.gauges import Gauge, MovingPart, Reading, can_be_reckoned

MAX_PARTS = 4096
"""Parts that are remembered of one topic; with more, those of which nothing was heard for longest go."""
MISSED_HEARTBEATS = 2
"""After so many there is nothing to reckon from: the source, or the link, is silent."""


def silent_after_ns(heartbeat_hz: float) -> float:
    """For how long a part of a topic with this heartbeat is moved on where nothing comes."""
    return MISSED_HEARTBEATS * NS_PER_S / heartbeat_hz


class Shown(NamedTuple):
    """A part as a receiver last got it of ``publisher``, in ``message``; ``moves``: it is moved on since."""

    part: MovingPart
    motion: Any
    moves: bool
    publisher: Hashable
    message: Hashable

    def at(self, gauge: Gauge, at_ns: int) -> Any:
        if not self.moves:
            return self.part.state
        return gauge.after(self.part.state, self.motion, (at_ns - self.part.at_ns) / NS_PER_S)


class Estimate:
    """The receiver's estimate of one topic: the last value of each part, or what is reckoned from it.

    With ``reckons`` parts move on as ``Gauge.motion`` has it, at the time of the message that they are
    compared with, if their message ``can_be_reckoned``; else they are held. What is reckoned begins anew
    where another publisher takes a part over, its frames change, or its stamps jump: what would be reckoned
    over that is no estimate. All of it follows from the messages, so two estimates that were shown the
    same ones are the same. A topic with several gauges has a reading for each.
    """

    __slots__ = ("_gauges", "_reckons", "_shown", "_silent_after_ns")

    def __init__(self, gauges: Sequence[Gauge], *, reckons: bool) -> None:
        self._gauges = tuple(gauges)
        self._reckons = reckons
        self._shown: tuple[dict[Hashable, Shown], ...] = tuple({} for _ in self._gauges)
        self._silent_after_ns = math.inf

    @property
    def needs_every_message(self) -> bool:
        """Whether what is shown after a message depends on earlier ones, too."""
        return self._reckons and any(gauge.needs_every_message for gauge in self._gauges)

    def expect_heartbeat(self, heartbeat_hz: float) -> None:
        """A stamp that is more than the silence after this heartbeat from the last one has jumped."""
        self._silent_after_ns = silent_after_ns(heartbeat_hz)

    def read(self, payload: bytes, message: object | None, now_ns: int) -> tuple[Reading | None, ...]:
        """Readings of a message, one for each gauge; ``None`` where it cannot be read."""
        return tuple(gauge.read(payload, message, now_ns) for gauge in self._gauges)

    def errors(self, readings: Sequence[Reading | None], publisher: Hashable) -> dict[str, float]:
        """How far each property of the estimate is from what was read: of the part that is farthest off.

        It is infinite where nothing is shown of a part, or where one of the two is not known.
        """
        errors = {
            name: math.inf if parts is None else 0.0
            for gauge, parts in zip(self._gauges, readings, strict=True)
            for name in gauge.distances
        }
        for gauge, part, state in self._compared(readings, publisher):
            for name, distance in gauge.distances.items():
                error = math.inf if state is None else distance.between(part.state, state)
                # NaN is not at most anything.
                if not error <= errors[name]:
                    errors[name] = math.inf if math.isnan(error) else error
        return errors

    def judged_errors(self, readings: Sequence[Reading | None], publisher: Hashable) -> dict[str, float]:
        """The same by what the message says: without the parts and properties that it has no value of.

        ``errors`` are for who decides what passes: what is not known is news, too. These are for who judges
        the estimate, as nobody can tell how far it is from a truth that is not known.
        """
        errors: dict[str, float] = {}
        for gauge, part, state in self._compared(readings, publisher):
            for name, distance in gauge.distances.items():
                if not distance.has_value(part.state):
                    continue
                error = math.inf if state is None else distance.between(part.state, state)
                errors[name] = max(errors.get(name, 0.0), math.inf if math.isnan(error) else error)
        return errors

    def _compared(
        self, readings: Sequence[Reading | None], publisher: Hashable
    ) -> Iterator[tuple[Gauge, MovingPart, object]]:
        """The parts of a message, each with what is shown of it at its time; ``None`` where nothing is."""
        for gauge, known, parts in zip(self._gauges, self._shown, readings, strict=True):
            moves = self._reckons and can_be_reckoned(parts)
            for part in parts or ():
                shown = known.get(part.name if gauge.is_shared else publisher)
                goes_on = shown is not None and self._goes_on(shown, part, publisher, moves=moves)
                yield gauge, part, shown.at(gauge, part.at_ns) if shown and goes_on else None

    def says_all(self, readings: Sequence[Reading | None]) -> bool:
        """Whether a message has a value of each property, in one of its parts."""
        return all(
            any(distance.has_value(part.state) for part in parts or ())
            for gauge, parts in zip(self._gauges, readings, strict=True)
            for distance in gauge.distances.values()
        )

    def show(self, readings: Sequence[Reading | None], publisher: Hashable, message: Hashable = None) -> None:
        """The receiver got what was read, in ``message``."""
        for gauge, known, parts in zip(self._gauges, self._shown, readings, strict=True):
            if parts is None:
                known.clear()
            moves = self._reckons and can_be_reckoned(parts)
            for part in parts or ():
                key = part.name if gauge.is_shared else publisher
                before = known.pop(key, None)
                motion = None
                if moves:
                    goes_on = before is not None and self._goes_on(before, part, publisher, moves=True)
                    motion = gauge.motion(before.part if before and goes_on else None, part)
                if before is None or before.part.frames != part.frames:
                    self._make_room(gauge, known, part)
                known[key] = Shown(part, motion, moves, publisher, message)

    def is_taken_over(self, readings: Sequence[Reading | None], publisher: Hashable) -> bool:
        """Whether all that was read is reckoned from what another publisher said since."""
        taken_over = [
            any(
                known_part.moves and known_part.publisher != publisher
                for known_part in _same(gauge, known, part)
            )
            for gauge, known, parts in zip(self._gauges, self._shown, readings, strict=True)
            for part in parts or ()
        ]
        return bool(taken_over) and all(taken_over)

    def moving(self) -> Mapping[Hashable, list[Shown]]:
        """By message, those of its parts that are moved on and that no newer message holds."""
        found: dict[Hashable, list[Shown]] = {}
        for shown in self._shown[0].values():
            if shown.moves:
                found.setdefault(shown.message, []).append(shown)
        return found

    def written(
        self, payload: bytes, parts: Sequence[Shown], elapsed_ns: int, within: Mapping[str, float]
    ) -> bytes | None:
        """A message with these ``parts`` of ``payload`` as they are ``elapsed_ns`` later.

        ``None`` if nothing of its type moves. ``within`` is how far the parts may be off.
        """
        gauge = self._gauges[0]
        moved = []
        for shown in parts:
            at_ns = shown.part.at_ns + elapsed_ns
            moved.append(shown.part._replace(at_ns=at_ns, state=shown.at(gauge, at_ns)))
        return gauge.written(payload, moved, within)

    def forget(self) -> None:
        """Serve a new receiver, which has got nothing yet."""
        for known in self._shown:
            known.clear()

    def forget_publisher(self, publisher: Hashable) -> None:
        for known in self._shown:
            for key in [key for key, shown in known.items() if shown.publisher == publisher]:
                del known[key]

    def _goes_on(self, shown: Shown, part: MovingPart, publisher: Hashable, *, moves: bool) -> bool:
        """Whether ``part`` says how what is ``shown`` went on."""
        if shown.part.frames != part.frames or shown.moves != moves:
            return False
        if not moves:
            return True
        has_jumped = abs(part.at_ns - shown.part.at_ns) > self._silent_after_ns
        return shown.publisher == publisher and not has_jumped

    def _make_room(self, gauge: Gauge, known: dict[Hashable, Shown], part: MovingPart) -> None:
        """A part comes anew: one of the same frames was said by a publisher that this one replaces."""
        if self._reckons and not gauge.is_shared and part.frames is not None:
            for key in [key for key, shown in known.items() if shown.part.frames == part.frames]:
                del known[key]
        if len(known) >= MAX_PARTS:
            del known[next(iter(known))]


def _same(gauge: Gauge, known: Mapping[Hashable, Shown], part: MovingPart) -> Iterator[Shown]:
    """State that is shown of the thing that ``part`` is of, whoever said it."""
    if gauge.is_shared:
        shown = known.get(part.name)
        return iter(() if shown is None else (shown,))
    return (
        known_part
        for known_part in known.values()
        if part.frames is not None and known_part.part.frames == part.frames
    )

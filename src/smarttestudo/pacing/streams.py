# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The streams of one topic: by publisher, or by the names that its messages hold, such as child frames."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from typing import Generic, TypeVar

from smarttestudo.pacing.cdr import DELETE_ALL
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.pacing.sample import Pass, Sample
from smarttestudo.pacing.stream import Stream

AnyStream = TypeVar("AnyStream", bound=Stream)

MAX_STREAMS = 4096
OPENS_TO_PRUNE = 64


def messages_per_hz(names: int, *, messages: int, named: int) -> float:
    """How many messages pass at 1 Hz, which each of ``names`` has: their number by how many a message names.

    So many were ``named`` in so many ``messages``; it is 1 where none was.
    """
    return names * messages / named if named else 1.0


class _Others:
    """The key that all streams beyond ``MAX_STREAMS`` share."""


class Streams(ABC, Generic[AnyStream]):
    """The streams of one topic; how their messages belong together is the subclass's.

    ``wake_ns`` is never later than the first time at which ``wake`` has something to do. With several streams
    it may be earlier, because a newer message postpones that: ``wake`` finds out, and arms itself again.
    """

    __slots__ = ("_open", "_opens_to_prune", "_pace", "_streams", "wake_ns")

    def __init__(self, open_stream: Callable[[Pace, int], AnyStream], pace: Pace) -> None:
        self._open = open_stream
        self._pace = pace
        self._streams: dict[Hashable, AnyStream] = {}
        self._opens_to_prune = OPENS_TO_PRUNE
        self.wake_ns = NEVER_NS

    @property
    def due_ns(self) -> int | None:
        """When the next message may pass; ``None`` while any may."""
        return min((stream.grid.due_ns for stream in self._streams.values()), default=None)

    @abstractmethod
    def offer(self, sample: Sample, now_ns: int) -> Sequence[Pass]:
        """Pace ``sample``, which arrived: return it if it passes now, else nothing."""

    @abstractmethod
    def holds(self, sample: Sample) -> bool:
        """Whether ``sample`` did not pass, but still may."""

    def wake(self, now_ns: int) -> Sequence[Pass]:
        """Samples that pass now without a new one."""
        if now_ns < self.wake_ns:
            return ()
        passes: list[Pass] = []
        for stream in list(self._streams.values()):
            if stream.release_ns <= now_ns:
                passes.extend(self._release(stream, now_ns))
        self._arm(now_ns)
        return passes

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        self._pace = pace
        for stream in self._streams.values():
            stream.change_pace(pace, now_ns)
        self._arm(now_ns)

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``."""
        for stream in self._streams.values():
            stream.restart(now_ns)
        self._arm(now_ns)

    def end_groups(self) -> None:
        """End the groups of messages that do not come from now on."""
        for stream in self._streams.values():
            stream.end_groups()

    def finish(self) -> None:
        """No message will come any more."""
        for stream in self._streams.values():
            stream.finished = True

    def held(self) -> list[Sample]:
        """The samples that did not pass but still may, each once."""
        return list(
            dict.fromkeys(stream.held for stream in self._streams.values() if stream.held is not None)
        )

    def streams(self) -> Collection[AnyStream]:
        return self._streams.values()

    def by_publisher(self) -> dict[bytes, AnyStream]:
        """The streams of publishers that are known."""
        return {key: stream for key, stream in self._streams.items() if isinstance(key, bytes)}

    def go_on(self, streams: Mapping[bytes, AnyStream], now_ns: int) -> None:
        """Have these streams in place of those that are there, at the pace that holds now."""
        self._streams = dict(streams.items())
        for stream in streams.values():
            if stream.grid.pace != self._pace:
                stream.change_pace(self._pace, now_ns)
        self._arm(now_ns)

    def _release(self, stream: AnyStream, now_ns: int) -> Sequence[Pass]:
        return stream.release(now_ns)

    def _streams_of(self, sample: Sample, now_ns: int) -> list[AnyStream]:
        keys: Sequence[Hashable] = sample.frames or (sample.publisher,)
        known = self._streams
        streams = [known.get(key) or self._open_stream(key, now_ns) for key in keys]
        # Names beyond the most share one.
        return streams if len(known) < MAX_STREAMS else list(dict.fromkeys(streams))

    def _open_stream(self, key: Hashable, now_ns: int) -> AnyStream:
        self._opens_to_prune -= 1
        if self._opens_to_prune == 0:
            self._streams = {k: stream for k, stream in self._streams.items() if not stream.is_idle(now_ns)}
            self._opens_to_prune = max(OPENS_TO_PRUNE, len(self._streams))
        if len(self._streams) >= MAX_STREAMS:
            key = _Others
        return self._streams.setdefault(key, self._open(self._pace, now_ns))

    def _arm(self, now_ns: int) -> None:
        first_ns = min((stream.release_ns for stream in self._streams.values()), default=NEVER_NS)
        self.wake_ns = max(first_ns, now_ns)


class NamedStreams(Streams[AnyStream]):
    """One stream for each name, such as a child frame; a message passes whole if any stream in it is due.

    It counts for all its streams, yet none is ever due later than one period after it, so that one that
    passed along with others does not starve once they are gone. The final message is that of each stream; one
    that is final for several passes once. No message passes behind a newer one of a name in it: what is held
    for other names goes first. Messages that name none are those of their publisher. A message that deletes
    markers passes in any case.
    """

    __slots__ = ("_arrivals",)

    def __init__(self, open_stream: Callable[[Pace, int], AnyStream], pace: Pace) -> None:
        super().__init__(open_stream, pace)
        self._arrivals = 0

    def offer(self, sample: Sample, now_ns: int) -> Sequence[Pass]:
        """Pace ``sample``, which arrived: return it if it passes now, else nothing."""
        self._arrivals += 1
        streams = self._streams_of(sample, now_ns)
        is_due, first_due_ns = sample.deletion > 0 and not self._pace.is_off, NEVER_NS
        for stream in streams:
            stream.source.record(now_ns)
            if stream.is_due(now_ns):
                is_due = True
            elif stream.grid.due_ns < first_due_ns:
                first_due_ns = stream.grid.due_ns
        if sample.deletion == DELETE_ALL:
            for stream in self._streams.values():
                stream.held = None
        if is_due:
            before = self._release_older(sample, self._arrivals, now_ns)
            for stream in streams:
                stream.settle(now_ns)
            return (*before, Pass(sample))
        for stream in streams:
            stream.hold(sample, now_ns)
            stream.held_number = self._arrivals
        # What is held waits until it is due or longer; wake finds out.
        self.wake_ns = min(self.wake_ns, max(first_due_ns, now_ns))
        return ()

    def wake(self, now_ns: int) -> Sequence[Pass]:
        """Samples that pass now without a new one, the older ones first."""
        if now_ns < self.wake_ns:
            return ()
        passes: list[Pass] = []
        due = [stream for stream in self._streams.values() if stream.release_ns <= now_ns]
        for stream in sorted(due, key=lambda stream_due: stream_due.held_number):
            if stream.held is not None:
                passes += self._release_older(stream.held, stream.held_number, now_ns)
                passes += self._release(stream, now_ns)
        self._arm(now_ns)
        return passes

    def holds(self, sample: Sample) -> bool:
        """Whether ``sample`` did not pass, but still may."""
        return any(stream.held is sample for stream in self._streams.values())

    def _release_older(self, sample: Sample, number: int, now_ns: int) -> Sequence[Pass]:
        """Relay what arrived before arrival ``number``, which is ``sample``, and shares a name with it.

        What shares one with what goes first goes before that, in its order.
        """
        own = set(self._streams_of(sample, now_ns))
        held = {
            stream.held: stream
            for stream in self._streams.values()
            if stream.held is not None and stream.held_number < number and stream not in own
        }
        held.pop(sample, None)
        names, before = set(sample.frames), list[AnyStream]()
        while found := [other for other in held if not names.isdisjoint(other.frames)]:
            for other in found:
                before.append(held.pop(other))
                names.update(other.frames)
        before.sort(key=lambda stream: stream.held_number)
        return [passed for stream in before for passed in self._release(stream, now_ns)]

    def _release(self, stream: AnyStream, now_ns: int) -> Sequence[Pass]:
        sample = stream.held
        if sample is None:
            return ()
        for other in {stream, *self._streams_of(sample, now_ns)}:
            other.charge(now_ns)
            if other.held is sample:
                other.held = None
        return (Pass(sample),)


class PublisherStreams(Streams[AnyStream]):
    """One stream for each publisher, so that none starves another."""

    __slots__ = ()

    def offer(self, sample: Sample, now_ns: int) -> Sequence[Pass]:
        """Pace ``sample``, which arrived: return it if it passes now, else nothing."""
        stream = self._streams.get(sample.publisher) or self._open_stream(sample.publisher, now_ns)
        passes = stream.offer(sample, now_ns)
        release_ns = stream.release_ns
        self.wake_ns = release_ns if len(self._streams) == 1 else min(self.wake_ns, release_ns)
        return (Pass(sample),) if passes else ()

    def holds(self, sample: Sample) -> bool:
        """Whether ``sample`` did not pass, but still may."""
        return any(stream.held is sample for stream in self._streams.values())

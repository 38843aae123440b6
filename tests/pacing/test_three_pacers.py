# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The pacer, the one that is compiled, and one that hands over between them pass the same to the nanosecond.

A fourth, of a few lines, is the second opinion on all.
"""

from __future__ import annotations

import itertools
import math
import random
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import count

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from compiled_relay import GID_BYTES, ListedRcl, library_in
from pacing.scenarios import EPOCH_NS, seeds
from smarttestudo.domain.compiled_relay import PacedStream
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.hand_over import stream_of, stream_state
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.pacing.sample import Pass, Sample
from smarttestudo.pacing.topic_pacer import TopicPacer
from smarttestudo.robot.ros.rcl.relay_library import RelayLibrary, c_ns

pytestmark = pytest.mark.contract

PUBLISHERS = [bytes([number]) * GID_BYTES for number in range(3)]


@pytest.fixture(scope="module")
def library(compiled_relays: None, tmp_path_factory: pytest.TempPathFactory) -> RelayLibrary:
    return library_in(tmp_path_factory.mktemp("compiled"))


class AnyPacer(ABC):
    """One of them; what passes is given as the numbers of messages."""

    @property
    @abstractmethod
    def next_ns(self) -> int:
        """When it wants to be woken at the latest."""

    @abstractmethod
    def offer(self, publisher: bytes, number: int, now_ns: int) -> list[int]: ...

    @abstractmethod
    def wake(self, now_ns: int) -> list[int]: ...

    @abstractmethod
    def set_rate(self, rate_hz: float, now_ns: int) -> None: ...


class PythonPacer(AnyPacer):
    def __init__(self) -> None:
        self.pacer = TopicPacer()

    @property
    def next_ns(self) -> int:
        return self.pacer.wake_ns or NEVER_NS

    def offer(self, publisher: bytes, number: int, now_ns: int) -> list[int]:
        woken = self.pacer.wake(now_ns)
        sample = Sample(number.to_bytes(8, "little"), 8, publisher)
        return _numbers([*woken, *self.pacer.offer(sample, now_ns)])

    def wake(self, now_ns: int) -> list[int]:
        return _numbers(self.pacer.wake(now_ns))

    def set_rate(self, rate_hz: float, now_ns: int) -> None:
        self.pacer.set_rate(rate_hz, now_ns)


def _numbers(passes: Sequence[Pass]) -> list[int]:
    return [int.from_bytes(passed.sample.payload[:], "little") for passed in passes]


class CompiledPacer(AnyPacer):
    """relay.c without its thread: the test does what that would do."""

    def __init__(self, library: RelayLibrary, pace: Pace, *, now_ns: int = 0) -> None:
        self.pace = pace
        self._library = library
        self._rcl = ListedRcl()
        settings = self._rcl.settings(takes_on_callback=1, period_ns=c_ns(pace.period_ns))
        settings.counts.now_ns = now_ns
        self._relay = library.new(settings)
        self._next_ns = NEVER_NS

    @property
    def next_ns(self) -> int:
        return self._next_ns

    def know(self, stream: PacedStream) -> None:
        self._library.add_stream(self._relay, stream, stream.publisher, 0)

    def offer(self, publisher: bytes, number: int, now_ns: int) -> list[int]:
        self._rcl.to_take.append((publisher, number, number.to_bytes(8, "little")))
        return self.wake(now_ns)

    def wake(self, now_ns: int) -> list[int]:
        self._rcl.now_ns = now_ns
        wait_ns = self._library.step(self._relay)
        self._next_ns = NEVER_NS if wait_ns is None else now_ns + wait_ns
        return self._passed()

    def set_rate(self, rate_hz: float, now_ns: int) -> None:
        pace = Pace.at(rate_hz)
        if pace != self.pace:
            self.pace = pace
            self._rcl.now_ns = now_ns
            self._library.set_pace(self._relay, pace.period_ns)

    def streams(self, now_ns: int) -> list[PacedStream]:
        self._rcl.now_ns = now_ns
        self._library.counts(self._relay)
        found = [stream.paced_stream(GID_BYTES) for stream in self._library.streams(self._relay)]
        self._library.free(self._relay)
        return found

    def _passed(self) -> list[int]:
        passed = [int.from_bytes(content, "little") for content in self._rcl.published]
        self._rcl.published.clear()
        return passed


class AlternatingPacer(AnyPacer):
    """Hands over from one to the other at random, or for another rate comes back later than that is set."""

    def __init__(self, library: RelayLibrary, chance: random.Random) -> None:
        self._library = library
        self._chance = chance
        self._python = PythonPacer()
        self._pace = Pace.at(math.inf)
        self._compiled: CompiledPacer | None = None

    @property
    def _pacer(self) -> AnyPacer:
        return self._compiled or self._python

    @property
    def next_ns(self) -> int:
        return self._pacer.next_ns

    def offer(self, publisher: bytes, number: int, now_ns: int) -> list[int]:
        passed = self._pacer.offer(publisher, number, now_ns)
        self._change(now_ns)
        return passed

    def wake(self, now_ns: int) -> list[int]:
        passed = self._pacer.wake(now_ns)
        self._change(now_ns)
        return passed

    def set_rate(self, rate_hz: float, now_ns: int) -> None:
        self._pace = Pace.at(rate_hz)
        self._python.set_rate(rate_hz, now_ns)
        if self._compiled is not None and self._chance.random() < 0.5:
            self._compiled.set_rate(rate_hz, now_ns)
        elif self._compiled is not None:
            self._take_back(now_ns)

    def _change(self, now_ns: int) -> None:
        if self._chance.random() < 0.7:
            return
        if self._compiled is not None:
            self._take_back(now_ns)
            return
        pacer = self._python.pacer
        self._compiled = CompiledPacer(self._library, self._pace, now_ns=now_ns)
        for publisher, stream in pacer.hand_over().items():
            self._compiled.know(stream_state(publisher, stream))
        assert pacer.wake_ns is None
        assert self._compiled.wake(now_ns) == []

    def _take_back(self, now_ns: int) -> None:
        if self._compiled is not None:
            pace = self._compiled.pace
            states = self._compiled.streams(now_ns)
            streams = {state.publisher: stream_of(state, pace, now_ns) for state in states}
            assert not self._python.pacer.take_back(streams, now_ns)
            self._compiled = None


class NaiveStream:
    """All arrivals of a publisher, with sums over those that count."""

    def __init__(self, due_ns: int) -> None:
        self.due_ns = due_ns
        self.phase_ns, self.direction = 0, 1
        self.arrivals: list[int] = []
        self.lag_ns = self.step_ns = 0
        self.held: tuple[int, int] | None = None

    def gaps(self) -> list[int]:
        pairs = itertools.pairwise(self.arrivals)
        first = self.arrivals[-1] // (10 * NS_PER_S) - 6 if self.arrivals else 0
        return [min(b - a, 2 * NS_PER_S) for a, b in pairs if b // (10 * NS_PER_S) >= first]

    def burst_ns(self) -> int:
        gaps = self.gaps()
        squares = sum((gap // 1000) ** 2 for gap in gaps)
        return squares // (sum(gaps) // 1000) * 1000 if sum(gaps) >= 1000 else 0

    def arrive(self, now_ns: int) -> None:
        self.arrivals.append(now_ns)
        if gaps := self.gaps():
            gap_ns = min(now_ns - self.arrivals[-2], 2 * NS_PER_S)
            is_first = now_ns // (10 * NS_PER_S) > self.arrivals[-2] // (10 * NS_PER_S)
            if is_first or gap_ns >= self.step_ns:
                self.step_ns = sum(gaps) // len(gaps)
            if self.lag_ns < 2 * self.step_ns <= 2 * gap_ns:
                self.lag_ns -= self.lag_ns // 8
            most_ns = min(8 * (self.burst_ns() - self.step_ns), 2 * NS_PER_S) if self.has_bursts() else 0
            late_ns = min(gap_ns, max(gaps[:-1], default=0)) - self.step_ns
            self.lag_ns = max(min(self.lag_ns + late_ns, most_ns), 0)

    def has_bursts(self) -> bool:
        return self.step_ns > 0 and self.burst_ns() >= Fraction(5, 4) * self.step_ns

    def quiet_ns(self) -> int:
        late_ns = max(self.gaps()) + self.step_ns if self.has_bursts() else 0
        return max(2 * self.burst_ns(), late_ns)

    def slack_ns(self, period_ns: int) -> int:
        longest_ns = max(self.gaps(), default=0) + self.lag_ns
        held_within = min(max(longest_ns, NS_PER_S // 4), 2 * NS_PER_S)
        return max(2 * period_ns, held_within) if 0 < period_ns < NEVER_NS else 0

    def advance(self, period_ns: int, now_ns: int) -> None:
        self.due_ns = min(max(self.due_ns, now_ns - self.slack_ns(period_ns)), now_ns) + period_ns
        gap_ns = self.step_ns
        if self.held is not None and 0 < gap_ns < period_ns:
            share_ns = gap_ns * gap_ns // period_ns
            half_ns = (period_ns - share_ns) // 2
            step_ns = min(period_ns // 10, gap_ns)
            step_ns = (step_ns - share_ns * step_ns // period_ns) * 693 // 1000
            phase_ns = self.phase_ns + self.direction * step_ns
            if phase_ns * self.direction > half_ns:
                phase_ns = max((period_ns - share_ns) - phase_ns * self.direction, -half_ns) * self.direction
                self.direction = -self.direction
            self.due_ns += phase_ns - self.phase_ns
            self.phase_ns = phase_ns
        self.held = None


class NaivePacer(AnyPacer):
    """A list of arrivals for each publisher, and sums."""

    def __init__(self) -> None:
        self.period_ns = 0
        self.now_ns = -NEVER_NS
        self.streams: dict[bytes, NaiveStream] = {}

    @property
    def next_ns(self) -> int:
        return min(map(self._release_ns, self.streams.values()), default=NEVER_NS)

    def offer(self, publisher: bytes, number: int, now_ns: int) -> list[int]:
        passed = self.wake(now_ns)
        stream = self.streams.setdefault(publisher, NaiveStream(self._start(now_ns)))
        stream.arrive(now_ns)
        if self.period_ns == 0 or now_ns - stream.lag_ns >= stream.due_ns:
            stream.advance(self.period_ns, now_ns)
            return [*passed, number]
        if self.period_ns < NEVER_NS:
            stream.held = (number, now_ns)
        return passed

    def wake(self, now_ns: int) -> list[int]:
        self._see(now_ns)
        passed = []
        for stream in self.streams.values():
            if stream.held is not None and self._release_ns(stream) <= now_ns:
                passed.append(stream.held[0])
                stream.advance(self.period_ns, now_ns)
        return passed

    def set_rate(self, rate_hz: float, now_ns: int) -> None:
        before_ns, period_ns = self.period_ns, Pace.at(rate_hz).period_ns
        if period_ns == before_ns:
            return
        self._see(now_ns)
        self.period_ns = period_ns
        for stream in self.streams.values():
            start_ns = self._start(now_ns)
            if not period_ns:
                stream.due_ns = -NEVER_NS
            elif NEVER_NS in (period_ns, before_ns):
                stream.due_ns, stream.phase_ns, stream.direction = start_ns, 0, 1
            elif not before_ns:
                after_ns = stream.due_ns + period_ns - period_ns // 2
                stream.due_ns, stream.phase_ns, stream.direction = max(start_ns, after_ns), 0, 1
            else:
                ratio = Fraction(period_ns, before_ns)
                ahead_ns = max(stream.due_ns - now_ns, -stream.slack_ns(before_ns))
                stream.due_ns = now_ns + math.floor(ahead_ns * ratio)
                stream.phase_ns = math.floor(stream.phase_ns * ratio)
            if period_ns == NEVER_NS:
                stream.held = None

    def _see(self, now_ns: int) -> None:
        if now_ns < self.now_ns:
            before, self.streams = self.streams, {}
            for publisher, stream in before.items():
                self.streams[publisher] = NaiveStream(self._start(now_ns))
                if stream.held is not None:
                    self.streams[publisher].held = (stream.held[0], now_ns)
        self.now_ns = now_ns

    def _start(self, now_ns: int) -> int:
        return NEVER_NS if self.period_ns == NEVER_NS else now_ns - self.period_ns // 2

    def _release_ns(self, stream: NaiveStream) -> int:
        if stream.held is None:
            return NEVER_NS
        return max(stream.due_ns, stream.held[1] + max(stream.quiet_ns(), self.period_ns))


def a_time(chance: random.Random) -> int:
    """How long until the next thing happens, in ns; most are messages' intervals."""
    kind = chance.random()
    if kind < 0.1:
        return chance.choice([0, 0, 1, 2])
    if kind < 0.9:
        return int(10 ** chance.uniform(5, 9))
    return int(10 ** chance.uniform(8, 11.5))


def a_rate(chance: random.Random) -> float:
    kind = chance.random()
    if kind < 0.3:
        return chance.choice([math.inf, 0.0])
    if kind < 0.6:
        return float(chance.choice([1, 2, 5, 10, 50, 100]))
    return 10 ** chance.uniform(-3, 4)


def happenings(chance: random.Random, length: int) -> Iterator[tuple[int, bytes | float | None]]:
    """When and what: a message of a publisher, another rate, or a wake-up; the clock jumps at times."""
    now_ns = EPOCH_NS
    publishers = PUBLISHERS[: chance.choice([1, 1, 2, 3])]
    regular_ns = a_time(chance)
    for _ in range(length):
        kind = chance.random()
        now_ns += regular_ns if chance.random() < 0.5 else a_time(chance)
        if kind < 0.03:
            now_ns -= int(10 ** chance.uniform(0, 12))
        if kind < 0.1:
            yield now_ns, a_rate(chance)
        elif kind < 0.15:
            yield now_ns, None
        else:
            yield now_ns, chance.choice(publishers)


# The seeds are what broke one of them once, or each branch of a pace's change.
@settings(max_examples=10_000)
@given(seeds, st.integers(1, 40))
@example(0, 40)
@example(1, 40)
def test_all_pass_the_same_at_the_same_time(library: RelayLibrary, seed: int, length: int) -> None:
    chance = random.Random(seed)
    full = Pace.at(math.inf)
    compiled = CompiledPacer(library, full)
    pacers: list[AnyPacer] = [PythonPacer(), NaivePacer(), compiled, AlternatingPacer(library, chance)]
    numbers, before_ns = count(1), EPOCH_NS
    for now_ns, what in happenings(chance, length):
        while before_ns <= (wake_ns := min(pacer.next_ns for pacer in pacers)) <= now_ns:
            assert_same([pacer.wake(wake_ns) for pacer in pacers])
            before_ns = wake_ns + 1
        before_ns = now_ns
        if isinstance(what, bytes):
            number = next(numbers)
            assert_same([pacer.offer(what, number, now_ns) for pacer in pacers])
            continue
        # The loop does so before any rate. The same rate again would show the clock to some only.
        assert_same([pacer.wake(now_ns) for pacer in pacers])
        if what is not None:
            for pacer in pacers:
                pacer.set_rate(what, now_ns)
    compiled.streams(before_ns)


def assert_same(passed: Sequence[list[int]]) -> None:
    first, *others = passed
    assert all(other == first for other in others), passed

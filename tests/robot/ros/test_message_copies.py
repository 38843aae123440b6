# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that compiled relays take come to Python as copies: each once, in order, with its time."""

from __future__ import annotations

import random
import select
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiled_relay import GID_BYTES, ListedRcl, library_in
from pacing.scenarios import seeds
from smarttestudo.domain.compiled_relay import MAX_PERIOD_NS, MessageCopy
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.ros.rcl.message_copies import CopiedSource, MessageCopies
from smarttestudo.robot.ros.rcl.relay_library import RelayLibrary

pytestmark = pytest.mark.contract

SANITIZED = ("-g", "-fsanitize=undefined", "-fno-sanitize-recover=all")
HEADER_BYTES = 72
SIZES_TOPIC = 3
"""Of this one, only sizes are copied."""
FIRST = b"\x01" * GID_BYTES


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("sanitized")


@pytest.fixture(scope="module")
def library(compiled_relays: None, folder: Path) -> RelayLibrary:
    return library_in(folder, *SANITIZED)


class CopiedTopics:
    """Relays of several topics, each taking from a list of its own, all copied."""

    def __init__(self, library: RelayLibrary, copies: MessageCopies, count: int, **others: int) -> None:
        self.relays, self.copies = library, copies
        self.given: list[tuple[int, int, bytes, bytes | None, int, int]] = []
        self.rcl = [ListedRcl() for _ in range(count)]
        self.open: dict[int, tuple[int, CopiedSource]] = {}
        for topic, rcl in enumerate(self.rcl):
            settings = rcl.settings(**others)
            take, copied = settings.rcl.take, partial(self._copied, topic)
            source = copies.of_taken(take, 0, GID_BYTES, copied, has_payload=topic != SIZES_TOPIC)
            settings.rcl.take, settings.subscription = copies.take, source.address
            self.open[topic] = library.new(settings), source

    def _copied(self, topic: int, number: int, copy: MessageCopy) -> None:
        assert copy.payload is None or len(copy.payload) == copy.size_bytes
        self.given.append((topic, number, copy.publisher, copy.payload, *copy.at))

    def send(self, topic: int, number: int, gid: bytes, payload: bytes) -> None:
        self.rcl[topic].to_take.append((gid, number, payload))
        self.relays.step(self.open[topic][0])

    def end(self, topic: int) -> None:
        relay, source = self.open.pop(topic)
        self.relays.free(relay)
        self.copies.remove([source])

    def close(self) -> None:
        for topic in list(self.open):
            self.end(topic)


@contextmanager
def copies_on(clock: ListedRcl, folder: Path, **limits: int) -> Iterator[MessageCopies]:
    failures: list[RosError] = []
    clocks = clock.settings().rcl.now_ns, clock.steady
    copies = MessageCopies(failures.append, folder / "relay.so", clocks=clocks, **limits)
    yield copies
    copies.close()
    assert failures == []


def any_payload(chance: random.Random) -> bytes:
    return chance.randbytes(chance.choice([0, 1, 7, 8, 9, chance.randrange(200), chance.randrange(90_000)]))


@settings(max_examples=100)
@given(seeds, st.integers(1, 60), st.integers(1, 4))
def test_what_was_taken_by_then_is_delivered_once_in_the_order_of_all_topics(
    library: RelayLibrary, folder: Path, seed: int, count: int, topics: int
) -> None:
    chance, clock = random.Random(seed), ListedRcl()
    period_ns = chance.choice([0, NS_PER_S, MAX_PERIOD_NS])
    with copies_on(clock, folder) as copies:
        copied = CopiedTopics(library, copies, topics, period_ns=period_ns)
        sent = []
        looked_ns = 0
        for number in range(1, count + 1):
            clock.steady_ns += chance.randrange(NS_PER_S)
            # However the clock is set, what was copied by then is known by the steady one.
            clock.now_ns = chance.choice([clock.now_ns, clock.steady_ns, chance.getrandbits(60)])
            message = (chance.randrange(topics), number, chance.randbytes(GID_BYTES), any_payload(chance))
            copied.send(*message)
            payload = None if message[0] == SIZES_TOPIC else message[3]
            sent.append((*message[:3], payload, clock.now_ns, clock.steady_ns))
            if chance.random() < 0.3:
                # Some may be taken between a look at the clock and the delivery.
                until_ns = chance.randint(looked_ns, clock.steady_ns)
                looked_ns = clock.steady_ns
                copies.deliver(until_ns)
                assert copied.given == [one for one in sent if one[-1] <= until_ns]
        copied.close()
        assert copied.given == sent


def test_a_clock_that_is_set_back_holds_nothing_back(library: RelayLibrary, folder: Path) -> None:
    clock = ListedRcl()
    with copies_on(clock, folder) as copies:
        copied = CopiedTopics(library, copies, 1)
        for number, clock.now_ns, clock.steady_ns in ((1, 100, 7), (2, 50, 8), (3, 10**18, 9)):
            copied.send(0, number, FIRST, b"")
        copies.deliver(8)
        assert [one[-2:] for one in copied.given] == [(100, 7), (50, 8)]
        copies.deliver(9)
        assert copied.given[-1][-2:] == (10**18, 9)
        copied.close()


def test_what_finds_no_room_is_missing_among_the_numbers_and_the_rest_is_whole(
    library: RelayLibrary, folder: Path
) -> None:
    clock = ListedRcl()
    with copies_on(clock, folder, most_bytes=4 * (HEADER_BYTES + 104)) as copies:
        copied = CopiedTopics(library, copies, 1)
        for first in (1, 8):
            for number in range(first, first + 7):
                copied.send(0, number, FIRST, bytes([number]) * 99)
            copies.deliver(0)
        copied.send(0, 15, FIRST, bytes(10_000))
        copied.send(0, 16, FIRST, b"")
        copies.deliver(0)
        assert [one[1] for one in copied.given] == [1, 2, 3, 4, 8, 9, 10, 11, 16]
        assert all(payload == bytes([number]) * 99 for _, number, _, payload, *_ in copied.given[:-1])
        copied.close()


def test_who_waits_is_woken_once_much_is_there_and_not_before(library: RelayLibrary, folder: Path) -> None:
    clock = ListedRcl()
    with copies_on(clock, folder, wakes_from_bytes=3 * HEADER_BYTES) as copies:
        copied = CopiedTopics(library, copies, 1)
        poll = select.epoll()
        poll.register(copies.event_fd, select.EPOLLIN | select.EPOLLET)
        woken = []
        for number in range(1, 10):
            copied.send(0, number, FIRST, b"")
            woken += [number for _ in poll.poll(0)]
            if number == 5:
                copies.deliver(0)
        assert woken == [3, 8]
        poll.close()
        copied.close()


def test_a_source_that_is_removed_leaves_the_others_theirs(library: RelayLibrary, folder: Path) -> None:
    clock = ListedRcl()
    with copies_on(clock, folder) as copies:
        copied = CopiedTopics(library, copies, 2)
        copied.send(0, 1, FIRST, b"a")
        copied.send(1, 1, FIRST, b"b")
        copied.end(0)
        copied.send(1, 2, FIRST, b"c")
        copies.deliver(0)
        assert [one[3] for one in copied.given] == [b"a", b"b", b"c"]
        copied.close()

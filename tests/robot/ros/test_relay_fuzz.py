# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""relay.c gets whatever a middleware could give: any sizes, GIDs, numbers and times; UBSan looks on."""

from __future__ import annotations

import random
from collections import Counter, deque
from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiled_relay import GID_BYTES, ListedRcl, library_in
from pacing.scenarios import seeds
from smarttestudo.domain.compiled_relay import MAX_PERIOD_NS
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.grid import NEVER_NS
from smarttestudo.robot.ros.rcl.relay_library import RelayLibrary
from smarttestudo.robot.ros.rcl.subscription import MAX_PUBLISHERS, MessageNumbers

pytestmark = pytest.mark.contract

SANITIZED = ("-g", "-fsanitize=undefined", "-fno-sanitize-recover=all")
LATEST_NS = (1 << 62) - 1
"""In the year 2116."""


@pytest.fixture(scope="module")
def library(compiled_relays: None, tmp_path_factory: pytest.TempPathFactory) -> RelayLibrary:
    return library_in(tmp_path_factory.mktemp("sanitized"), *SANITIZED)


def any_size(chance: random.Random) -> int:
    return chance.choice([0, 1, 15, 16, 17, chance.randrange(200), int(10 ** chance.uniform(0, 5))])


def any_number(chance: random.Random, before: int) -> int:
    near = before + chance.choice([-1, 0, 1, 1, 1, 1, 2, 9])
    return (near if chance.random() < 0.8 else chance.getrandbits(chance.randint(1, 64))) % (1 << 64)


def messages(chance: random.Random, count: int) -> Iterator[tuple[bytes, int, bytes]]:
    """So many of them: publisher, number, content."""
    publishers = [chance.randbytes(GID_BYTES) for _ in range(chance.choice([1, 2, 3, MAX_PUBLISHERS + 5]))]
    publishers[0] = chance.choice([bytes(GID_BYTES), b"\xff" * GID_BYTES, publishers[0]])
    number = 0
    for index in range(count):
        number = any_number(chance, number)
        yield chance.choice(publishers), number, (index.to_bytes(4, "little") * (any_size(chance) // 4 + 1))


@settings(max_examples=300)
@given(seeds, st.integers(1, 300))
def test_at_full_all_pass_but_those_that_came_before_and_are_counted_as_in_python(
    library: RelayLibrary, seed: int, count: int
) -> None:
    chance, rcl, numbers = random.Random(seed), ListedRcl(), MessageNumbers()
    relay = library.new(rcl.settings())
    for sent in messages(chance, count):
        rcl.to_take.append(sent)
        library.step(relay)
        publisher, number, content = sent
        assert rcl.published == ([content] if numbers.is_new(publisher, number) else [])
        rcl.published.clear()
    counts = library.counts(relay)
    assert (counts.sent, counts.lost) == (numbers.sent % (1 << 64), numbers.lost % (1 << 64))
    assert counts.arrived.messages == counts.relayed.messages <= count
    library.free(relay)


@settings(max_examples=300)
@given(seeds, st.integers(1, 300))
def test_at_any_pace_and_on_any_clock_what_passes_came_in_that_order(
    library: RelayLibrary, seed: int, count: int
) -> None:
    chance, rcl = random.Random(seed), ListedRcl()
    relay = library.new(rcl.settings(takes_on_callback=chance.randint(0, 1)))
    came: dict[bytes, bytes] = {}
    last: dict[bytes, int] = {}
    for publisher, number, filling in messages(chance, count):
        rcl.now_ns = any_time(chance, rcl.now_ns)
        content = filling[:4] + publisher + filling
        came[content] = publisher
        rcl.to_take.append((publisher, number, content))
        if chance.random() < 0.2:
            period_ns = chance.choice([0, 1, NS_PER_S, MAX_PERIOD_NS, NEVER_NS, chance.getrandbits(50)])
            library.set_pace(relay, period_ns)
        if chance.random() < 0.8:
            library.step(relay)
        for passed in drained(rcl.published):
            index = int.from_bytes(passed[:4], "little")
            assert last.get(came[passed], -1) < index
            last[came[passed]] = index
    while rcl.to_take:
        library.step(relay)
    counts = library.counts(relay)
    assert counts.relayed.messages <= counts.arrived.messages <= count
    for stream in library.streams(relay):
        held = stream.paced_stream(GID_BYTES).held
        assert held is None or held[:] in came
    library.free(relay)


def any_time(chance: random.Random, now_ns: int) -> int:
    kind = chance.random()
    if kind < 0.05:
        return chance.choice([0, LATEST_NS, chance.getrandbits(62)])
    return max(0, min(now_ns + int(10 ** chance.uniform(0, 10)) - (kind < 0.1) * NS_PER_S, LATEST_NS))


def drained(published: list[bytes]) -> Iterator[bytes]:
    waiting = deque(published)
    published.clear()
    yield from waiting


HOURS = 12
PUBLISHERS = 200
SOURCE_NS = NS_PER_S
TARGET_NS = 4 * NS_PER_S


def test_two_hundred_publishers_come_and_go_in_twelve_hours_and_each_is_relayed_at_its_rate(
    library: RelayLibrary,
) -> None:
    rcl = ListedRcl()
    relay = library.new(rcl.settings(period_ns=TARGET_NS))
    messages = HOURS * 3600 * NS_PER_S // SOURCE_NS // PUBLISHERS
    for publisher in range(PUBLISHERS):
        gid = publisher.to_bytes(GID_BYTES, "little")
        for number in range(1, messages + 1):
            rcl.now_ns += SOURCE_NS
            rcl.to_take.append((gid, number, gid))
            library.step(relay)
    rcl.now_ns += TARGET_NS
    library.step(relay)
    each = messages * SOURCE_NS // TARGET_NS
    relayed = Counter(rcl.published)
    assert len(relayed) == PUBLISHERS
    assert all(each <= count <= each + 2 for count in relayed.values())
    library.free(relay)

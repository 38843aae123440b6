# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Datagrams over any radio: what must arrive does, once and in order; all else arrives or is counted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.protocol.lossy_ends import PROFILES, Boot, LossyEnds, Profile, Radio, lossy_ends
from link.protocol.simulated_link import MS, S, Source, quantile
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.link.protocol.chunks import CONTROL_STREAM, Chunk, LostSpan, ReceivedSessions
from smarttestudo.link.protocol.ordered_parts import OrderedParts

SENT_S = 3.0
SETTLED_S = 60
"""By then it is known of each message what became of it, on the worst of these radios."""
SOURCES = (
    Source(topic="/odom", size_bytes=720, rate_hz=25, from_s=0.3, to_s=SENT_S),
    Source(topic="/slow", size_bytes=300, rate_hz=1.5, from_s=0.3, to_s=SENT_S),
    Source(topic="/image", size_bytes=9_000, rate_hz=6, from_s=0.3, to_s=SENT_S),
    Source(topic="/events", size_bytes=2_500, rate_hz=8, from_s=0.3, to_s=SENT_S),
    Source(topic="/map", size_bytes=5_000, rate_hz=1.0, from_s=0.3, to_s=SENT_S, transient_local=True),
)
NEEDS = {"/odom": LinkNeeds(priority=2), "/events": LinkNeeds(is_full=True)}

profiles = st.builds(
    Profile,
    delay_ms=st.integers(1, 150),
    jitter_ms=st.integers(0, 60),
    lost_percent=st.integers(0, 40),
    mbit_per_s=st.sampled_from((0.5, 2, 10)),
    queue_bytes=st.sampled_from((12_000, 64_000)),
    copied_percent=st.sampled_from((0, 5)),
    reorders=st.booleans(),
)
# Eighths of a second are whole in floats.
times_ns = st.integers(1, 28).map(lambda eighths: eighths * 125 * MS)
outages = st.lists(st.tuples(times_ns, st.integers(1, 20)), max_size=2).map(
    lambda spans: [(at_ns, at_ns + eighths * 125 * MS) for at_ns, eighths in spans]
)
waits_ns = st.integers(1, 12).map(lambda eighths: eighths * 125 * MS)
events = st.one_of(
    st.fixed_dictionaries(
        {"what": st.just("operator"), "back_ns": waits_ns, "key_ns": waits_ns, "is_noticed": st.booleans()}
    ),
    st.fixed_dictionaries({"what": st.just("robot"), "key_ns": waits_ns}),
    st.fixed_dictionaries({"what": st.just("cut"), "back_ns": waits_ns}),
    st.fixed_dictionaries({"what": st.just("udp"), "has_datagrams": st.booleans()}),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A radio, and what happens: outages, ends that restart, a link that is cut, blocked UDP."""

    profile: Profile
    seed: int
    outages: Sequence[tuple[int, int]] = ()
    events: Sequence[tuple[int, Mapping[str, Any]]] = ()


cases = st.builds(
    Case,
    profile=profiles,
    seed=st.integers(0, 10_000),
    outages=outages,
    events=st.lists(st.tuples(times_ns, events), max_size=3),
)


def run(case: Case) -> LossyEnds:
    ends = lossy_ends(case.profile, SOURCES, case.seed, case.outages)
    for at_ns, event in case.events:
        ends.at(at_ns, partial(_happen, ends, event))
    ends.sender.follow(NEEDS)
    ends.run(SENT_S + 4)
    seconds = SENT_S + 4
    while (kept := kept_by(ends)) and seconds < SETTLED_S:
        seconds += 0.5
        ends.go_on(seconds)
    assert kept == []
    # Whatever is still under way comes, and changes nothing.
    ends.go_on(seconds + 3)
    boot = ends.boots[-1]
    boot.missed += boot.sender.take_missed(int(seconds + 3) * S)
    return ends


def _happen(ends: LossyEnds, event: Mapping[str, Any], now_ns: int) -> None:
    what = {name: value for name, value in event.items() if name != "what"}
    match event["what"]:
        case "operator":
            ends.restart_operator(now_ns, **what)
        case "robot":
            ends.restart_robot(now_ns, **what)
            ends.sender.follow(NEEDS)
        case "cut":
            ends.cut(now_ns, **what)
        case "udp":
            ends.allow(now_ns, **what)


def numbers(payloads: Iterable[bytes]) -> list[int]:
    return [int.from_bytes(payload[:8], "little") for payload in payloads]


def missed_numbers(boot: Boot, topic: str) -> set[int]:
    """The messages of a topic that were missed, each once."""
    found = numbers(one.payload for one in boot.missed if one.origin.topic == topic)
    assert len(found) == len({*found})
    return {*found}


def require_law(case: Case) -> None:
    """Each message arrives or is counted; what must arrive does, once and in order; nothing is kept."""
    ends = run(case)
    for boot in ends.boots:
        for source in SOURCES:
            missed = missed_numbers(boot, source.topic)
            for operator in boot.operators:
                arrived = operator.arrived[source.topic]
                assert arrived == sorted({*arrived})
                assert missed & operator.reported[source.topic] == set()
    last = ends.boots[-1]
    for source in SOURCES:
        require_all_known(last, source.topic)
    if len(last.operators) == 1:
        # Who comes while another is served hears of topics in the middle.
        assert last.operators[0].receiver.counts.malformed == 0
    assert last.sender.is_settled


def require_all_known(boot: Boot, topic: str) -> None:
    """It is known what became of each message of a run of the robot's end that goes on."""
    counts, offered = boot.sender.counts(SETTLED_S * S)[topic], {*numbers(boot.payloads[topic])}
    missed, here = missed_numbers(boot, topic), boot.operators[-1].arrived[topic]
    assert missed & {*here} == set()
    arrived = {number for operator in boot.operators for number in operator.arrived[topic]}
    lost = counts.lost_replaced + counts.lost_late
    gone = counts.replaced + counts.overflowed + lost
    assert len(offered - arrived - missed) <= gone
    if boot.sender.scheduler.session == 1:
        # None was under way as a session ended.
        assert len(arrived) + gone == len(offered)
    if topic == "/map":
        assert here == sorted(offered)
    if topic == "/events":
        assert len(offered - arrived) <= counts.overflowed


def kept_by(ends: LossyEnds) -> list[object]:
    """What is kept of messages of which it is not known yet what became of them."""
    outbox, ordered = ends.sender.scheduler.outbox, ends.receiver._ordered
    parts, kept = outbox._parts, list[object](one for one in outbox._streams.values() if one.has_work)
    # How long a round trip takes is said again and again.
    kept += [message for _, message in outbox._all_under_way() if message.stream != CONTROL_STREAM]
    kept += [*outbox.fates._ended, *outbox.fates._given_up]
    if parts is not None:
        kept += [sent for sent in parts._open if sent.stream.number != CONTROL_STREAM]
        kept += [part for part in parts._parts.values() if part.sent.stream.number != CONTROL_STREAM]
        kept += parts._given_up
    if ordered is not None:
        kept += ordered._waiting.values()
        # What was given up of others goes with the next message of its stream, or the session.
        partials = [one for of_stream in ordered._parts._partials.values() for one in of_stream.values()]
        kept += [one for one in partials if one.is_in_order]
    return kept


FOUND = {
    "one that comes has what another was sent, which was killed": Case(
        profile=Profile(
            delay_ms=62, jitter_ms=36, lost_percent=26, mbit_per_s=10, queue_bytes=64_000, reorders=True
        ),
        seed=212_962,
        outages=[(1_250 * MS, 1_750 * MS)],
        events=[
            (2_625 * MS, {"what": "operator", "back_ns": 250 * MS, "key_ns": 875 * MS, "is_noticed": False}),
            (1_750 * MS, {"what": "robot", "key_ns": 1_125 * MS}),
        ],
    ),
    "all is acknowledged after it counted as lost, in a queue of a second": Case(
        profile=Profile(delay_ms=37, jitter_ms=35, lost_percent=30, mbit_per_s=0.5, queue_bytes=64_000),
        seed=593,
        outages=[(375 * MS, 2_500 * MS), (1_250 * MS, 3_750 * MS)],
    ),
    "a report comes after both links were cut": Case(
        profile=Profile(
            delay_ms=25, jitter_ms=29, lost_percent=27, mbit_per_s=10, queue_bytes=64_000, copied_percent=5
        ),
        seed=9_065,
        outages=[(1_875 * MS, 4_375 * MS), (1_125 * MS, 2_500 * MS)],
        events=[
            (375 * MS, {"what": "udp", "has_datagrams": False}),
            (875 * MS, {"what": "operator", "back_ns": 875 * MS, "key_ns": 500 * MS, "is_noticed": False}),
            (375 * MS, {"what": "cut", "back_ns": 1_500 * MS}),
        ],
    ),
    "an outage begins before what arrived is reported": Case(
        profile=Profile(
            delay_ms=29, jitter_ms=48, lost_percent=0, mbit_per_s=2, queue_bytes=64_000, copied_percent=5
        ),
        seed=4_055,
        outages=[(1_750 * MS, 3_500 * MS)],
    ),
}
"""Radios on which a message was once counted twice, or not at all."""


@pytest.mark.parametrize("case", FOUND.values(), ids=FOUND)
def test_so_it_is_where_it_once_was_not(case: Case) -> None:
    require_law(case)


@settings(max_examples=300)
@given(cases)
def test_each_message_arrives_or_is_counted_over_any_radio(case: Case) -> None:
    require_law(case)


@pytest.mark.full
@settings(max_examples=2_000)
@given(cases)
def test_so_it_is_over_thousands_of_radios(case: Case) -> None:
    require_law(case)


@pytest.mark.parametrize("name", PROFILES)
def test_small_topics_stay_fresh_beside_images_that_fill_the_radio(name: str) -> None:
    profile = PROFILES[name]
    image_bytes = int((1.2 * profile.mbit_per_s * 125_000 - 36_000) / 10)
    sources = (
        Source(topic="/odom", size_bytes=720, rate_hz=25, from_s=0.3),
        Source(topic="/imu", size_bytes=320, rate_hz=50, from_s=0.3),
        Source(topic="/image", size_bytes=image_bytes, rate_hz=10, from_s=0.3),
    )
    ends = lossy_ends(profile, sources)
    ends.sender.follow({"/odom": LinkNeeds(priority=2), "/imu": LinkNeeds(priority=2)})
    ends.run(16)
    most_s = (profile.delay_ms + profile.jitter_ms + 60) / 1_000
    for source in sources[:2]:
        ages_s = ends.ages_s(source.topic, 6, 16)
        assert quantile(ages_s, 0.95) <= most_s
        assert len(ages_s) >= 0.9 * (1 - profile.lost_percent / 100) * source.rate_hz * 10
    assert len(ends.ages_s("/image", 6, 16)) >= 40


def test_where_datagrams_are_blocked_while_the_link_goes_on_it_carries_all_within_two_seconds() -> None:
    sources = (
        Source(topic="/odom", size_bytes=720, rate_hz=25, from_s=0.3, to_s=10),
        Source(topic="/events", size_bytes=2_500, rate_hz=8, from_s=0.3, to_s=10),
    )
    ends = lossy_ends(PROFILES["wifi-walls"], sources)
    ends.up.outages = [(4 * S, 100 * S)]
    ends.sender.follow(NEEDS)
    ends.run(12)
    times_ns = [at_ns for at_ns, _ in ends.arrived["/odom"]]
    assert max(after - before for before, after in pairwise(times_ns)) < 2 * S
    assert ends.operator.arrived["/events"] == numbers(ends.payloads["/events"])


def test_where_datagrams_are_not_preferred_they_are_used_while_the_radio_loses_some() -> None:
    ends = lossy_ends(PROFILES["clean"], SOURCES[:1])
    ends.sender.prefers_datagrams = False
    uses = dict[int, bool]()

    def ping(now_ns: int) -> None:
        second = now_ns // S
        # Of those of the last minute, two are lost from the 15th to the 75th second.
        ends.sender.note_pings(now_ns, sent=1, lost=int(second in {12, 15, 18} and now_ns % S == 0))
        uses[second] = ends.sender.state(now_ns).by_datagrams
        ends.at(now_ns + S // 2, ping)

    ends.at(S, ping)
    ends.run(100)
    assert [second for second, is_by_datagrams in uses.items() if is_by_datagrams] == list(range(15, 76))


def test_the_bytes_of_each_topic_and_of_what_is_sent_again_are_counted() -> None:
    clean, walls = (lossy_ends(PROFILES[name], SOURCES) for name in ("clean", "wifi-walls"))
    for ends in (clean, walls):
        ends.sender.follow(NEEDS)
        ends.run(SENT_S + 4)
        counts = ends.sender.counts(SETTLED_S * S)
        control = ends.sender.scheduler.outbox._streams[CONTROL_STREAM]
        in_all = control.sent_bytes + sum(one.sent_bytes for one in counts.values())
        assert in_all == ends.sender.state(SETTLED_S * S).sent_bytes
        events, offered = counts["/events"], sum(map(len, ends.payloads["/events"]))
        assert offered < events.sent_bytes - events.repair_bytes < 1.1 * offered
    assert sum(one.repair_bytes for one in clean.sender.counts(SETTLED_S * S).values()) == 0
    # It loses 8 % in runs.
    assert 0.02 < events.repair_bytes / events.sent_bytes < 0.3


def test_a_robot_that_loses_the_reliable_link_alone_goes_on_by_datagrams() -> None:
    ends = lossy_ends(PROFILES["wifi-walls"], SOURCES)
    ends.sender.follow(NEEDS)
    ends.at(S, partial(ends.cut, back_ns=5 * S))
    ends.run(5)
    assert ends.operator.arrived["/events"] == numbers(ends.payloads["/events"])
    assert max(after - before for before, after in pairwise(at_ns for at_ns, _ in ends.arrived["/odom"])) < S


def test_a_late_report_by_datagram_of_an_end_that_left_keeps_no_other_from_being_served() -> None:
    ends = lossy_ends(PROFILES["severe"], SOURCES[:1])
    ends.at(1 * S, partial(ends.restart_operator, back_ns=S // 10, key_ns=S, is_noticed=True))
    ends.run(2)
    assert ends.operator.arrived["/odom"]


def test_a_copy_of_a_message_that_waits_for_others_leaves_nothing() -> None:
    ordered = OrderedParts()
    parts = [Chunk(1, 0, 1, 1, at, 2, 0, 0, False, True, b"x", 1, True) for at in (0, 1)]
    for at, part in enumerate((*parts, *parts)):
        assert [*ordered.add(part, LostSpan(at, at + 1), 0)] == []
    first = Chunk(1, 0, 1, 0, 0, 1, 0, 0, False, True, b"x", 0, True)
    assert [one.chunk.number for one in ordered.add(first, LostSpan(9, 10), 0)] == [0, 1]
    assert not ordered._parts._partials


def test_a_policer_that_drops_what_is_too_fast_is_given_less() -> None:
    # It has no queue that a round trip could show.
    profile = Profile(delay_ms=20, jitter_ms=0, lost_percent=0, mbit_per_s=2, queue_bytes=3_000)
    sources = (Source(topic="/image", size_bytes=30_000, rate_hz=20),)
    ends = lossy_ends(profile, sources)
    ends.run(10)
    dropped = ends.up.overflowed
    ends.run(20)
    assert ends.up.overflowed - dropped < 0.3 * (ends.up.sent / 2)


parts = st.lists(st.integers(0, 30), min_size=1, max_size=120)


@given(parts, st.integers(1, 1_168))
def test_what_is_acknowledged_has_arrived(order: list[int], size_bytes: int) -> None:
    sessions, seen = ReceivedSessions(), set[int]()
    for place in order:
        span = sessions.on_datagram(_chunk(place * size_bytes), size_bytes)
        assert (span is not None) == (place not in seen)
        seen.add(place)
        acknowledged = {one for one in range(31) if sessions.newest.has((one + 1) * size_bytes)}
        assert acknowledged == seen


def _chunk(offset_bytes: int) -> Chunk:
    return Chunk(1, offset_bytes, 1, 0, 0, 1, 0, 0, False, False, b"x")


def test_radios_of_the_same_seed_are_alike() -> None:
    one, other = Radio(PROFILES["4g"], 3), Radio(PROFILES["4g"], 3)
    arrivals = [radio.arrivals_ns(500, number * MS) for radio in (one, other) for number in range(500)]
    assert arrivals[:500] == arrivals[500:]

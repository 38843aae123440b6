# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A gap that is fetched later: byte-identical, beside live topics that do not notice, coarse first."""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.protocol.simulated_link import Ends, Link, S, Source, quantile
from link.transfer.fetched_path import path_errors
from link.transfer.simulated_fetch import (
    GAP,
    LIVE,
    NEEDS,
    SPARE_LINK,
    Answering,
    Contents,
    FetchingEnds,
    Recorded,
    spare_link,
)
from smarttestudo.link.protocol.sender import LinkSender

GAP_S = 60.0
FROM_S = 10.0
RUN_S = 120.0


def ages_s(ends: Ends, from_s: float, to_s: float) -> list[float]:
    return [age for source in LIVE for age in ends.ages_s(source.topic, from_s, to_s)]


@pytest.mark.parametrize("delay_s", [0.002, 0.02, 0.1])
@pytest.mark.full
def test_a_gap_of_a_minute_comes_whole_and_live_ages_hardly_grow(delay_s: float) -> None:
    contents = Contents.of(GAP, GAP_S)
    before = Ends(spare_link(delay_s), LIVE)
    ends = FetchingEnds(spare_link(delay_s), LIVE, contents=contents, from_s=FROM_S)
    for one in (before, ends):
        one.sender.follow(NEEDS)
        one.run(RUN_S)
    assert ends.done_ns is not None
    assert ends.has_all
    assert ends.sent_bytes == contents.order.size_bytes, "no byte travels twice"
    span = FROM_S, ends.done_ns / S
    assert quantile(ages_s(ends, *span), 0.95) <= 1.1 * quantile(ages_s(before, *span), 0.95)
    for source in LIVE:
        assert len(ends.ages_s(source.topic)) >= 0.99 * len(before.ages_s(source.topic))
    spare_bytes_per_s = SPARE_LINK - before.link.carried_bytes / RUN_S
    assert contents.order.size_bytes / (ends.done_ns / S - FROM_S) > 0.6 * spare_bytes_per_s


def test_without_live_topics_a_fetch_takes_nearly_all_of_the_link() -> None:
    contents = Contents.of(GAP, GAP_S)
    ends = FetchingEnds(spare_link(), (), contents=contents, is_live=False)
    ends.run(30)
    assert ends.done_ns is not None
    assert ends.has_all
    assert contents.order.size_bytes / (ends.done_ns / S) > 0.5 * SPARE_LINK


@pytest.mark.parametrize("live", [(), LIVE], ids=["alone", "beside live topics"])
@pytest.mark.parametrize("budget_bytes_per_s", [4_000.0, 20_000.0])
@pytest.mark.full
def test_a_fetch_keeps_to_its_budget_and_uses_it(live: Sequence[Source], budget_bytes_per_s: float) -> None:
    contents = Contents.of(GAP, 20.0)
    sender: LinkSender[Answering] = LinkSender(fetch_budget_bytes_per_s=budget_bytes_per_s)
    ends = FetchingEnds(
        spare_link(), live, sender=sender, contents=contents, is_live=bool(live), ends_when_done=True
    )
    sender.follow(NEEDS)
    ends.run(1000)
    assert ends.done_ns is not None
    assert ends.has_all
    least_s = contents.order.size_bytes / budget_bytes_per_s
    assert least_s - 1 < ends.done_ns / S < 1.3 * least_s
    for (at_ns, cursor), (later_ns, later) in itertools.combinations(ends.progress[::7], 2):
        assert later - cursor < budget_bytes_per_s * ((later_ns - at_ns) / S + 2)


def test_without_a_budget_nothing_is_fetched() -> None:
    sender: LinkSender[Answering] = LinkSender(fetch_budget_bytes_per_s=0.0)
    ends = FetchingEnds(spare_link(), LIVE, sender=sender, contents=Contents.of(GAP, 5.0))
    ends.run(30)
    assert not ends.sent_bytes
    assert not ends.progress


def test_what_the_link_carries_is_learned_though_live_topics_need_little() -> None:
    contents = Contents.of((Recorded(topic="/cloud", size_bytes=100_000, rate_hz=2),), GAP_S)
    ends = FetchingEnds(Link(((0.0, 2_000_000.0),), 0.02), LIVE[:1], contents=contents)
    ends.run(60)
    assert ends.done_ns is not None
    assert contents.order.size_bytes / (ends.done_ns / S) > 200_000


def test_topics_that_need_all_of_the_link_leave_nothing() -> None:
    ends = FetchingEnds(
        Link(((0.0, 100_000.0), (20.0, SPARE_LINK)), 0.02), LIVE, contents=Contents.of(GAP, 5.0), from_s=5.0
    )
    ends.run(60)
    meanwhile = [cursor for at_ns, cursor in ends.progress if 6 * S < at_ns < 20 * S]
    assert not meanwhile or meanwhile[-1] < 0.2 * ends.contents.order.size_bytes
    assert ends.done_ns is not None


def test_what_is_urgent_comes_though_topics_need_all_of_the_link_and_takes_a_fifth_of_it_at_most() -> None:
    rate_bytes_per_s = 100_000.0
    contents = Contents.of(GAP, 5.0)
    ends = FetchingEnds(
        Link(((0.0, rate_bytes_per_s),), 0.02), LIVE, contents=contents, from_s=10.0, is_urgent=True
    )
    ends.run(60)
    assert ends.done_ns is not None
    assert ends.has_all
    share = contents.order.size_bytes / (ends.done_ns / S - 10.0) / rate_bytes_per_s
    assert 0.1 < share < 0.25


def test_after_a_tenth_of_the_bytes_the_path_is_nearly_right() -> None:
    contents = Contents.of(GAP, GAP_S)
    errors = path_errors(contents, 0.1)
    assert errors.coarse_first_m <= 0.2 * errors.nothing_m
    assert min(errors.in_order_m, errors.newest_first_m) > 0.5 * errors.nothing_m


rates = st.sampled_from([3_000.0, 60_000.0, 400_000.0, 3_000_000.0])


@cache
@st.composite
def troubled_links(draw: st.DrawFn) -> Link:
    """Up to four changes of the rate in half a minute, outages among them; then it is a good one."""
    times = sorted(draw(st.lists(st.floats(0.5, 30.0), max_size=4)))
    steps = [(0.0, draw(rates)), *((at_s, draw(st.just(0.0) | rates)) for at_s in times), (31.0, 400_000.0)]
    return Link(steps, draw(st.floats(0.001, 0.3)))


@settings(max_examples=50)
@given(
    troubled_links(),
    st.tuples(st.lists(st.floats(0.1, 40.0), max_size=3), st.floats(0.0, 0.3), st.integers(0, 2**32)),
    st.lists(
        st.builds(
            Recorded,
            topic=st.sampled_from(["/a", "/b"]),
            size_bytes=st.integers(31, 5_000),
            rate_hz=st.floats(1.0, 10.0),
        ),
        max_size=3,
    ),
)
def test_through_losses_cuts_and_restarts_the_bytes_are_those_of_the_robot(
    link: Link, trouble: tuple[list[float], float, int], topics: list[Recorded]
) -> None:
    restarts_s, lost_share, seed = trouble
    is_live = seed % 2 == 0
    contents = Contents.of(topics, 4.0, seed)
    rng = random.Random(seed)
    ends = FetchingEnds(
        link,
        LIVE[:2] if is_live else (),
        contents=contents,
        is_live=is_live,
        ends_when_done=True,
        loses=lambda now_ns: now_ns < 40 * S and rng.random() < lost_share,
    )
    for at_s in restarts_s:
        ends.at(int(at_s * S), ends.restart)
    ends.run(400)
    assert ends.done_ns is not None
    assert ends.has_all
    assert ends.sent_bytes <= contents.order.size_bytes + ends.lost_bytes

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a link is told of the rules, what the loop and the log are told of the link, and when."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from loop.loop_driver import LoopDriver, rule_set_of
from robot.memory_link import MemoryLink
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.domain.observation import LinkBudget
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.parts.live_link import MOST_LINES, REFILL_NS, LinkWatch, OperatorLog
from smarttestudo.link.protocol.outbox import Outbox
from smarttestudo.link.protocol.outgoing_stream import Encoded
from smarttestudo.robot.live_rules import LiveRules

RULES = """\
begin
    SetFrequency /image Full
    SetFrequency /scan 10
    KeepAtLeast /scan 2
    Rule "near" If (CheckValue /odom pose_x < 3) Then SetFrequency /scan Full EndIf
end
"""
PROFILE = Profile(
    topics={
        "/image": TopicProfile(priority=0.5, min_hz=1.0),
        "/scan": TopicProfile(priority=3.0, min_hz=1.0),
    },
    settle_s=0.0,
)


def live_rules(profile: Profile = PROFILE) -> LiveRules:
    rule_set = rule_set_of(RULES)
    return LiveRules(
        rule_set=rule_set,
        output_topics={topic: f"/operator{topic}" for topic in rule_set.relayed},
        profile=profile,
    )


def told(watch: LinkWatch, link: MemoryLink, *budgets_kb_per_s: float | None) -> list[LinkBudget | None]:
    """What the loop is told as the link carries one budget after the other, a second each."""
    changes = []
    for second, link.budget_kb_per_s in enumerate(budgets_kb_per_s):
        changes.append(watch.changed_budget(second * NS_PER_S))
    return changes


def test_topics_have_their_output_names_priorities_greater_floors_and_whether_they_are_full() -> None:
    link, robot = MemoryLink(), LoopDriver(RULES, PROFILE)
    robot.drive(0, 5.0, 0.0)
    LinkWatch(link).follow(live_rules(), robot.loop.knowledge.plan)
    assert link.followed == [
        {
            "/operator/image": LinkNeeds(priority=0.5, floor_hz=1.0, is_full=True),
            "/operator/scan": LinkNeeds(priority=3.0, floor_hz=2.0, is_full=False),
            "/testudo/decisions": LinkNeeds(priority=math.inf),
        }
    ]


def test_what_a_rule_notifies_of_goes_before_all_topics() -> None:
    outbox = Outbox(lambda _, payload: Encoded(payload))
    needs = {11: LinkNeeds(priority=1e6, floor_hz=100.0), 12: LinkNeeds(priority=math.inf)}
    for stream, depth in ((11, None), (12, 100)):
        outbox.open(stream, depth=depth)
        outbox.set_needs(stream, needs[stream])
    outbox.put(11, b"image" * 1000, 0)
    first = outbox.next_chunk(1, 1000, 0)
    assert first is not None
    assert first.stream == 11
    outbox.put(12, b"notice", 0)
    second = outbox.next_chunk(1, 1000, 0)
    assert second is not None
    assert second.stream == 12


def test_a_topic_that_a_rule_makes_full_queues_from_then_on() -> None:
    link, robot = MemoryLink(), LoopDriver(RULES, PROFILE)
    watch = LinkWatch(link)
    robot.drive(0, 5.0, 0.0)
    watch.follow(live_rules(), robot.loop.knowledge.plan)
    robot.drive(1_000_000_000, 1.0, 0.0)
    watch.follow(live_rules(), robot.loop.knowledge.plan)
    assert [needs["/operator/scan"].is_full for needs in link.followed] == [False, True]


def test_the_link_is_told_once_of_what_stays_the_same_and_again_of_another_profile() -> None:
    link, robot = MemoryLink(), LoopDriver(RULES, PROFILE)
    watch, other = LinkWatch(link), replace(PROFILE, topics={"/scan": TopicProfile(min_hz=4.0)})
    for profile in (PROFILE, PROFILE, other, other):
        watch.follow(live_rules(profile), robot.loop.knowledge.plan)
    assert [needs["/operator/scan"].floor_hz for needs in link.followed] == [2.0, 4.0]


def test_nothing_is_told_while_nothing_is_known_of_the_link() -> None:
    link = MemoryLink()
    assert told(LinkWatch(link), link, None, None) == [None, None]


def test_what_the_link_carries_is_told_as_measured() -> None:
    link = MemoryLink()
    assert told(LinkWatch(link), link, None, 100.0) == [
        None,
        LinkBudget(link_kb_per_s=100.0, is_measured=True),
    ]


def test_only_a_budget_that_clearly_changed_since_it_was_told_is_told_again() -> None:
    link = MemoryLink()
    budgets = (100.0, 96.0, 109.0, 94.0, 100.0, 104.0, None, 90.0, 88.0)
    changes = told(LinkWatch(link), link, *budgets)
    assert [None if one is None else one.link_kb_per_s for one in changes] == [
        *(100.0, None, None, 94.0, None),
        *(104.0, None, 90.0, None),
    ]


def test_a_link_that_carries_nothing_any_more_is_told_once_and_so_is_its_return() -> None:
    link = MemoryLink()
    changes = told(LinkWatch(link), link, 50.0, 0.0, 0.0, 50.0)
    assert [None if one is None else one.link_kb_per_s for one in changes] == [50.0, 0.0, None, 50.0]


def test_rates_that_the_link_nearly_carries_swing_ever_less_often() -> None:
    link = MemoryLink()
    watch, rises_s = LinkWatch(link), []
    has_risen = False
    for quarter in range(4 * 120):
        # The link carries 100; whenever the plan takes more, that shows half a second later.
        link.budget_kb_per_s = 100.0 if has_risen else 140.0
        change = watch.changed_budget(quarter * NS_PER_S // 4)
        if change is not None:
            has_risen = change.link_kb_per_s > 100
            rises_s += [quarter / 4] * has_risen
    waits_s = [after - before for before, after in pairwise(rises_s)]
    assert waits_s == sorted(waits_s)
    assert len(rises_s) <= 8
    assert waits_s[-1] >= 30


def test_a_rise_that_held_makes_the_next_one_quick_again() -> None:
    link = MemoryLink()
    watch = LinkWatch(link)
    swinging = (100.0, 140.0, 100.0, 140.0, 140.0, 100.0)
    assert [one is not None for one in told(watch, link, *swinging)] == [True, True, True, False, True, True]
    link.budget_kb_per_s = 140.0
    assert watch.changed_budget(30 * NS_PER_S) is not None
    link.budget_kb_per_s = 100.0
    assert watch.changed_budget(50 * NS_PER_S) is not None
    link.budget_kb_per_s = 140.0
    assert watch.changed_budget(51 * NS_PER_S) is not None


ADA, BOB = 0x1A2B << 48, 0x9 << 48


def said(*looks: tuple[float, set[int]]) -> list[str]:
    """What is said where so many seconds after the start these are there."""
    lines: list[str] = []
    log = OperatorLog(lines.append)
    for at_s, there in looks:
        log.look(frozenset(there), round(at_s * NS_PER_S))
    return lines


def test_who_came_and_left_is_said_once_each() -> None:
    assert said(
        (0, set()), (1, {ADA}), (2, {ADA}), (5, {ADA, BOB}), (60, {BOB}), (61, set()), (62, set())
    ) == [
        "operator 1a2b came over the link",
        "operator 0009 came over the link",
        "operator 1a2b left the link",
        "operator 0009 left the link; none is there now",
    ]


def test_how_long_nobody_was_there_is_said() -> None:
    assert said((0, {ADA}), (100, set()), (120, {BOB}))[1:] == [
        "operator 1a2b left the link; none is there now",
        "operator 0009 came over the link, after 20 s without any",
    ]


def test_one_that_gives_way_to_another_is_one_line() -> None:
    assert said((0, {ADA}), (100, {BOB}))[1:] == [
        "operator 1a2b left the link; operator 0009 came over the link"
    ]


def test_a_connection_that_flaps_is_summed_up() -> None:
    flaps = [(number * 0.5, {ADA} if number % 2 else set()) for number in range(100)]
    lines = said(*flaps, (60, {ADA}), (100, {ADA}))
    assert len(lines) == MOST_LINES + 2
    assert lines[-2:] == [
        "operator 1a2b came over the link; operators came or left 54 more times meanwhile",
        "operators came or left 38 more times meanwhile",
    ]


@given(
    st.lists(st.tuples(st.floats(0.01, 100), st.sets(st.integers(1, 2**64 - 1), max_size=3)), max_size=100)
)
def test_no_more_is_said_than_so_many_lines_and_in_the_end_all_of_it(
    looks: list[tuple[float, set[int]]],
) -> None:
    at_s, timed = 0.0, []
    for after_s, there in looks:
        at_s += after_s
        timed.append((at_s, there))
    lines = said(*timed)
    assert len(lines) <= MOST_LINES + at_s * NS_PER_S / REFILL_NS
    last = timed[-1][1] if timed else set()
    final = said(*timed, (at_s + 1000, last))
    if len(final) > len(lines) or lines:
        assert final[-1].endswith("none is there now") == (not last)
    else:
        assert not last

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a link is told of the rules, and when the loop is told what the link carries."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from loop.loop_driver import LoopDriver, rule_set_of
from robot.memory_link import MemoryLink
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.domain.observation import LinkBudget
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.parts.live_link import LinkWatch
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
        }
    ]


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

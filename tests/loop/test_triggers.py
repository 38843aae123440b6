# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""When a block begins to record: known to hold, and only again after it was known not to."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from incidents.incident_runs import rules_of
from smarttestudo.domain.profile import Profile
from smarttestudo.loop.inputs import LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.loop.relay_loop import RelayLoop

S = 1_000_000_000
RULES = """\
SetFrequency /odom 10
Rule "Far" If CheckValue /odom x > 5 Then
Record "far" Before 1 s After 1 s
Else
Record "near" /odom Before 1 s After 1 s
EndIf"""


class Driver:
    def __init__(self, rules: str = RULES) -> None:
        self.loop = RelayLoop(rules_of(rules), Profile(), 0)
        self.triggers = list(self.loop.triggers)
        self.now_s = 0.0

    def odom(self, x: float, *, after_s: float = 0.1) -> None:
        self.now_s += after_s
        self.handle(MessageInput(round(self.now_s * S), "/odom", b"", 0, SimpleNamespace(x=x)))

    def handle(self, given: LoopInput) -> None:
        self.loop.handle(given)
        self.triggers += self.loop.triggers

    @property
    def labels(self) -> list[str]:
        return [trigger.block.label for trigger in self.triggers]


def test_each_side_of_a_block_begins_when_it_begins_to_hold() -> None:
    driver = Driver()
    assert driver.labels == []
    for x in (1, 2, 7, 8, 3, 9):
        driver.odom(x)
    assert driver.labels == ["Far (Else)", "Far", "Far (Else)", "Far"]
    assert driver.triggers[1].stamp_ns == round(0.3 * S)
    assert driver.triggers[1].values == {"/odom x": 7}


def test_what_holds_from_the_start_begins_once() -> None:
    driver = Driver("""\
Rule "Dead" If CheckValue /scan rate < 1 Then
Record "dead lidar" /odom Before 1 s After 1 s
EndIf""")
    assert driver.labels == ["Dead"]
    assert (driver.triggers[0].stamp_ns, driver.triggers[0].values) == (0, {"/scan rate": 0})
    for _ in range(50):
        driver.odom(1)
    assert driver.labels == ["Dead"]


def test_a_value_that_was_in_doubt_for_a_while_does_not_begin_again() -> None:
    driver = Driver()
    for _ in range(6):
        driver.odom(7)
    driver.now_s += 60
    driver.handle(WakeInput(stamp_ns=round(driver.now_s * S)))
    driver.odom(7)
    assert driver.labels == ["Far"]
    driver.odom(1)
    driver.odom(7)
    assert driver.labels == ["Far", "Far (Else)", "Far"]


def test_a_reload_of_the_same_rule_does_not_begin_again() -> None:
    driver = Driver()
    driver.odom(7)
    rules = rules_of(f"KeepAtLeast /odom 1\n{RULES}")
    driver.handle(RulesInput(stamp_ns=round(driver.now_s * S), rule_set=rules, profile=Profile()))
    driver.odom(7)
    assert driver.labels == ["Far"]
    driver.odom(1)
    assert driver.labels == ["Far", "Far (Else)"]


UNNAMED = """\
SetFrequency /odom 10
// Far away
If CheckValue /odom x > 5 Then
Record "far" Before 1 s After 1 s
EndIf"""
NOT_COMMENTED = UNNAMED.replace("// Far away\n", "")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (UNNAMED, UNNAMED.replace("away", "away from home")),
        (NOT_COMMENTED, f"KeepAtLeast /odom 1\n{NOT_COMMENTED}"),
    ],
)
def test_a_reload_that_only_moves_or_comments_a_block_does_not_begin_again(before: str, after: str) -> None:
    driver = Driver(before)
    driver.odom(7)
    rules = rules_of(after)
    driver.handle(RulesInput(stamp_ns=round(driver.now_s * S), rule_set=rules, profile=Profile()))
    driver.odom(7)
    assert len(driver.triggers) == 1


def test_a_block_of_the_same_condition_that_comes_with_a_reload_begins() -> None:
    driver = Driver(UNNAMED)
    driver.odom(7)
    other = 'If CheckValue /odom x > 5 Then\nRecord "other" Before 1 s After 1 s\nEndIf'
    rules = rules_of(f"{other}\n{UNNAMED}")
    driver.handle(RulesInput(stamp_ns=round(driver.now_s * S), rule_set=rules, profile=Profile()))
    assert [one.block.recordings[0].name for one in driver.triggers] == ["far", "other"]


def test_a_record_without_topics_keeps_all_that_the_rules_name() -> None:
    rules = rules_of(f"SetFrequency /scan 3\n{RULES}")
    far, near = (block.recordings[0] for block in rules.blocks)
    assert far.topics == ("/scan", "/odom")
    assert near.topics == ("/odom",)


TIMED = """\
SetFrequency /odom 10
Rule "Stays" If CheckValue /odom x > 5 Until < 3 For 1500 ms Then
KeepWithin /odom x 0.5
Record "stays" Before 1 s After 1 s
EndIf"""


def test_a_condition_with_time_begins_at_its_nanosecond_and_not_again_with_other_rules() -> None:
    driver = Driver(TIMED)
    driver.odom(1)
    driver.odom(7)
    driver.odom(4, after_s=1.0)
    wake_ns = round(1.7 * S)
    driver.handle(WakeInput(stamp_ns=wake_ns - 1))
    assert driver.labels == []
    driver.handle(WakeInput(stamp_ns=wake_ns))
    assert [(one.block.label, one.stamp_ns) for one in driver.triggers] == [("Stays", wake_ns)]
    assert driver.triggers[0].values == {"/odom x": 4}
    assert driver.triggers[0].block.recordings[0].topics == ("/odom",)
    driver.now_s = 1.8
    others = rules_of(TIMED.replace("odom 10", "odom 5"))
    driver.handle(RulesInput(stamp_ns=round(driver.now_s * S), rule_set=others, profile=Profile()))
    driver.odom(4)
    assert driver.labels == ["Stays"]

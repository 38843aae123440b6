# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What blocks do: begun once, skipped when too soon, ended, by priority, and only what is allowed."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from types import SimpleNamespace

from hypothesis import given, settings
from hypothesis import strategies as st

from incidents.incident_runs import rules_of
from smarttestudo.domain.action import ActionDecision, ActionEvent, action_line
from smarttestudo.domain.decision import about_actions
from smarttestudo.domain.profile import Profile
from smarttestudo.loop.inputs import LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.loop.relay_loop import RelayLoop

S = 1_000_000_000
ALLOWED = Profile(
    allow_parameters={"/camera": frozenset({"quality"})}, allow_calls=frozenset({"/dock", "/light"})
)
FAR = """\
SetFrequency /odom 10
Rule "Far" If CheckValue /odom x > 5 Then
SetParameter /camera quality 40
Call /light true
Notify "far away"
Else
Call /dock
EndIf"""


class Driver:
    """A loop in virtual time, which wakes when it wants to."""

    def __init__(self, rules: str = FAR, profile: Profile = ALLOWED) -> None:
        self.loop = RelayLoop(rules_of(rules), profile, 0)
        self.actions = about_actions(self.loop.take_all_decisions())
        self.now_ns = 0

    def handle(self, given: LoopInput) -> None:
        self.loop.handle(given)
        self.actions += about_actions(self.loop.take_all_decisions())

    def wait(self, seconds: float) -> None:
        until_ns = self.now_ns + round(seconds * S)
        while (wake_ns := self.loop.next_wake_ns) is not None and wake_ns <= until_ns:
            self.now_ns = max(wake_ns, self.now_ns)
            self.handle(WakeInput(stamp_ns=self.now_ns))
        self.now_ns = until_ns

    def odom(self, x: float, *, after_s: float = 0.1, y: float = 0.0) -> None:
        self.wait(after_s)
        self.handle(MessageInput(self.now_ns, "/odom", b"", 0, SimpleNamespace(x=x, y=y)))

    def reload(self, rules: str, profile: Profile = ALLOWED) -> None:
        self.handle(RulesInput(stamp_ns=self.now_ns, rule_set=rules_of(rules), profile=profile))

    def take(self) -> list[str]:
        lines, self.actions = [line(one) for one in self.actions], []
        return lines


def line(decision: ActionDecision) -> str:
    return f"{decision.t_s:.1f} {action_line(decision)}"


def test_a_block_that_begins_does_all_that_it_says_and_its_end_gives_back() -> None:
    driver = Driver()
    assert driver.take() == []
    driver.odom(1)
    assert driver.take() == ["0.1 Call /dock: begin (Far (Else))"]
    driver.odom(7, after_s=2)
    assert driver.take() == [
        "2.1 Call /light true: begin (Far)",
        '2.1 Notify "far away": begin (Far)',
        "2.1 SetParameter /camera quality 40: begin (Far)",
    ]
    for _ in range(20):
        driver.odom(8)
    assert driver.take() == []
    driver.odom(2, after_s=2)
    assert driver.take() == [
        '6.1 Notify "far away": end after 4.0 s (Far)',
        "6.1 Call /dock: begin (Far (Else))",
        "6.1 SetParameter /camera quality: end (Far)",
    ]


def test_the_values_that_made_it_begin_are_said() -> None:
    driver = Driver()
    driver.odom(7)
    assert {one.event: one.values for one in driver.actions} == {ActionEvent.BEGIN: {"/odom x": 7}}


def test_doubt_neither_begins_nor_ends_anything() -> None:
    driver = Driver()
    for _ in range(6):
        driver.odom(7)
    assert len(driver.take()) == 3
    driver.wait(60)
    driver.odom(7)
    assert driver.take() == []


def test_a_beginning_within_a_second_of_the_last_is_skipped_and_a_parameter_is_right_at_the_end() -> None:
    driver = Driver()
    driver.odom(7)
    driver.odom(1)
    driver.odom(7)
    driver.odom(1)
    driver.take()
    driver.odom(7)
    assert driver.take() == [
        "0.5 Call /light true: skipped (Far)",
        '0.5 Notify "far away": skipped (Far)',
    ]
    driver.odom(1)
    driver.take()
    driver.wait(3)
    assert driver.take() == ["1.1 SetParameter /camera quality: end (Far)"]


TWO = """\
SetFrequency /odom 10
Rule "Low" If CheckValue /odom x > 5 Then SetParameter /camera quality 40 EndIf
Rule "High" Priority 2 If CheckValue /odom y > 5 Then SetParameter /camera quality 80 EndIf
Rule "Late" If CheckValue /odom x > 5 Then SetParameter /camera quality 20 EndIf"""


def test_of_two_blocks_the_priority_counts_and_of_equals_the_first_one() -> None:
    driver = Driver(TWO)
    driver.odom(9, y=9, after_s=1)
    assert driver.take() == ["1.0 SetParameter /camera quality 80: begin (High)"]
    driver.odom(9, y=0, after_s=1)
    assert driver.take() == ["2.0 SetParameter /camera quality 40: begin (Low)"]
    driver.odom(0, y=0, after_s=1)
    assert driver.take() == ["3.0 SetParameter /camera quality: end (Low)"]


def test_what_the_profile_does_not_allow_is_not_done_and_stands_in_no_way() -> None:
    driver = Driver(FAR, Profile(allow_calls=frozenset({"/light"})))
    driver.odom(7)
    assert driver.take() == [
        "0.1 SetParameter /camera quality 40: not allowed (Far)",
        "0.1 Call /light true: begin (Far)",
        '0.1 Notify "far away": begin (Far)',
    ]


def test_a_reload_that_keeps_the_block_does_nothing_and_one_without_it_gives_back() -> None:
    driver = Driver()
    driver.odom(7)
    driver.take()
    driver.wait(2)
    driver.reload(f"KeepAtLeast /odom 1\n{FAR}")
    assert driver.take() == []
    driver.reload(FAR.replace("40", "50"))
    assert driver.take() == ["2.1 SetParameter /camera quality 50: begin (Far)"]
    driver.wait(2)
    driver.reload("SetFrequency /odom 10")
    assert driver.take() == [
        '4.1 Notify "far away": end after 4.0 s (Far)',
        "4.1 SetParameter /camera quality: end (Far)",
    ]


def test_a_profile_that_allows_it_no_more_gives_back() -> None:
    driver = Driver()
    driver.odom(7)
    driver.take()
    driver.wait(2)
    driver.reload(FAR, Profile())
    assert driver.take() == ["2.1 SetParameter /camera quality: end (Far)"]


def test_a_node_tells_1_from_1_point_0_and_from_true() -> None:
    driver = Driver(TWO.replace("40", "1").replace("80", "1.0").replace("20", "true"))
    driver.odom(9, y=0, after_s=1)
    driver.odom(9, y=9, after_s=1)
    assert driver.take() == [
        "1.0 SetParameter /camera quality 1: begin (Low)",
        "2.0 SetParameter /camera quality 1.0: begin (High)",
    ]


@cache
def journeys() -> st.SearchStrategy[list[tuple[float, int, int]]]:
    """Pauses in seconds, and what is read then."""
    pauses = st.sampled_from([0.1, 0.3, 0.5, 1.0, 1.5])
    return st.lists(st.tuples(pauses, st.sampled_from([0, 9]), st.sampled_from([0, 9])), max_size=25)


@given(journeys())
@settings(max_examples=200)
def test_a_parameter_changes_once_a_second_at_most_and_has_what_the_priority_says(
    journey: list[tuple[float, int, int]],
) -> None:
    driver = Driver(TWO)
    changes: list[tuple[int, object]] = []
    for pause_s, x, y in journey:
        driver.odom(x, y=y, after_s=pause_s)
        changes += [(one.stamp_ns, one.action.value) for one in driver.actions]
        driver.actions = []
        # A second later it is what the naive opinion says, whatever was before.
        if pause_s == 1.5:
            driver.wait(1.0)
            changes += [(one.stamp_ns, one.action.value) for one in driver.actions]
            driver.actions = []
            wanted = 80 if y > 5 else 40 if x > 5 else None
            assert (changes[-1][1] if changes else None) == wanted
    stamps = [stamp_ns for stamp_ns, _ in changes]
    assert all(later - earlier >= S for earlier, later in pairwise(stamps))
    assert all(one != other for (_, one), (_, other) in pairwise(changes))


@given(journeys())
@settings(max_examples=200)
def test_each_beginning_is_done_or_skipped_and_each_notice_ends(
    journey: list[tuple[float, int, int]],
) -> None:
    driver = Driver()
    expected: list[tuple[float, str]] = []
    was, done_s, now_s = False, -9.0, 0.0
    for pause_s, x, _ in journey:
        now_s += pause_s
        driver.odom(x, after_s=pause_s)
        holds = x > 5
        if holds and not was:
            event = "begin" if now_s >= done_s + 1 - 1e-9 else "skipped"
            done_s = now_s if event == "begin" else done_s
            expected.append((round(now_s, 1), event))
        elif was and not holds:
            expected.append((round(now_s, 1), "end"))
        was = holds
    notices = [one for one in driver.actions if one.action.target == "far away"]
    assert [(round(one.t_s, 1), one.event.value) for one in notices] == expected

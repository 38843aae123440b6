# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A pushed text and the rules of the files, in virtual time."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.rule_manager import CONFIRM_WITHIN_S, PushedRules

LATE_NS = CONFIRM_WITHIN_S * NS_PER_S


def pushed(*texts: str, at_ns: int = 0) -> PushedRules[str]:
    rules = PushedRules("files")
    for text in texts:
        rules.push(text, f"hash of {text}", at_ns)
    return rules


def test_a_pushed_text_holds_at_once_and_goes_back_when_time_is_up() -> None:
    rules = pushed("text", at_ns=5)
    assert rules.rules == "text"
    assert not rules.roll_back(5 + LATE_NS - 1)
    assert rules.roll_back(5 + LATE_NS)
    assert rules.rules == "files"
    assert not rules.is_pushed
    assert not rules.roll_back(99 * LATE_NS)


def test_a_confirmed_text_stays() -> None:
    rules = pushed("text")
    assert rules.confirm("hash of text")
    assert not rules.roll_back(99 * LATE_NS)
    assert (rules.rules, rules.is_pushed, rules.is_confirmed) == ("text", True, True)


def test_only_the_hash_of_the_text_that_waits_confirms_it() -> None:
    rules = pushed("first", "second")
    assert not rules.is_confirmable("hash of first")
    assert not rules.confirm("hash of first")
    assert rules.roll_back(LATE_NS)
    assert not rules.confirm("hash of second")
    assert rules.rules == "files"


def test_a_confirmation_that_comes_twice_is_no_error_and_neither_is_the_same_text_again() -> None:
    rules = pushed("text")
    rules.confirm("hash of text")
    assert rules.is_confirmable("hash of text")
    rules.push("text", "hash of text", 5)
    assert not rules.roll_back(99 * LATE_NS)


def test_of_several_unconfirmed_texts_the_rules_before_the_first_come_back() -> None:
    rules = pushed("first")
    rules.push("second", "hash of second", LATE_NS - 1)
    assert not rules.roll_back(LATE_NS)
    assert rules.roll_back(2 * LATE_NS)
    assert rules.rules == "files"


def test_a_confirmed_text_comes_back_after_another_one_that_is_not() -> None:
    rules = pushed("first")
    rules.confirm("hash of first")
    rules.push("second", "hash of second", 0)
    assert rules.roll_back(LATE_NS)
    assert (rules.rules, rules.is_confirmed) == ("first", True)


def test_files_that_change_win_over_what_was_pushed() -> None:
    rules = pushed("text")
    rules.replace("other files")
    assert not rules.confirm("hash of text")
    assert not rules.roll_back(99 * LATE_NS)
    assert (rules.rules, rules.is_pushed) == ("other files", False)


@given(st.lists(st.sampled_from(["push a", "push b", "confirm a", "confirm b", "wait", "files"])))
def test_nothing_that_was_never_confirmed_holds_for_longer_than_allowed(events: list[str]) -> None:
    rules, now_ns, lasting = PushedRules("files"), 0, {"files"}
    for event in events:
        kind, _, text = event.partition(" ")
        if kind == "push":
            rules.push(text, text, now_ns)
        elif kind == "confirm" and rules.confirm(text):
            lasting.add(text)
        elif kind == "files":
            rules.replace("files")
            lasting = {"files"}
        elif kind == "wait":
            now_ns += LATE_NS
            rules.roll_back(now_ns)
            assert rules.rules in lasting

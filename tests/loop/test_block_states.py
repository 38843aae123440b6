# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What people are shown of conditions is what the loop plans by."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.naive_rules import naive_shown, naive_signal, naive_truth
from language.evaluator.random_rules import rule_files
from loop.loop_driver import SECOND, LoopDriver, rule_set_of
from loop.test_step import (
    BORDERS,
    SIGNALS,
    WORD_SIGNALS,
    WORDS,
    BothLoops,
    Moment,
    messages,
    moments,
    profiles,
    word_messages,
)
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import BlockStatus
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.language.syntax import (
    Block,
    RuleFile,
)
from smarttestudo.language.syntax_walks import (
    checks_in,
)
from smarttestudo.loop.block_states import BlockStates

TRUTHS = {None: Truth.UNKNOWN, False: Truth.FALSE, True: Truth.TRUE}
RULES = """
  SetFrequency /scan 1
  Rule "Far"
  If (CheckValue /odom pose_x > 1 AND Not (CheckValue /odom pose_y > 1))
  Then SetFrequency /scan 5 Else SetFrequency /scan 2 EndIf
  If (CheckValue /odom age > 3) Then SetFrequency /scan 9 EndIf
"""


def assert_states_are_naive(both: BothLoops, files: list[RuleFile], later_ns: int) -> None:
    steady_ns = both.knowledge.time.at(both.clock_ns + later_ns)
    values = both.second.values(both.elapsed_ns + later_ns)
    written = [one for file in files for one in file.statements if isinstance(one, Block)]
    shown = list(BlockStates(both.knowledge, steady_ns))
    assert [one.state for one in shown] == [TRUTHS[naive_truth(one.condition, values)] for one in written]
    for one, block in zip(shown, written, strict=True):
        checks = list(checks_in(block.condition))
        assert [check.state for check in one.checks] == [TRUTHS[naive_truth(one, values)] for one in checks]
        signals = [naive_signal(check) for check in checks]
        assert [check.value for check in one.checks] == [
            naive_shown(check, signal, values[signal]) for check, signal in zip(checks, signals, strict=True)
        ]


@settings(max_examples=50)
@given(
    rule_files((*SIGNALS, *WORD_SIGNALS), BORDERS, max_blocks=4, words=WORDS),
    profiles,
    moments(messages | word_messages),
    st.integers(0, 3 * SECOND),
)
def test_states_and_values_agree_with_a_naive_reading_of_the_text_at_any_time(
    files: list[RuleFile], profile: Profile, scenario: list[Moment], later_ns: int
) -> None:
    both = BothLoops(files, profile)
    both.step([], 0)
    for moment in scenario:
        gap_ns = both.wait(moment.gap_ns, moment.probe) if moment.gap_ns > 0 else moment.gap_ns
        both.step(moment.seen, gap_ns)
        wake_ns = both.knowledge.next_wake_ns
        quiet_ns = later_ns if wake_ns is None else min(later_ns, wake_ns - both.clock_ns - 1)
        assert_states_are_naive(both, files, quiet_ns)
        assert_states_are_naive(both, files, 0)


def states(driver: LoopDriver) -> list[tuple[int, Truth, list[Truth]]]:
    def plain(one: BlockStatus) -> tuple[int, Truth, list[Truth]]:
        return one.line, one.state, [check.state for check in one.checks]

    return [plain(one) for one in driver.loop.block_states(driver.now_ns)]


def test_a_rule_and_its_else_are_one_condition_and_a_check_below_not_says_what_it_says_itself() -> None:
    driver = LoopDriver(f"begin{RULES}end")
    unknown, false, true = Truth.UNKNOWN, Truth.FALSE, Truth.TRUE
    assert states(driver) == [(3, unknown, [unknown, unknown]), (6, false, [false])]
    driver.drive(SECOND, 2.0, 3.0)
    assert states(driver) == [(3, false, [true, true]), (6, false, [false])]
    driver.drive(SECOND, 2.0, 0.0)
    assert states(driver) == [(3, true, [true, false]), (6, false, [false])]
    driver.wait_until(5 * SECOND)
    assert states(driver)[1] == (6, true, [true])


def test_a_check_on_which_nothing_depends_still_says_what_it_reads() -> None:
    never = "If (CheckValue /odom age > 3 AND CheckValue /odom age < 1) Then SetFrequency /scan 1 EndIf"
    driver = LoopDriver(f"begin SetFrequency /scan 2 {never} end")
    driver.drive(SECOND, 0.0, 0.0)
    driver.wait_until(5 * SECOND)
    assert states(driver) == [(1, Truth.FALSE, [Truth.TRUE, Truth.FALSE])]


def test_a_reload_shows_the_new_rules_with_what_is_known() -> None:
    driver = LoopDriver(f"begin{RULES}end")
    driver.drive(SECOND, 2.0, 0.0)
    driver.reload("begin SetFrequency /scan 1 If (CheckValue /odom pose_x > 5) Then SetFrequency /scan 2 end")
    assert states(driver) == [(1, Truth.FALSE, [Truth.FALSE])]
    driver.reload("begin SetFrequency /scan 1 end")
    assert states(driver) == []


def test_blocks_tell_which_of_several_files_they_are_in() -> None:
    texts = ["begin SetFrequency /scan 1 end", f"begin{RULES}end"]
    rule_set = compile_rules([parse(text, "x").file for text in texts], lambda name: name)
    assert [(one.file, one.line, one.column) for one in rule_set.written] == [(1, 3, 3), (1, 6, 3)]
    assert [check.column for check in rule_set.written[0].checks] == [7, 44]
    assert rule_set_of(texts[0]).written == ()

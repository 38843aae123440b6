# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is said of blocks that meet: which of them clash, flicker or never decide."""

from __future__ import annotations

from checks.rule_findings import codes_of, covered, findings_of


def test_a_clash_names_both_blocks_their_rates_and_a_state() -> None:
    text = """\
begin
  SetFrequency /odom 10
  Rule "Corridor" If (CheckValue /odom pose_y > 1 AND CheckValue /odom pose_y < 6.5) Then
    SetFrequency /odom 4
  EndIf
  // the scaffolding
  If (CheckValue /odom pose_y > 6 AND CheckValue /odom pose_y < 25.5) Then
    SetFrequency /odom 20
  EndIf
end
"""
    (clash,) = findings_of(text)
    assert clash.message == (
        '"the scaffolding" sets /odom to 20 Hz, "Corridor" (line 3) to 4 Hz, '
        "and both hold for example at /odom pose_y = 6.2"
    )
    assert covered(text, clash.span) == "SetFrequency /odom 20"


def test_a_clash_across_files_names_the_other_file() -> None:
    low = "begin SetFrequency /odom 10 If CheckValue /odom pose_x > 1 Then SetFrequency /odom 4 end"
    high = "begin If CheckValue /odom pose_x > 2 Then SetFrequency /odom 20 end"
    (clash,) = findings_of(low, high)
    assert clash.path == "file2.adirf"
    assert "the block at line 1 (file1.adirf:1) to 4 Hz" in clash.message


def test_a_block_and_its_own_else_neither_clash_nor_meet() -> None:
    text = """begin SetFrequency /odom 10
      If CheckValue /odom pose_x > 5 Then SetFrequency /odom 4 Else SetFrequency /odom 20 EndIf end"""
    assert codes_of(text) == []


def test_blocks_that_overlap_with_the_same_rates_do_not_clash() -> None:
    text = """begin SetFrequency /odom 10
      If CheckValue /odom pose_x > 5 Then SetFrequency /odom 4 EndIf
      If CheckValue /odom pose_y > 5 Then SetFrequency /odom 4 EndIf end"""
    assert codes_of(text) == []


def test_a_second_block_just_like_the_first_is_dead() -> None:
    block = "If CheckValue /odom pose_x > 5 Then SetFrequency /odom 4 EndIf"
    assert codes_of(f"begin SetFrequency /odom 10 {block} {block} end") == ["block-shadowed"]


def test_blocks_that_only_together_cover_another_shadow_it() -> None:
    text = """begin SetFrequency /odom 10
      Rule "West" Priority 1 If CheckValue /odom pose_x < 5 Then SetFrequency /odom 4 EndIf
      Rule "East" Priority 1 If CheckValue /odom pose_x >= 5 Then SetFrequency /odom 4 EndIf
      Rule "North" If CheckValue /odom pose_y > 5 Then SetFrequency /odom 20 EndIf end"""
    (shadow,) = findings_of(text)
    assert shadow.code == "block-shadowed"
    assert shadow.message == (
        '"North" never decides a rate: wherever it holds, "West" (line 2) and "East" (line 3) win by priority'
    )


def test_only_the_blocks_that_are_needed_to_shadow_another_are_named() -> None:
    text = """begin SetFrequency /odom 10
      Rule "West" If CheckValue /odom pose_x < 5 Then SetFrequency /odom 20 EndIf
      Rule "All" If CheckValue /odom pose_x < 9 Then SetFrequency /odom 20 EndIf
      Rule "Low" If CheckValue /odom pose_x < 6 Then SetFrequency /odom 4 EndIf end"""
    messages = [one.message for one in findings_of(text) if one.code == "block-shadowed"]
    assert messages == ['"Low" never decides a rate: wherever it holds, "All" (line 3) wins by rate']


def test_blocks_that_leave_a_strip_between_them_or_differ_in_a_count_do_not_flicker() -> None:
    template = """begin SetFrequency /odom 10
      If CheckValue {0} < 2 Then SetFrequency /odom 4 EndIf
      If CheckValue {0} >= {1} Then SetFrequency /odom 20 EndIf end"""
    assert codes_of(template.format("/odom pose_x", 2)) == ["no-margin"]
    assert codes_of(template.format("/odom pose_x", 2.5)) == []
    assert codes_of(template.format("/dock msg.state", 2)) == []


def test_a_border_that_many_blocks_share_is_reported_once() -> None:
    blocks = [
        f"If (CheckValue /odom pose_x {side} 5 AND CheckValue /odom pose_y > {y}.1 "
        f"AND CheckValue /odom pose_y < {y}.9) Then SetFrequency /odom {rate} EndIf"
        for y in range(3)
        for side, rate in ((">", 4), ("<", 20))
    ]
    assert codes_of("\n".join(["begin SetFrequency /odom 10", *blocks, "end"])) == ["no-margin"]


def test_a_block_that_is_switched_off_meets_no_other_and_its_names_are_checked() -> None:
    text = """begin SetFrequency /odom 10
      Disabled Rule "West" If CheckValue /odom pose_x < 5 Then
        SetFrequency /odom 4 KeepWithin /odom pos 1 EndIf
      Rule "East" If CheckValue /odom pose_x < 6 Then SetFrequency /odom 5 EndIf
      Disabled If (CheckValue /odom pose_xx > 5 AND CheckValue /odom pose_xx < 4)
        Then SetFrequency /new 4 EndIf
      end"""
    found = findings_of(text)
    assert [one.code for one in found] == [
        "block-disabled",
        "unknown-bound",
        "block-disabled",
        "unknown-property",
        "unknown-property",
    ]
    assert [one.message for one in found if one.code == "block-disabled"] == [
        '"West" is switched off',
        "The block at line 5 is switched off",
    ]
    assert covered(text, found[0].span) == "Disabled"

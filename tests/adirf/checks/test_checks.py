# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What each check says, and about what it keeps quiet."""

from __future__ import annotations

import re

import pytest

from smarttestudo.adirf.checks import CHECKS, CheckContext, Example, RuleCheck, check_rules
from smarttestudo.adirf.formatter import format_rules
from smarttestudo.adirf.parser import parse
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.source import Span

BY_CODE = pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.code)


def findings_of(*texts: str, context: CheckContext | None = None) -> list[Finding]:
    results = [parse(text, f"file{number}.adirf") for number, text in enumerate(texts, start=1)]
    return check_rules(results, context or CheckContext())


def codes_of(*texts: str, context: CheckContext | None = None) -> list[str]:
    return [finding.code for finding in findings_of(*texts, context=context)]


def of_example(example: Example) -> list[Finding]:
    return findings_of(
        example.rules, context=CheckContext(profile=example.profile, bag_topics=example.bag_topics)
    )


def applied(text: str, finding: Finding) -> str:
    """``text`` with the finding's fix."""
    fix = finding.fix
    assert fix is not None
    lines = text.splitlines(keepends=True)
    starts = [sum(map(len, lines[:number])) for number in range(len(lines) + 1)]
    first = starts[fix.span.line - 1] + fix.span.column - 1
    last = starts[fix.span.end_line - 1] + fix.span.end_column - 1
    return text[:first] + fix.replacement + text[last:]


def covered(text: str, span: Span) -> str:
    assert span.line == span.end_line
    return text.splitlines()[span.line - 1][span.column - 1 : span.end_column - 1]


@BY_CODE
def test_the_bad_example_gives_this_finding_and_no_other(check: RuleCheck) -> None:
    assert {(one.code, one.severity) for one in of_example(check.bad)} == {(check.code, check.severity)}


@BY_CODE
def test_the_good_example_gives_no_finding(check: RuleCheck) -> None:
    assert of_example(check.good) == []


@BY_CODE
def test_messages_and_hints_are_one_line_without_a_full_stop(check: RuleCheck) -> None:
    for finding in of_example(check.bad):
        for text in (finding.message, finding.hint):
            assert "\n" not in text
            assert not text.endswith(".")
        assert finding.hint


@BY_CODE
def test_a_fix_removes_its_finding(check: RuleCheck) -> None:
    for finding in of_example(check.bad):
        if finding.fix is not None:
            mended = Example(
                rules=applied(check.bad.rules, finding),
                profile=check.bad.profile,
                bag_topics=check.bad.bag_topics,
            )
            assert of_example(mended) == []


def test_parentheses_are_offered_around_the_and_and_keep_its_meaning() -> None:
    text = ONE_BLOCK.format(
        "(CheckValue /a x > 1 AND Not CheckValue /b x > 1 OR CheckValue /c x > 1 AND (CheckValue /d x > 1))"
    )
    once = applied(text, findings_of(text)[0])
    assert "((CheckValue /a x > 1 AND Not CheckValue /b x > 1) OR" in once
    twice = applied(once, findings_of(once)[0])
    assert "OR (CheckValue /c x > 1 AND (CheckValue /d x > 1)))" in twice
    assert codes_of(twice) == []


def test_parentheses_are_not_offered_where_they_could_lose_a_comment() -> None:
    (finding,) = findings_of(
        ONE_BLOCK.format("(CheckValue /a x > 1 // why\n AND CheckValue /b x > 1 OR CheckValue /c x > 1)")
    )
    assert finding.fix is None


def test_codes_are_unique_kebab_case() -> None:
    codes = [check.code for check in CHECKS]
    assert len(set(codes)) == len(codes)
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)*", code) for code in codes)


ONE_BLOCK = "begin SetFrequency /odom 10 If {} Then SetFrequency /odom 4 EndIf end"


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


def test_relative_and_full_names_are_the_same_topic() -> None:
    assert codes_of("begin SetFrequency odom 10 SetFrequency /odom 10 end") == ["two-defaults"]


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


@pytest.mark.parametrize(
    ("condition", "code"),
    [
        ("CheckValue /odom age >= 0", "check-always-holds"),
        ("CheckValue /odom rate < 0", "check-never-holds"),
        ("CheckValue /odom yaw <= -180", "check-never-holds"),
        ("CheckValue /odom yaw <= 180", "check-always-holds"),
        ("CheckValue /battery_state level > 120", "check-never-holds"),
        ("CheckValue /scan distance < -1", "check-never-holds"),
    ],
)
def test_checks_beside_the_range_of_a_property_are_named(condition: str, code: str) -> None:
    assert codes_of(ONE_BLOCK.format(condition)) == [code]


@pytest.mark.parametrize("condition", ["CheckValue /tank msg.level > 120", "CheckValue /odom pose_x < -1000"])
def test_plain_fields_and_positions_can_have_any_value(condition: str) -> None:
    assert codes_of(ONE_BLOCK.format(condition)) == []


def test_a_type_with_a_field_of_that_name_is_not_taken_for_a_battery() -> None:
    profile = Profile(topics={"/tank": TopicProfile(type_name="my_msgs/msg/Tank")})
    text = "begin SetFrequency /tank 10 If CheckValue /tank level > 120 Then SetFrequency /tank 4 end"
    assert codes_of(text, context=CheckContext(profile=profile)) == []


@pytest.mark.parametrize(
    ("condition", "doubtful"),
    [
        ("CheckValue /odom pose_x = 3", True),
        ("CheckValue /odom pose_x != 3", True),
        ("CheckValue /arm torque = 2.5", True),
        ("CheckValue /gps status.status = 2", False),
        ("CheckValue /estop data != 0", False),
        ("CheckValue /scan rate = 0", False),
    ],
)
def test_only_measured_numbers_are_doubtful_with_equals(condition: str, *, doubtful: bool) -> None:
    assert codes_of(ONE_BLOCK.format(condition)) == (["equals-measured"] if doubtful else [])


def test_a_commanded_velocity_may_be_compared_with_zero() -> None:
    context = CheckContext(
        bag_topics={"/cmd_vel": "geometry_msgs/msg/Twist", "/odom": "nav_msgs/msg/Odometry"}
    )
    assert codes_of(ONE_BLOCK.format("CheckValue /cmd_vel vel = 0"), context=context) == []


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


def test_the_cost_of_a_missing_default_is_told_when_the_profile_knows_it() -> None:
    profile = Profile(topics={"/camera/image_raw": TopicProfile(message_kb=6220, source_hz=29)})
    text = "begin If CheckValue /odom pose_x > 6 Then SetFrequency /camera/image_raw 3 end"
    (finding,) = findings_of(text, context=CheckContext(profile=profile))
    assert finding.message == (
        "/camera/image_raw has no default: it is Full (180380 KB/s) where no block sets it, "
        "for example at /odom pose_x = 0, and while values are unknown"
    )


def test_an_else_makes_up_for_a_default() -> None:
    text = "begin If CheckValue /odom pose_x > 6 Then SetFrequency /scan 3 Else SetFrequency /scan 5 end"
    assert codes_of(text) == []


def test_a_default_in_another_file_of_the_set_counts() -> None:
    blocks = "begin If CheckValue /odom pose_x > 6 Then SetFrequency /scan 3 end"
    assert codes_of(blocks, "begin SetFrequency /scan 5 end") == []


def test_what_may_stand_in_a_broken_statement_or_file_is_not_called_missing() -> None:
    text = "begin SetFrequncy /scan 5 If CheckValue /odom pose_x > 6 Then SetFrequency /scan 3 end"
    assert "missing-default" not in codes_of(text)
    whole = "begin If CheckValue /odom pose_x > 6 Then SetFrequency /scan 3 end"
    assert codes_of(whole, context=CheckContext(has_all_files=False)) == []


def test_the_highest_floor_is_the_one_that_counts() -> None:
    text = "begin KeepAtLeast /odom 2 KeepAtLeast /odom 5 SetFrequency /odom 4 end"
    (finding,) = findings_of(text)
    assert finding.message == "4 Hz is below the floor of /odom: KeepAtLeast (line 1) raises it to 5 Hz"


def test_a_tier_with_a_profile_is_for_the_optimizer_to_judge() -> None:
    context = CheckContext(profile=Profile())
    assert codes_of("begin SetFrequency /odom Desirable end", context=context) == []


def test_a_property_of_another_type_is_unknown_and_fields_and_arrivals_are_not() -> None:
    context = CheckContext(
        bag_topics={"/scan": "sensor_msgs/msg/LaserScan", "/odom": "nav_msgs/msg/Odometry"}
    )
    (finding,) = findings_of(ONE_BLOCK.format("CheckValue /scan pose_x > 3"), context=context)
    assert finding.message == "sensor_msgs/msg/LaserScan, the type of /scan, has no property or field pose_x"
    assert finding.hint == "it has distance"
    for name in ("distance", "ranges[0]", "msg.range_max", "rate", "age"):
        assert codes_of(ONE_BLOCK.format(f"CheckValue /scan {name} > 3"), context=context) == []


def test_a_camera_info_that_follows_its_image_is_fine_at_any_rate() -> None:
    rules = "begin SetFrequency /camera/image_raw 10 SetFrequency /camera/camera_info 3 end"
    profile = Profile(
        topics={
            "/camera/camera_info": TopicProfile(paced_with="/camera/image_raw"),
            "/camera/image_raw": TopicProfile(),
        }
    )
    assert codes_of(rules, context=CheckContext(profile=profile)) == []


def test_a_camera_info_left_behind_by_a_block_is_found_in_that_block() -> None:
    text = """\
begin
  SetFrequency /cam/image_raw 3
  SetFrequency /cam/camera_info 3
  If CheckValue /odom pose_x > 5 Then
    SetFrequency /cam/image_raw 10
  EndIf
end
"""
    (finding,) = findings_of(text)
    assert (finding.code, finding.span.line) == ("camera-info-off-grid", 5)


def test_findings_come_in_the_order_of_the_files() -> None:
    found = findings_of(
        "begin SetFrequency /tf 10 SetFrequency /odom 4\nSetFrequency /odom 5 end", "begin SetFreq /a 1 end"
    )
    places = [(one.path, one.span.line, one.span.column) for one in found]
    assert places == sorted(places)
    assert len(places) == 2


@pytest.mark.parametrize(
    ("check", "message", "hint"),
    [
        (
            "/odom posx",
            "/odom is usually nav_msgs/msg/Odometry, which has no property or field posx",
            "did you mean 'pose_x'?",
        ),
        (
            "/tb3_0/odom heading",
            "/tb3_0/odom is usually nav_msgs/msg/Odometry, which has no property or field heading",
            "it has pose_x, pose_y, pose_z, yaw, vel and 2 more; "
            "if it is of another type, give a profile with --profile",
        ),
        (
            "/cmd_vel sped",
            "/cmd_vel is usually geometry_msgs/msg/Twist or geometry_msgs/msg/TwistStamped, "
            "which has no property or field sped",
            "did you mean 'speed'?",
        ),
        (
            "/tf pose_x",
            "/tf is usually tf2_msgs/msg/TFMessage, which has no property or field pose_x",
            "it has transforms; if it is of another type, give a profile with --profile",
        ),
        (
            "/robot/truth posx",
            "no common type has a property or field posx, and the type of /robot/truth is not known",
            "did you mean 'pose_x'? if it is a field of /robot/truth, write msg.posx or give a profile with "
            "--profile",
        ),
        (
            "/dock mode",
            "no common type has a property or field mode, and the type of /dock is not known",
            "if it is a field of /dock, write msg.mode or give a profile with --profile",
        ),
    ],
)
def test_a_property_that_will_stay_unknown_is_told_without_a_profile(
    check: str, message: str, hint: str
) -> None:
    (finding,) = findings_of(ONE_BLOCK.format(f"CheckValue {check} > 3"))
    assert (finding.code, finding.severity) == ("unknown-property", Severity.WARNING)
    assert (finding.message, finding.hint) == (message, hint)


@pytest.mark.parametrize(
    "check",
    [
        "/amcl_pose pose_x",
        "/tb3_0/scan distance",
        "/cmd_vel linear.x",
        "/cmd_vel twist.linear.x",
        "/odom msg.posx",
        "/dock msg.mode",
        "/dock mode.value",
        "/estop data",
        "/gps/fix latitude",
        "/truth pose_x",
        "/odom age",
    ],
)
def test_what_a_message_may_hold_gets_no_finding(check: str) -> None:
    assert "unknown-property" not in codes_of(ONE_BLOCK.format(f"CheckValue {check} > 3"))


def test_the_type_that_a_profile_or_a_recording_says_wins_over_the_usual_one() -> None:
    text = ONE_BLOCK.format("CheckValue /scan pose_x > 3")
    odometry = "nav_msgs/msg/Odometry"
    assert "unknown-property" in codes_of(text)
    for known in (
        CheckContext(profile=Profile(topics={"/scan": TopicProfile(type_name=odometry)})),
        CheckContext(bag_topics={"/scan": odometry, "/odom": odometry}),
    ):
        assert "unknown-property" not in codes_of(text, context=known)
    unlisted = CheckContext(bag_topics={"/scan": "acme_msgs/msg/Sweep", "/odom": odometry})
    assert "unknown-property" not in codes_of(text, context=unlisted)


def test_missing_blanks_are_told_once_a_file() -> None:
    text = "begin SetFrequency/odom 10 If(CheckValue/odom pose_x > 3)ThenSetFrequency/odom 4 end"
    (finding,) = (one for one in findings_of(text) if one.code == "missing-blank")
    assert (
        finding.message == "there is no blank between the previous keyword and this word (and 3 more like it)"
    )
    assert covered(text, finding.span) == "/odom"
    assert "missing-blank" not in codes_of(format_rules(text, "file1.adirf"))


@pytest.mark.parametrize("name", ["_a", "größe", "__len__"])
def test_a_property_that_no_message_can_have_is_told_whatever_the_type(name: str) -> None:
    known = CheckContext(bag_topics={"/dock": "acme_msgs/msg/Dock", "/odom": "nav_msgs/msg/Odometry"})
    (finding,) = findings_of(ONE_BLOCK.format(f"CheckValue /dock {name} > 3"), context=known)
    assert finding.message == f"no message has a property or field {name}"


def test_a_keyword_as_a_property_is_told_unless_the_type_may_have_it() -> None:
    text = ONE_BLOCK.format("CheckValue {} end > 3")
    assert "unknown-property" in codes_of(text.format("/odom"))
    known = CheckContext(bag_topics={"/dock": "acme_msgs/msg/Dock", "/odom": "nav_msgs/msg/Odometry"})
    assert codes_of(text.format("/dock"), context=known) == []

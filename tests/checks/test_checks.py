# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Laws of every lint rule, and what those of single statements say."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from checks.lint_cases import FOLDER, Example, LintCases, read_cases
from checks.rule_findings import ONE_BLOCK, applied, codes_of, covered, findings_of
from smarttestudo.bags.type_definitions import recorded_types
from smarttestudo.checks import LINT_RULES, CheckContext
from smarttestudo.checks.context import ObservedValues
from smarttestudo.checks.lint_rule import Found, LintRule, lint_rule
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.signal import Signal, SignalKind
from smarttestudo.language.formatter import format_rules
from smarttestudo.rules.profile_file import parse_profile
from smarttestudo.rules.rule_sets import known_types

THEMES = sorted(path.stem for path in FOLDER.glob("*.adirf"))
CASES = {case.code: case for theme in THEMES for case in read_cases(theme)}
RULES = {rule.code: rule for rule in LINT_RULES}
BY_CODE = pytest.mark.parametrize("case", CASES.values(), ids=CASES)


def of_example(example: Example) -> list[Finding]:
    profile = parse_profile(example.profile, Path("profile.toml")) if example.profile else None
    found = replace(recorded_types(), topics=example.bag_topics) if example.bag_topics else None
    observed = {
        Signal.named(name)._replace(kind=SignalKind.TEXT): ObservedValues(texts=texts)
        for name, texts in example.texts.items()
    }
    context = CheckContext(
        profile=profile,
        bag_topics=example.bag_topics,
        types=known_types(found, profile),
        observed=observed,
    )
    return findings_of(example.rules, context=context)


@pytest.mark.parametrize("theme", THEMES)
def test_a_theme_and_its_cases_have_the_same_lint_rules(theme: str) -> None:
    module = importlib.import_module(f"smarttestudo.checks.{theme}")
    declared = [one.code for one in vars(module).values() if isinstance(one, LintRule)]
    cases = read_cases(theme)
    assert [case.code for case in cases] == declared
    assert all(case.bad and case.good for case in cases)


def test_every_lint_rule_is_one_of_a_theme_and_explains_itself() -> None:
    assert set(CASES) == set(RULES)
    assert all(rule.meaning.endswith(".") and rule.why.endswith(".") for rule in LINT_RULES)


def test_the_docstring_of_a_lint_rule_is_its_text() -> None:
    @lint_rule("made-up", Severity.INFO)
    def made_up(rules: RuleModel) -> Iterator[Found]:
        """A rule is made up.

        Nobody can follow
        such a rule.
        """
        return iter(())

    assert (made_up.meaning, made_up.why) == ("A rule is made up.", "Nobody can follow such a rule.")


@BY_CODE
def test_a_bad_example_gives_its_findings_and_no_other(case: LintCases) -> None:
    for example in case.bad:
        found = of_example(example)
        assert {(one.code, one.severity) for one in found} == {(case.code, RULES[case.code].severity)}
        said = tuple(f"{one.span.line}:{one.span.column} {one.message}" for one in found)
        assert said == example.findings


@BY_CODE
def test_a_good_example_gives_no_finding(case: LintCases) -> None:
    for example in case.good:
        assert example.findings == ()
        assert of_example(example) == []


@BY_CODE
def test_messages_and_hints_are_one_line_without_a_full_stop(case: LintCases) -> None:
    for finding in (finding for example in case.bad for finding in of_example(example)):
        for text in (finding.message, finding.hint):
            assert "\n" not in text
            assert not text.endswith(".")
        assert finding.hint


@BY_CODE
def test_a_fix_removes_its_finding(case: LintCases) -> None:
    for example in case.bad:
        for finding in of_example(example):
            if finding.fix is not None:
                assert of_example(replace(example, rules=applied(example.rules, finding))) == []


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
    codes = [rule.code for rule in LINT_RULES]
    assert len(set(codes)) == len(codes)
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)*", code) for code in codes)


def test_the_cost_of_a_missing_default_is_told_when_the_profile_knows_it() -> None:
    profile = Profile(topics={"/camera/image_raw": TopicProfile(message_kb=6220, source_hz=29)})
    text = "begin If CheckValue /odom pose_x > 6 Then SetFrequency /camera/image_raw 3 end"
    (finding,) = findings_of(text, context=CheckContext(profile=profile))
    assert finding.message == (
        "/camera/image_raw has no default: it is Full (180380 KB/s) where no block sets it, "
        "for example at /odom pose_x = 0, and while values are unknown"
    )


def test_relative_and_full_names_are_the_same_topic() -> None:
    assert codes_of("begin SetFrequency odom 10 SetFrequency /odom 10 end") == ["two-defaults"]


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


def test_missing_blanks_are_told_once_a_file() -> None:
    text = "begin SetFrequency/odom 10 If(CheckValue/odom pose_x > 3)ThenSetFrequency/odom 4 end"
    (finding,) = (one for one in findings_of(text) if one.code == "missing-blank")
    assert (
        finding.message == "there is no blank between the previous keyword and this word (and 3 more like it)"
    )
    assert covered(text, finding.span) == "/odom"
    assert "missing-blank" not in codes_of(format_rules(text, "file1.adirf"))

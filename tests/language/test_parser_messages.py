# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the parser says about broken files: each case of tests/golden/messages is a text and its findings."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from smarttestudo.domain.finding import Finding, Fix
from smarttestudo.language.parser import parse

MESSAGES = Path(__file__).parents[1] / "golden" / "messages"


@dataclass(frozen=True, kw_only=True)
class Case:
    """A broken text and the lines that a user sees about it."""

    title: str
    text: str
    said: str


def cases() -> list[Case]:
    found = []
    for path in sorted(MESSAGES.glob("*.txt")):
        for part in re.split(r"^=== ", path.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
            title, _, rest = part.partition("\n")
            text, _, said = rest.partition("\n---\n")
            found.append(Case(title=f"{path.stem}: {title}", text=text, said=said.strip()))
    return found


def lines_about(finding: Finding) -> list[str]:
    hint = [f"    hint: {finding.hint}"] if finding.hint else []
    fix = [f"    fix: {finding.fix.title}"] if finding.fix else []
    return [finding.line_of_text(), *hint, *fix]


def fixed(text: str, fix: Fix) -> str:
    lines = text.split("\n")
    line = lines[fix.span.line - 1]
    lines[fix.span.line - 1] = line[: fix.span.column - 1] + fix.replacement + line[fix.span.end_column - 1 :]
    return "\n".join(lines)


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.title)
def test_a_broken_file_is_explained(case: Case) -> None:
    findings = parse(case.text, "rules.adirf").findings
    assert "\n".join(line for finding in findings for line in lines_about(finding)) == case.said


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.title)
def test_a_fix_mends_its_finding_and_breaks_nothing(case: Case) -> None:
    findings = parse(case.text, "rules.adirf").findings
    for finding in findings:
        if finding.fix is not None:
            left = parse(fixed(case.text, finding.fix), "rules.adirf").findings
            assert finding.message not in [one.message for one in left if one.span.line == finding.span.line]
            assert len(left) <= len(findings)


def test_every_code_is_in_kebab_case_and_every_message_is_one_line() -> None:
    for case in cases():
        for finding in parse(case.text, "rules.adirf").findings:
            assert re.fullmatch(r"[a-z]+(-[a-z]+)*", finding.code)
            assert "\n" not in finding.message + finding.hint


def test_a_hundred_errors_are_shown_and_the_others_counted() -> None:
    nested = "If (CheckValue /odom pose_y > 5) Then\n"
    for line in ("SetFrequency\n", nested):
        findings = parse("begin\n" + line * 1500 + "end", "rules.adirf").findings
        assert len(findings) == 101
        assert re.fullmatch(r"1[34]\d\d more errors are not shown", findings[-1].message)


def test_a_file_of_more_than_1_mb_is_refused() -> None:
    (finding,) = parse("begin end //" + "é" * 2_000_000, "rules.adirf").findings
    assert finding.line_of_text() == "rules.adirf:1:1: error[file-too-large]: a rule file holds at most 4 MB"
    assert parse("begin end //" + "é" * 499_994, "rules.adirf").is_valid


@pytest.mark.parametrize(("opening", "closing"), [("(", ")"), ("Not ", ""), ("Not (", ")")])
def test_conditions_nest_a_hundred_deep_and_no_deeper(opening: str, closing: str) -> None:
    depth = 100 // (2 if opening == "Not (" else 1)
    text = "begin If {}CheckValue /odom speed > 1{} Then SetFrequency /odom 1 end"
    assert parse(text.format(opening * depth, closing * depth), "rules.adirf").is_valid
    (finding,) = parse(text.format(opening * (depth + 1), closing * (depth + 1)), "rules.adirf").findings
    assert finding.code == "nested-too-deep"
    assert finding.message == "conditions nest at most 100 deep"


def test_a_character_that_cannot_be_seen_is_named() -> None:
    text = "begin If CheckValue /odom speed\u200b > 1 Then SetFrequency /odom 1 end"
    (finding,) = parse(text, "rules.adirf").findings
    assert finding.message.endswith("found the character U+200B (zero width space)")
    assert finding.span.column == text.index("\u200b") + 1


@pytest.mark.parametrize("character", ["\t", "\x1b", "\u2028", "\u202e"])
def test_a_name_holds_nothing_that_cannot_be_shown(character: str) -> None:
    text = f'begin Rule "a{character}b" If CheckValue /odom speed > 1 Then SetFrequency /odom 1 end'
    (finding,) = parse(text, "rules.adirf").findings
    assert finding.message == "the name holds a tab or a character that cannot be seen"

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a rule file reads as."""

from __future__ import annotations

from pathlib import Path

import pytest

from language.rule_strategies import bare
from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Tier
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import (
    And,
    Block,
    Check,
    Condition,
    Group,
    KeepAtLeast,
    Or,
    RateWord,
    SetFrequency,
)
from smarttestudo.language.syntax_walks import (
    sets_in,
)

ROOT = Path(__file__).parents[2]
THESIS_FORMS = sorted((ROOT / "tests" / "golden" / "thesis_forms").glob("*.adirf"))


def block(text: str) -> Block:
    (statement,) = valid(text)
    assert isinstance(statement, Block)
    return statement


def valid(text: str) -> tuple[object, ...]:
    result = parse(text, "rules.adirf")
    assert result.findings == ()
    return result.file.statements


def spelt(condition: Condition) -> str:
    """The condition with every join in brackets."""
    match condition:
        case Check():
            return condition.property
        case And() | Or():
            parts = f" {type(condition).__name__} ".join(spelt(operand) for operand in condition.operands)
            return f"[{parts}]"
        case Group():
            return f"({spelt(condition.operand)})"
        case _:
            return f"Not {spelt(condition.operand)}"


@pytest.mark.parametrize("path", THESIS_FORMS, ids=lambda path: path.stem)
def test_every_form_of_the_thesis_reads_without_an_error(path: Path) -> None:
    text = path.read_bytes().decode()
    assert parse(text, path.name).findings == ()


def test_the_evaluation_file_means_the_same_in_its_old_form() -> None:
    old = parse((ROOT / "tests/golden/thesis_forms/evaluation.adirf").read_text(), "old").file.statements
    new = parse((ROOT / "examples/warehouse.adirf").read_text(), "new").file.statements
    assert [bare(one) for one in old[:9]] == [bare(one) for one in new[:9]]
    for before, after in zip(old[9:], new[9:], strict=True):
        assert isinstance(before, Block)
        assert isinstance(after, Block)
        assert before.label == after.name
        assert bare(before.condition) == bare(after.condition)
        assert bare(before.then) == bare(after.then)


def test_and_binds_tighter_than_or() -> None:
    a, b, c, d = (f"CheckValue /x {name} > 1" for name in "abcd")
    read = block(f"begin If ({a} OR {b} AND Not {c} OR ({d} OR {a})) Then SetFrequency /x 1 end")
    assert spelt(read.condition) == "([a Or [b And Not c] Or ([d Or a])])"


def test_rates_are_numbers_tiers_and_words() -> None:
    statements = valid(
        "begin SetFrequency a 5.0Hz SetFrequency b Marginal SetFrequency c Off KeepAtLeast d 1e1 end"
    )
    rates = [one.rate for one in statements if isinstance(one, SetFrequency | KeepAtLeast)]
    assert [rate.value for rate in rates] == [5.0, Tier.MARGINAL, RateWord.OFF, 10.0]
    assert [rate.text for rate in rates] == ["5.0", "", "", "1e1"]
    assert [rate.has_unit for rate in rates] == [True, False, False, False]


def test_a_set_frequency_behind_an_open_block_belongs_to_it() -> None:
    read = block("begin If CheckValue /x a > 1 Then SetFrequency /x 1\n\nSetFrequency /y 2 end")
    assert [one.topic.text for one in sets_in(read.then)] == ["/x", "/y"]


def test_a_set_frequency_behind_end_if_is_a_default() -> None:
    statements = valid("begin If CheckValue /x a > 1 Then SetFrequency /x 1 EndIf SetFrequency /y 2 end")
    assert [type(one) for one in statements] == [Block, SetFrequency]


def test_a_block_ends_at_the_next_rule_or_if() -> None:
    head = "CheckValue /x a > 1 Then SetFrequency /x 1 Else SetFrequency /x 2"
    statements = valid(f'begin If {head} Rule "B" If {head} If {head} EndIf end begin KeepAtLeast /x 1 end')
    assert [type(one) for one in statements] == [Block, Block, Block, KeepAtLeast]


def test_a_name_holds_quotes_and_backslashes() -> None:
    read = block(
        r'begin Rule "a \"b\" \\ // c" Priority -3 If CheckValue /x a > 1 Then SetFrequency /x 1 end'
    )
    assert read.name == r'a "b" \ // c'
    assert read.priority == -3


@pytest.mark.parametrize(
    ("head", "label"),
    [
        ('Rule "Corridor" If', "Corridor"),
        ('// Zone 2\nRule "Corridor" If', "Corridor"),
        ("// Rules\n// Zone 2\nIf", "Zone 2"),
        ("// Zone 2\n// -------\n\nIf", "Zone 2"),
        ("If // Zone 2\n", "Zone 2"),
        ("// ====\nIf", "block at line 3"),
        ("If", "block at line 2"),
    ],
)
def test_a_block_is_called_by_its_name_its_nearest_comment_or_its_line(head: str, label: str) -> None:
    text = f"begin // rules\n{head} CheckValue /x a > 1 Then // slow\nSetFrequency /x 1 end"
    assert block(text).label == label


def test_a_comment_above_a_statement_before_the_block_is_not_its_label() -> None:
    _, read = valid(
        "begin\n// default\nSetFrequency /x 1\nIf CheckValue /x a > 1 Then SetFrequency /x 2\nend"
    )
    assert isinstance(read, Block)
    assert read.label == "block at line 4"


def test_spans_cover_statements_and_their_parts() -> None:
    text = (
        "begin\n  If (CheckValue /odom pose_x >= -13)Then // c\n SetFrequency /odom 4 Hz // d\n  EndIf\nend"
    )
    read = block(text)
    assert isinstance(read.condition, Group)
    check = read.condition.operand
    assert isinstance(check, Check)
    assert read.span == Span(line=2, column=3, end_line=4, end_column=8)
    assert cut(text, read.condition.span) == "(CheckValue /odom pose_x >= -13)"
    assert cut(text, check.span) == "CheckValue /odom pose_x >= -13"
    assert cut(text, check.topic.span) == "/odom"
    assert cut(text, check.property_span) == "pose_x"
    assert cut(text, read.then[0].span) == "SetFrequency /odom 4 Hz"
    assert cut(text, sets_in(read.then)[0].rate.span) == "4 Hz"


def cut(text: str, span: Span) -> str:
    assert span.line == span.end_line
    return text.split("\n")[span.line - 1][span.column - 1 : span.end_column - 1]


def test_good_statements_are_kept_beside_broken_ones() -> None:
    text = (
        "begin SetFrequency /a 1 SetFrequency /b SetFrequency /c 3 "
        "If CheckValue /x Then SetFrequency /d 1 EndIf KeepAtLeast /e 1 end"
    )
    result = parse(text, "rules.adirf")
    assert [finding.code for finding in result.findings] == ["expected-rate", "expected-property"]
    kept = [one.topic.text for one in result.file.statements if not isinstance(one, Block)]
    assert kept == ["/a", "/c", "/e"]


def test_an_empty_collection_is_no_error() -> None:
    assert valid("begin end begin end") == ()


@pytest.mark.full
def test_a_full_file_of_1_mb_reads() -> None:
    rule = (
        "If(CheckValue /odom pose_y > 1 AND CheckValue /odom pose_y < 5.4)Then\nSetFrequency /odom 4\n// c\n"
    )
    count = 999_000 // len(rule)
    assert len(valid(f"begin\n{rule * count}end")) == count


def test_a_block_is_switched_off_by_a_word_before_it() -> None:
    check = "CheckValue /odom Disabled > 1"
    named, unnamed, on = (
        one
        for one in parse(
            f"""begin
              Disabled Rule "A" If {check} Then SetFrequency /odom 2
              // Why.
              DisabledIf {check} Then SetFrequency /odom 2
              If {check} Then SetFrequency /odom 2
              end""",
            "rules.adirf",
        ).file.statements
        if isinstance(one, Block)
    )
    assert [one.is_disabled for one in (named, unnamed, on)] == [True, True, False]
    assert (named.label, unnamed.label, on.label) == ("A", "Why.", "block at line 5")
    assert (named.span.line, named.span.column) == (2, 15)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a push would change on a robot, in words."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from language.rule_strategies import rule_files
from language.written_rules import WrittenFile, written_files
from ruler.ruler_server import EXAMPLES
from smarttestudo.editing.difference import differences, differing_blocks, mean_the_same
from smarttestudo.language.formatter import format_file, format_rules
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.language.syntax import Block, RuleFile, SetFrequency, Statement

WAREHOUSE = (EXAMPLES / "warehouse.adirf").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (
            "SetFrequency /scan 4\n    EndIf",
            "SetFrequency /scan 6\n    EndIf",
            ["Warehouse Corridor: /scan 4 → 6 Hz"],
        ),
        ("SetFrequency /odom 10\n", "SetFrequency /odom Full\n", ["default: /odom 10 Hz → Full"]),
        ("pose_y < 5.4", "pose_y < 5.5", ["Warehouse Corridor: another condition"]),
        ('"Scaffolding"', '"Scaffolding" Priority 3', ["Scaffolding: Priority 0 → 3"]),
        ('Rule "Scaffolding"', 'Disabled Rule "Scaffolding"', ["Scaffolding: switched off"]),
        ('"Scaffolding"', '"Tower"', ["Scaffolding: removed", "Tower: added"]),
        (
            "    SetFrequency /tf 10\n",
            "    KeepAtLeast /tf 2\n",
            ["default: /tf 10 Hz, removed", "floor: /tf 2 Hz, new"],
        ),
        ("// Under", "// Below", []),
        ("begin", "\n\n// Moved\nbegin", []),
    ],
)
def test_a_change_is_one_sentence_and_a_moved_line_none(before: str, after: str, said: list[str]) -> None:
    new = WAREHOUSE.replace(before, after, 1)
    assert list(differences(parse(WAREHOUSE, "before"), parse(new, "after"))) == said


@pytest.mark.parametrize(
    ("before", "after", "differing"),
    [
        ("pose_y < 5.4", "pose_y < 5.5", (0,)),
        ('"Scaffolding"', '"Tower"', (1,)),
        ('Rule "Scaffolding"', 'Disabled Rule "Scaffolding"', (1,)),
        ("SetFrequency /odom 10\n", "SetFrequency /odom Full // all\n\n", ()),
    ],
)
def test_blocks_that_differ_are_known_by_their_numbers(
    before: str, after: str, differing: tuple[int, ...]
) -> None:
    new = WAREHOUSE.replace(before, after, 1)
    assert differing_blocks(parse(WAREHOUSE, "before"), parse(new, "after")) == differing


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("KeepAtLeast /a 5 KeepAtLeast /a 2", "KeepAtLeast /a 2", "floor: /a 5 → 2 Hz"),
        (
            "KeepWithin /odom position 0.1 KeepWithin /odom position 0.5",
            "KeepWithin /odom position 0.5",
            "bound: /odom position within 0.1 → 0.5",
        ),
        (
            "KeepWithin /odom position Desirable KeepWithin /odom position 0.5",
            "KeepWithin /odom position 0.5",
            "bound: /odom position within 0.5 and Desirable → 0.5",
        ),
        (
            "KeepWithin /odom position Desirable KeepWithin /odom position Marginal",
            "KeepWithin /odom position Marginal",
            "bound: /odom position within Desirable → Marginal",
        ),
    ],
)
def test_of_several_floors_and_bounds_the_one_that_counts_is_told(before: str, after: str, said: str) -> None:
    old, new = parse(f"begin {before} end", "old"), parse(f"begin {after} end", "new")
    assert differences(old, new) == (said,)
    assert not mean_the_same(old, new)


def test_what_is_switched_on_again_or_comes_switched_off_is_told() -> None:
    on = 'begin Rule "A" If CheckValue /odom speed > 1 Then SetFrequency /odom 2 end'
    off = parse(on.replace("Rule", "Disabled Rule"), "off")
    assert differences(off, parse(on, "on")) == ("A: switched on",)
    assert differences(parse("begin end", "none"), off) == ("A: added, switched off",)


@given(written_files())
@settings(max_examples=30)
def test_layout_is_no_difference(written: WrittenFile) -> None:
    old = parse(written.text, "old")
    new = parse(format_rules(written.text, "new"), "new")
    # A comment that the formatter moves to a rule without a name gives it one.
    assume(unnamed(old) == unnamed(new))
    assert differences(old, new) == ()


@given(rule_files(), st.randoms(use_true_random=False))
@settings(max_examples=50)
def test_rules_in_another_order_mean_the_same(file: RuleFile, random: Random) -> None:
    # Of two defaults of a topic the last one counts, so defaults keep their order.
    (part, *_) = file.collections
    defaults = [one for one in part.statements if isinstance(one, SetFrequency)]
    others = [closed(one) for one in part.statements if not isinstance(one, SetFrequency)]
    before = replace(file, collections=(replace(part, statements=(*defaults, *others)),))
    random.shuffle(others)
    after = replace(file, collections=(replace(part, statements=(*others, *defaults)),))
    assert mean_the_same(parsed(before), parsed(after))


@given(rule_files(), rule_files())
@settings(max_examples=50)
def test_rules_mean_the_same_only_where_nothing_is_said_to_differ(old: RuleFile, new: RuleFile) -> None:
    if differences(parsed(old), parsed(new)):
        assert not mean_the_same(parsed(old), parsed(new)) or has_unnamed_rules(old)


def has_unnamed_rules(file: RuleFile) -> bool:
    return any(isinstance(one, Block) and one.name is None for one in file.statements)


def closed(statement: Statement) -> Statement:
    return replace(statement, has_end_if=True) if isinstance(statement, Block) else statement


def parsed(file: RuleFile) -> ParseResult:
    result = parse(format_file(file), "rules.adirf")
    assert result.is_valid
    return result


def unnamed(result: ParseResult) -> list[bool]:
    blocks = [one for one in result.file.statements if isinstance(one, Block)]
    return [block.label == f"block at line {block.span.line}" for block in blocks]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for the formatter whatever the file."""

from __future__ import annotations

import dataclasses
from functools import cache

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from language.comment_owners import comments_by_owner
from language.rule_strategies import NOWHERE, bare, blocks, checks, rule_files
from language.written_rules import WrittenFile, written_files
from smarttestudo.language.formatter import MAX_WIDTH, format_file, format_rules
from smarttestudo.language.normal_form import normal_form
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import And, Block, Collection, Condition, Not, Or, RuleFile


@given(written_files())
@settings(max_examples=50)
def test_formatting_keeps_the_meaning(written: WrittenFile) -> None:
    result = parse(format_rules(written.text, "rules.adirf"), "rules.adirf")
    assert result.findings == ()
    assert bare(result.file) == bare(written.tree)


@given(written_files())
@settings(max_examples=50)
def test_formatting_keeps_what_blocks_are_called(written: WrittenFile) -> None:
    formatted = format_rules(written.text, "rules.adirf")
    for before, after in zip(blocks_of(written.text), blocks_of(formatted), strict=True):
        assert before.label in (after.label, f"block at line {before.span.line}")


def blocks_of(text: str) -> list[Block]:
    return [one for one in parse(text, "rules.adirf").file.statements if isinstance(one, Block)]


@given(written_files())
@settings(max_examples=50)
def test_formatting_twice_is_formatting_once(written: WrittenFile) -> None:
    once = format_rules(written.text, "rules.adirf")
    assert format_rules(once, "rules.adirf") == once


@given(written_files())
@settings(max_examples=50)
def test_every_comment_stays_once_and_with_its_statement(written: WrittenFile) -> None:
    formatted = format_rules(written.text, "rules.adirf")
    found = comments_by_owner(parse(formatted, "rules.adirf").file)
    assert sorted(found) == sorted(written.comment_owners.items())


@given(written_files())
@settings(max_examples=50)
def test_formatted_lines_are_short_and_end_in_no_blank(written: WrittenFile) -> None:
    for line in format_rules(written.text, "rules.adirf").splitlines():
        words = line.partition("//")[0].rstrip()
        assert line == line.rstrip()
        assert len(words) <= MAX_WIDTH or words.count("CheckValue") <= 1


@given(written_files())
@settings(max_examples=50)
def test_a_file_keeps_the_line_ends_of_its_first_line(written: WrittenFile) -> None:
    unix = format_file(parse(written.text, "rules.adirf").file)
    windows = unix.replace("\n", "\r\n")
    assert format_rules(unix, "rules.adirf") == unix
    assert format_rules(windows, "rules.adirf") == windows


@given(st.text(alphabet="begindSEftR()<>=!&|/\"'#*\\ \n\r\t.-0123456789"))
def test_a_text_with_errors_is_left_as_it_is(text: str) -> None:
    assume(not parse(text, "rules.adirf").is_valid)
    assert format_rules(text, "rules.adirf") == text


@given(rule_files())
def test_a_tree_that_a_program_built_prints_to_what_it_means(file: RuleFile) -> None:
    assert bare(parse(format_file(file), "rules.adirf").file) == bare(file)


@cache
def loose_conditions() -> st.SearchStrategy[Condition]:
    """``AND``, ``OR`` and ``Not`` in each other without any group, as only a program builds them."""

    def several(inner: st.SearchStrategy[Condition]) -> st.SearchStrategy[list[Condition]]:
        return st.lists(inner, min_size=2, max_size=3)

    return st.recursive(
        checks(),
        lambda inner: st.one_of(
            inner.map(lambda one: Not(operand=one, span=NOWHERE)),
            several(inner).map(lambda parts: And(operands=tuple(parts), span=NOWHERE)),
            several(inner).map(lambda parts: Or(operands=tuple(parts), span=NOWHERE)),
        ),
        max_leaves=8,
    )


@given(blocks(), loose_conditions())
def test_missing_parentheses_are_added_where_meaning_needs_them(block: Block, condition: Condition) -> None:
    statement = dataclasses.replace(block, condition=condition)
    file = RuleFile(path="", collections=(Collection(statements=(statement,), span=NOWHERE),))
    result = parse(format_file(file), "rules.adirf")
    (read,) = result.file.statements
    assert isinstance(read, Block)
    assert normal_form(read.condition, str) == normal_form(condition, str)


@given(rule_files())
def test_a_missing_end_if_is_added_where_meaning_needs_it(file: RuleFile) -> None:
    """A statement behind a block must not slip into it."""
    opened = [
        dataclasses.replace(one, has_end_if=False) if isinstance(one, Block) else one
        for one in file.statements
    ]
    tree = RuleFile(path="", collections=(Collection(statements=tuple(opened), span=NOWHERE),))
    result = parse(format_file(tree), "rules.adirf")
    assert result.findings == ()
    assert len(result.file.statements) == len(opened)

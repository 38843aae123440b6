# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for the parser whatever the text."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from language.comment_owners import comments_by_owner
from language.rule_strategies import PROPERTIES, bare, rule_files
from language.written_rules import Word, WrittenFile, lay_out, seeds, words_of, written_files
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.language.parser import parse
from smarttestudo.language.parser.rule_file import ParseResult
from smarttestudo.language.parser.values import MAX_DURATION_NS
from smarttestudo.language.syntax import DurationUnit, RuleFile

MAX_STEPS_BY_TOKEN = 24
VOCABULARY = (
    *(
        "begin",
        "end",
        "SetFrequency",
        "KeepAtLeast",
        "Disabled",
        "Rule",
        "Priority",
        "If",
        "Then",
        "Else",
        "EndIf",
    ),
    *("Not", "AND", "OR", "CheckValue", "Hz", "Full", "Off", "Marginal", "(", ")", ">", "<=", "!=", "=="),
    *("&&", "#", "//", "/*", "/odom", "pose_x", "10", "-2.5", "1,5", '"name"', '"', "“name”", "é"),
    *("if", "then", "Endif", "SetFrequncy"),
)
TYPOS = {
    "begin": "Begin",
    "end": "END",
    "SetFrequency": "SetFrequncy",
    "KeepAtLeast": "KeepAtLest",
    "Rule": "rule",
    "Priority": "Prioritty",
    "If": "if",
    "Then": "then",
    "Else": "else",
    "EndIf": "Endif",
    "Not": "not",
    "AND": "&&",
    "OR": "or",
    "CheckValue": "Checkvalue",
    ">": "=>",
    "=": "==",
    "Full": "full",
    "Marginal": "Marginall",
    "Hz": "hz",
}

NS_OF = {
    DurationUnit.MILLISECONDS: NS_PER_MS,
    DurationUnit.SECONDS: NS_PER_S,
    DurationUnit.MINUTES: 60 * NS_PER_S,
}


@given(written_files())
def test_a_file_in_any_layout_means_its_words(written: WrittenFile) -> None:
    result = parse(written.text, "rules.adirf")
    assert result.findings == ()
    assert bare(result.file) == bare(written.tree)


@given(written_files())
def test_every_comment_belongs_to_one_statement(written: WrittenFile) -> None:
    found = comments_by_owner(parse(written.text, "rules.adirf").file)
    assert sorted(found) == sorted(written.comment_owners.items())


@given(written_files(max_statements=3), st.data())
def test_a_damaged_file_gives_findings_in_its_bounds(written: WrittenFile, data: st.DataObject) -> None:
    text = written.text
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 12)))
        text = text[:start] + data.draw(st.text(max_size=3) | st.sampled_from(VOCABULARY)) + text[end:]
    assert_bounded(text)


@given(st.text() | st.text(alphabet="begindSEftR()<>=!&|/\"'#*\\ \n\r\t.-0123456789"))
@settings(max_examples=300)
def test_any_text_gives_findings_in_its_bounds(text: str) -> None:
    assert_bounded(text)


@given(
    st.sampled_from(("0", "1", ".5")),
    st.integers(-(10**30), 10**30) | st.integers(-9, 9),
    st.sampled_from(DurationUnit),
)
@example("1", -(10**20), DurationUnit.SECONDS)
@example("0", 10**20, DurationUnit.MINUTES)
def test_a_number_of_any_size_makes_a_duration_or_a_finding(
    digits: str, exponent: int, unit: DurationUnit
) -> None:
    number = f"{digits}e{exponent}"
    text = f"begin If CheckValue /a x > 1 For {number} {unit.value} Then SetFrequency /a 1 EndIf end"
    assert_bounded(text)
    is_one = float(number) * NS_OF[unit] <= MAX_DURATION_NS
    assert bool(parse(text, "rules.adirf").findings) != is_one


@given(st.lists(st.sampled_from(VOCABULARY), max_size=60), st.sampled_from((" ", "\n")))
@settings(max_examples=300)
def test_any_sequence_of_words_gives_findings_in_its_bounds(words: list[str], blank: str) -> None:
    assert_bounded(blank.join(words))


@given(st.binary(max_size=400))
def test_any_bytes_give_findings_in_their_bounds(data: bytes) -> None:
    assert_bounded(data.decode("utf-8", "replace"))
    assert_bounded(data.decode("latin-1"))


@given(rule_files(properties=tuple(one for one in PROPERTIES if one not in TYPOS)), seeds(), st.data())
@settings(max_examples=120)
def test_typos_in_two_statements_give_two_findings(file: RuleFile, seed: int, data: st.DataObject) -> None:
    words = words_of(file)
    places = [index for index, word in enumerate(words) if typo_of(word) != word.text]
    first = data.draw(st.sampled_from(places))
    others = [index for index in places if words[index].owner != words[first].owner]
    assume(others)
    chosen = {first, data.draw(st.sampled_from(others))}
    wrong = [Word(text=typo_of(w), owner=w.owner) if i in chosen else w for i, w in enumerate(words)]
    text, _ = lay_out(wrong, Random(seed))
    result = parse(text, "rules.adirf")
    assert [covered(text, result, number) for number in range(len(result.findings))] == [
        typo_of(words[index]) for index in sorted(chosen)
    ]


def typo_of(word: Word) -> str:
    if is_topic_name(word.text) and word.text.startswith("/"):
        return f"{word.text}/"
    return TYPOS.get(word.text, word.text)


def covered(text: str, result: ParseResult, number: int) -> str:
    span = result.findings[number].span
    line = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")[span.line - 1]
    return line[span.column - 1 : span.end_column - 1]


def assert_bounded(text: str) -> None:
    result = parse(text, "rules.adirf")
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for finding in result.findings:
        span = finding.span
        assert (span.line, span.column) <= (span.end_line, span.end_column)
        assert span.end_line <= len(lines)
        assert span.end_column <= len(lines[span.end_line - 1]) + 1
    assert result.steps <= MAX_STEPS_BY_TOKEN * len(result.tokens)
    assert result.findings or result.file.collections


@pytest.mark.parametrize(
    "text",
    [
        "begin If " + "(" * 20_000,
        "begin If " + "Not " * 10_000,
        "If x\n" * 10_000,
        "SetFrequexxxy\n" * 3_000,
        "begin If (" + "CheckValue /a b > 1 AND " * 4_000,
        "“" * 20_000,
        '"\\' * 20_000,
        "1e" * 20_000,
        "#\n" * 20_000,
        "IfThen" * 20_000,
        "beginend" * 20_000 + "x",
        "begin If (" + "CheckValue/a end>1 AND" * 4_000,
    ],
    ids=lambda text: text[:12].strip(),
)
def test_the_steps_are_linear_in_the_tokens_of_hostile_text(text: str) -> None:
    assert_bounded(text)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Every file that the grammar of the thesis takes is taken, and says the same.

The grammar is matched without a lexer: between two words there may be blanks and comments, and a keyword ends
where its letters do, whatever follows. Ours alone: an empty file is an error, rates, nesting and size have
bounds, a lone CR ends a line, and behind a topic stands no letter, digit or other sign that its name could go
on with.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.language.formatter import format_rules
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    Check,
    Condition,
    Group,
    Or,
    SetFrequency,
    Statement,
)

TOPICS = ("/cmd_vel", "/odom", "/scan", "/camera/image_raw/compressed", "/camera/image_raw", "/tf")
BLANK = re.compile(r"(?:[ \t\r\n]|//[^\n]*)*")
TOPIC = re.compile("(?:" + "|".join(TOPICS) + r")(?![\w~.\[\]/-])")
PROPERTY = re.compile(r"[^\d\W]\w*\b")
NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?<=[\w.])(?![\w.])")
OPERATOR = re.compile(r">=|<=|!=|>|<|=")

Meaning = tuple[object, ...]


class UnreadError(Exception):
    """The grammar of the thesis has no such file."""


class Reader:
    """Reads a text by the grammar of the thesis, letter by letter; what it gives is what the text means."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0

    def take(self, pattern: re.Pattern[str] | str) -> str | None:
        blank = BLANK.match(self.text, self.at)
        assert blank is not None
        compiled = re.compile(re.escape(pattern)) if isinstance(pattern, str) else pattern
        found = compiled.match(self.text, blank.end())
        if found is None:
            return None
        self.at = found.end()
        return found[0]

    def need(self, pattern: re.Pattern[str] | str) -> str:
        found = self.take(pattern)
        if found is None:
            raise UnreadError
        return found

    def file(self) -> Meaning:
        collections: list[Meaning] = []
        while self.take("begin"):
            rules: list[Meaning] = []
            while not self.take("end"):
                rules.append(self.setting() if self.take("SetFrequency") else self.block())
            collections.append(tuple(rules))
        self.need(re.compile(r"\Z"))
        if not collections:
            raise UnreadError
        return tuple(collections)

    def block(self) -> Meaning:
        self.need("If")
        condition = self.condition()
        self.need("Then")
        self.need("SetFrequency")
        settings = [self.setting()]
        while self.take("SetFrequency"):
            settings.append(self.setting())
        return ("If", condition, tuple(settings))

    def setting(self) -> Meaning:
        return (self.need(TOPIC), float(self.need(NUMBER)))

    def condition(self) -> Meaning:
        if self.take("CheckValue"):
            return (self.need(TOPIC), self.need(PROPERTY), self.need(OPERATOR), float(self.need(NUMBER)))
        self.need("(")
        parts: list[object] = [self.condition()]
        while not self.take(")"):
            parts += [self.take("AND") or self.need("OR"), self.condition()]
        return tuple(parts)


def thesis_meaning(text: str) -> Meaning | None:
    try:
        return Reader(text).file()
    except UnreadError:
        return None


def our_meaning(text: str) -> Meaning:
    result = parse(text, "rules.adirf")
    assert result.findings == ()
    return tuple(tuple(map(statement_meaning, one.statements)) for one in result.file.collections)


def statement_meaning(statement: Statement | Action) -> Meaning:
    if isinstance(statement, Block):
        assert not statement.otherwise
        return ("If", condition_meaning(statement.condition), tuple(map(statement_meaning, statement.then)))
    assert isinstance(statement, SetFrequency)
    return (statement.topic.text, statement.rate.value)


def condition_meaning(condition: Condition) -> Meaning:
    if isinstance(condition, Check):
        return (condition.topic.text, condition.property, condition.operator.value, condition.value)
    assert isinstance(condition, Group)
    return tuple(part for part in flat(condition.operand))


def flat(expression: Condition) -> list[object]:
    """Operands and connectives as they are written, without the parentheses that only precedence adds."""
    if not isinstance(expression, And | Or):
        return [condition_meaning(expression)]
    connective = "AND" if isinstance(expression, And) else "OR"
    parts: list[object] = []
    for operand in expression.operands:
        parts += [connective, *flat(operand)]
    return parts[1:]


KEYWORDS = ("begin", "end", "SetFrequency", "If", "Then", "CheckValue", "AND", "OR")
PROPERTIES = (*KEYWORDS, "pose_x", "_a", "größe", "__len__", "ThenSetFrequency", "EndIf", "Not", "x9")
NUMBERS = ("10", "5.0", "3.", ".5", "1e3", "+7")
WORDS = (*KEYWORDS, *TOPICS, *PROPERTIES, *NUMBERS, "(", ")", ">", "<", "=", "//x\n", "\n")


@cache
def settings_words() -> st.SearchStrategy[list[str]]:
    return st.tuples(st.just("SetFrequency"), st.sampled_from(TOPICS), st.sampled_from(NUMBERS)).map(list)


@cache
def conditions_words() -> st.SearchStrategy[list[str]]:
    check = st.tuples(
        st.just("CheckValue"),
        st.sampled_from(TOPICS),
        st.sampled_from(PROPERTIES),
        st.sampled_from((">", "<", "=")),
        st.sampled_from((*NUMBERS, "-13")),
    ).map(list)
    return st.recursive(
        check,
        lambda inner: st.lists(st.tuples(st.sampled_from(("AND", "OR")), inner), min_size=1, max_size=3).map(
            lambda parts: ["(", *[word for joint, part in parts for word in (joint, *part)][1:], ")"]
        ),
        max_leaves=4,
    )


@cache
@st.composite
def thesis_words(draw: st.DrawFn) -> list[str]:
    """The words of a file of the thesis."""
    words: list[str] = []
    for _ in range(draw(st.integers(1, 2))):
        words.append("begin")
        for is_block in draw(st.lists(st.booleans(), max_size=4)):
            if is_block:
                words += ["If", *draw(conditions_words()), "Then"]
            words += draw(settings_words())
        words.append("end")
    return words


def glued(words: Sequence[str], random: Random, *, is_reckless: bool = False) -> str:
    """``words`` with few blanks: none where the thesis needs none, or ``is_reckless`` anywhere."""
    text = ""
    for word, following in zip(words, [*words[1:], "\n"], strict=True):
        needs_blank = word[0] == "/" or (
            word[-1] in "0123456789." and (following[0].isalnum() or following[0] == ".")
        )
        is_property = word not in KEYWORDS and word[-1].isidentifier() and following[0] not in "<>="
        keeps = (needs_blank or is_property) and not is_reckless
        text += word + (random.choice((" ", "\n", " // c\n")) if keeps or random.random() < 0.2 else "")
    return text


@given(thesis_words(), st.integers(0, 2**32))
@settings(max_examples=300)
def test_a_file_of_the_thesis_with_hardly_a_blank_means_what_it_meant(words: list[str], seed: int) -> None:
    text = glued(words, Random(seed))
    meaning = thesis_meaning(text)
    assert meaning is not None
    assert our_meaning(text) == meaning
    usual = format_rules(text, "rules.adirf")
    assert our_meaning(usual) == thesis_meaning(usual) == meaning
    assert format_rules(usual, "rules.adirf") == usual
    assert parse(usual, "rules.adirf").file.glued == ()


@given(thesis_words(), st.integers(0, 200), st.sampled_from(WORDS), st.integers(0, 2**32), st.booleans())
@settings(max_examples=300)
def test_whatever_the_thesis_takes_is_taken(
    words: list[str], at: int, other: str, seed: int, is_reckless: bool
) -> None:
    words[at % len(words)] = other
    text = glued(words, Random(seed), is_reckless=is_reckless)
    meaning = thesis_meaning(text)
    if meaning is not None:
        assert our_meaning(text) == meaning


@pytest.mark.parametrize(
    "text",
    [
        "beginSetFrequency/odom 10end",
        "10SetFrequency/odom 4",
        "begin SetFrequency /odom 10end",
        "begin IfCheckValue /odom pose_x > 3Then SetFrequency /odom 4 end",
        "begin Thenx end",
    ],
)
def test_what_the_thesis_refuses_for_a_missing_blank_is_refused(text: str) -> None:
    assert thesis_meaning(text) is None
    assert not parse(text, "rules.adirf").is_valid

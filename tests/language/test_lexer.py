# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a text falls into words."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.language.parser import parse
from smarttestudo.language.parser.lexer import Token, TokenKind


def tokenize(text: str) -> tuple[Token, ...]:
    return parse(text, "rules.adirf").tokens


def words(text: str) -> list[str]:
    return [f"{token.kind.name} {token.text}" for token in tokenize(text)[:-1]]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("If(CheckValue", ["IF If", "OPEN (", "CHECK_VALUE CheckValue"]),
        ("5.4)Then", ["NUMBER 5.4", "CLOSE )", "THEN Then"]),
        ("pose_y>-13", ["WORD pose_y", "OPERATOR >", "NUMBER -13"]),
        ("a!=.5e-3", ["WORD a", "OPERATOR !=", "NUMBER .5e-3"]),
        ("10Hz 10 Hz", ["NUMBER 10", "WORD Hz", "NUMBER 10", "WORD Hz"]),
        ("+7. 1E6 007", ["NUMBER +7.", "NUMBER 1E6", "NUMBER 007"]),
        ("/a/b//c", ["WORD /a/b"]),
        ("~/status imu a.b[0].c", ["WORD ~/status", "WORD imu", "WORD a.b[0].c"]),
        (r'"a \" // b"', [r'STRING "a \" // b"']),
        ('"open', ['FOREIGN "open']),
        ("1,5 10abc 1_000", ["FOREIGN 1,5", "FOREIGN 10abc", "FOREIGN 1_000"]),
        ("a==b => =<", ["WORD a", "FOREIGN ==", "WORD b", "FOREIGN =>", "FOREIGN =<"]),
        ("begin BEGIN Full", ["BEGIN begin", "WORD BEGIN", "WORD Full"]),
        ("ThenSetFrequency/odom", ["THEN Then", "SET_FREQUENCY SetFrequency", "WORD /odom"]),
        ("SetFrequency endbegin", ["SET_FREQUENCY SetFrequency", "WORD endbegin"]),
        (
            "CheckValue/a IfNot>1",
            ["CHECK_VALUE CheckValue", "WORD /a", "WORD IfNot", "OPERATOR >", "NUMBER 1"],
        ),
        ("CheckValue a end=1", ["CHECK_VALUE CheckValue", "WORD a", "WORD end", "OPERATOR =", "NUMBER 1"]),
        (
            "CheckValue a\nEndIf\n// b\n=1",
            ["CHECK_VALUE CheckValue", "WORD a", "WORD EndIf", "OPERATOR =", "NUMBER 1"],
        ),
        ("5\nEndIf\nRule", ["NUMBER 5", "END_IF EndIf", "RULE Rule"]),
        ("Thenx x/endbegin", ["WORD Thenx", "WORD x/endbegin"]),
        ("SetFrequency\u00a0/odom\u20031", ["SET_FREQUENCY SetFrequency", "WORD /odom", "NUMBER 1"]),
    ],
)
def test_words_need_no_blanks_between_them_where_they_cannot_be_one(text: str, expected: list[str]) -> None:
    assert words(text) == expected


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_lines_end_at_lf_crlf_or_cr(line_end: str) -> None:
    tokens = tokenize(f"\ufeffbegin{line_end}\t/odom // c{line_end}end")
    assert [(token.text, token.line, token.column) for token in tokens] == [
        ("begin", 1, 1),
        ("/odom", 2, 2),
        ("end", 3, 1),
        ("", 3, 4),
    ]


def test_a_comment_belongs_to_the_word_before_it_or_alone_on_its_line_to_the_next() -> None:
    begin, end, _ = tokenize("begin // one\n// two\n\n// three\n\nend")
    assert begin.beside is not None
    assert begin.beside.text == "// one"
    assert [(comment.text, comment.blank_above) for comment in end.above] == [
        ("// two", False),
        ("// three", True),
    ]
    assert end.blank_above


def test_a_comment_behind_a_connective_is_about_the_check_before_it() -> None:
    number, connective, *_ = tokenize("5.4 AND // upper end\nCheckValue")
    assert number.beside is not None
    assert connective.beside is None


@given(st.text())
def test_nothing_but_blanks_is_lost(text: str) -> None:
    tokens = tokenize(text)
    kept = [token.text for token in tokens]
    kept += [comment.text for token in tokens for comment in token.above]
    kept += [token.beside.text for token in tokens if token.beside]
    assert tokens[-1].kind is TokenKind.END_OF_FILE
    assert sorted("".join("".join(kept).split())) == sorted("".join(text.removeprefix("\ufeff").split()))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text of others is one line, commands no terminal, and reads as what it was."""

from __future__ import annotations

import json
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.texts import visible

TEXTS = st.text(st.characters() | st.characters(categories=("Cc", "Cf", "Cs", "Zl", "Zp")))


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("/odom", "/odom"),
        ("Grüße\u00a0宮\u3000🐢", "Grüße\u00a0宮\u3000🐢"),
        ("a\x1b[2Jb", r"a\u001b[2Jb"),
        ("\x1b]0;title\x07", r"\u001b]0;title\u0007"),
        ("one\ntwo\r\n\tthree", r"one\ntwo\r\n\tthree"),
        ("\x9b2J\x85\x7f", r"\u009b2J\u0085\u007f"),
        ("\u202eabc\u2066\u200f", r"\u202eabc\u2066\u200f"),
        ("\u2028\u2029\ufeff", r"\u2028\u2029\ufeff"),
        ("\udce9", r"\udce9"),
        ("\U000e0041", r"\udb40\udc41"),
    ],
)
def test_what_is_no_letter_is_an_escape(text: str, shown: str) -> None:
    assert visible(text) == shown


@given(TEXTS)
def test_all_that_is_left_has_a_place_on_one_line(text: str) -> None:
    shown = visible(text)
    assert all(one.isprintable() or unicodedata.category(one) == "Zs" for one in shown)
    assert len(f"{shown}|".splitlines()) == 1
    shown.encode("utf-8")
    assert visible(shown) == shown


@given(st.dictionaries(TEXTS, st.none() | st.integers() | TEXTS))
def test_a_line_of_json_says_the_same(value: dict[str, object]) -> None:
    assert json.loads(visible(json.dumps(value, ensure_ascii=False))) == json.loads(json.dumps(value))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""JSON that every reader takes, whatever a robot measures."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.json_text import json_text

numbers = st.floats() | st.integers()
values = st.recursive(
    st.none() | st.booleans() | numbers | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


def strict(text: str) -> object:
    def refuse(word: str) -> object:
        raise ValueError(word)

    return json.loads(text, parse_constant=refuse)


@given(values)
def test_what_is_finite_is_unchanged_and_nothing_else_is_in_it(value: object) -> None:
    def expected(value: object) -> object:
        if isinstance(value, float):
            return value if math.isfinite(value) else None
        if isinstance(value, dict):
            return {key: expected(entry) for key, entry in value.items()}
        return [expected(entry) for entry in value] if isinstance(value, list) else value

    assert strict(json_text(value)) == expected(value)


@pytest.mark.parametrize("number", [math.inf, -math.inf, math.nan])
def test_a_number_that_json_lacks_is_null_however_deep(number: float) -> None:
    assert json_text({"a": (1.5, [number])}, compact=True) == '{"a":[1.5,[null]]}'

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions over a link and their answers arrive as they were sent, and nonsense is refused."""

from __future__ import annotations

import json

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError, UsageError
from smarttestudo.domain.questions import GetParameters, GetTopics, Question, SetParameters
from smarttestudo.link.protocol.question_messages import (
    MAX_QUESTION_BYTES,
    answer_to_bytes,
    error_from_bytes,
    question_from_bytes,
    question_to_bytes,
    texts_from_bytes,
    values_from_bytes,
)

texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
values = st.dictionaries(
    texts,
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | texts
    | st.lists(texts, max_size=3).map(tuple),
    max_size=5,
)
questions = (
    st.lists(texts, max_size=5).map(lambda names: GetParameters(names=tuple(names)))
    | values.map(lambda given: SetParameters(values=given))
    | st.just(GetTopics())
)


@given(questions)
def test_a_question_arrives_on_its_own_key_only(question: Question) -> None:
    data, may_change = question_to_bytes(question), isinstance(question, SetParameters)
    assert question_from_bytes(data, may_change=may_change) == question
    with pytest.raises(LinkError, match="not understood"):
        question_from_bytes(data, may_change=not may_change)


@given(values)
def test_an_answer_arrives(answer: dict[str, object]) -> None:
    assert values_from_bytes(answer_to_bytes(answer)) == answer
    if all(isinstance(value, str) for value in answer.values()):
        assert texts_from_bytes(answer_to_bytes(answer)) == answer
    else:
        with pytest.raises(LinkError):
            texts_from_bytes(answer_to_bytes(answer))


def test_a_refusal_arrives_in_one_line() -> None:
    error = error_from_bytes(answer_to_bytes(UsageError("no\nway", place="here", remedy="go\x1b on")))
    assert isinstance(error, LinkError)
    assert (error.cause, error.place, error.remedy) == ("no way", "here", "go on")
    assert error_from_bytes(b"Timeout") is None


@example(b'"topics"')
@example(b'["topics", "get"]')
@given(st.binary(max_size=40) | st.recursive(texts, st.lists).map(json.dumps).map(str.encode))
def test_nonsense_is_refused(data: bytes) -> None:
    for may_change in (True, False):
        with pytest.raises(LinkError):
            question_from_bytes(data, may_change=may_change)
    assert error_from_bytes(data) is None


@pytest.mark.parametrize(
    "record",
    [
        {"get": ["x"] * 33},
        {"get": ["x" * 256]},
        {"get": [5]},
        {"set": {"x": {"y": 1}}},
        {"set": {"x": [1]}},
        {"set": dict.fromkeys(map(str, range(1001)))},
    ],
)
def test_what_is_beyond_its_bounds_is_refused(record: dict[str, object]) -> None:
    with pytest.raises(LinkError):
        question_from_bytes(json.dumps(record).encode(), may_change="set" in record)


def test_what_is_too_large_is_not_sent() -> None:
    with pytest.raises(LinkError, match="too many"):
        question_to_bytes(SetParameters(values={"rules_text": "x" * MAX_QUESTION_BYTES}))

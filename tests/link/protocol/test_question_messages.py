# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions over a link and their answers arrive as they were sent, and nonsense is refused."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError, UsageError
from smarttestudo.domain.parameter import (
    GetParameters,
    GetTopics,
    ParameterValue,
    Question,
    SetParameters,
    Values,
)
from smarttestudo.link.protocol.messages import (
    ANSWERS,
    CHANGING_QUESTIONS,
    MAX_QUESTION_BYTES,
    READING_QUESTIONS,
    REFUSALS,
    NoAnswer,
)

texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
values = st.dictionaries(
    texts,
    st.none()
    | st.booleans()
    | st.integers(-(2**64) + 1, 2**64 - 1)
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
    asked, other = (
        (CHANGING_QUESTIONS, READING_QUESTIONS)
        if isinstance(question, SetParameters)
        else (READING_QUESTIONS, CHANGING_QUESTIONS)
    )
    data = asked.to_bytes(question)  # type: ignore[arg-type]
    assert asked.from_bytes(data) == question
    with pytest.raises(LinkError, match="malformed"):
        other.from_bytes(data)


@given(values)
def test_an_answer_arrives(answer: Values) -> None:
    assert ANSWERS.from_bytes(ANSWERS.to_bytes(answer)) == answer


def test_a_refusal_arrives_in_one_line() -> None:
    refusal = NoAnswer.of(UsageError("no\nway", place="here", remedy="go\x1b on"))
    error = REFUSALS.from_bytes(REFUSALS.to_bytes(refusal)).error()
    assert (error.cause, error.place, error.remedy) == ("no way", "here", r"go\u001b on")


@given(st.binary(max_size=40), st.binary(max_size=40).map(lambda body: b"\5\7" + body))
def test_nonsense_is_refused(data: bytes, other: bytes) -> None:
    for strange in (data, other):
        for questions in (READING_QUESTIONS, CHANGING_QUESTIONS, REFUSALS):
            with pytest.raises(LinkError):
                questions.from_bytes(strange)


@pytest.mark.parametrize("data", [b"[" * 40, b'{"get": []}', b"\5", b"\5\x08\x07", b"\5\x08\1\0"])
def test_no_frame_is_refused(data: bytes) -> None:
    with pytest.raises(LinkError, match="malformed"):
        READING_QUESTIONS.from_bytes(data)


@pytest.mark.parametrize(
    "question",
    [
        GetParameters(names=("x",) * 33),
        GetParameters(names=("x" * 256,)),
        SetParameters(values=dict.fromkeys(map(str, range(1001)))),
        SetParameters(values={"x" * 256: 1}),
    ],
)
def test_what_is_beyond_its_bounds_is_refused(question: Question) -> None:
    asked = CHANGING_QUESTIONS if isinstance(question, SetParameters) else READING_QUESTIONS
    with pytest.raises(LinkError, match="malformed"):
        asked.from_bytes(asked.to_bytes(question))  # type: ignore[arg-type]


@pytest.mark.parametrize("value", ["x" * MAX_QUESTION_BYTES, 2**64, -(2**64), ("x",) * 5_000])
def test_what_is_too_large_is_not_sent(value: ParameterValue) -> None:
    with pytest.raises(LinkError, match="too"):
        CHANGING_QUESTIONS.to_bytes(SetParameters(values={"rules_text": value}))


def test_what_is_like_a_value_of_a_parameter_travels_as_one() -> None:
    class Name(str):
        __slots__ = ()

    like: Any = {"name": Name("x"), "list": ["a", "b"], "flag": True, "number": 2}
    assert ANSWERS.from_bytes(ANSWERS.to_bytes(like)) == {**like, "list": ("a", "b")}

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of a link arrive as they were sent, reports in less time, and nonsense is refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import example, given
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
from smarttestudo.link.protocol.chunks import Acknowledgement, LostSpan
from smarttestudo.link.protocol.messages import (
    ANSWERS,
    CHANGING_QUESTIONS,
    MAX_QUESTION_BYTES,
    READING_QUESTIONS,
    REFUSALS,
    REPORTS,
    NoAnswer,
    Report,
    ReportReader,
    ReportWriter,
)
from smarttestudo.link.protocol.wire import WIRE_VERSION, Kind, frame, zigzag

VERSION = bytes([WIRE_VERSION])

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


@given(st.binary(max_size=40), st.binary(max_size=40).map(lambda body: VERSION + b"\7" + body))
def test_nonsense_is_refused(data: bytes, other: bytes) -> None:
    for strange in (data, other):
        for questions in (READING_QUESTIONS, CHANGING_QUESTIONS, REFUSALS):
            with pytest.raises(LinkError):
                questions.from_bytes(strange)


@pytest.mark.parametrize(
    "data", [b"[" * 40, b'{"get": []}', VERSION, VERSION + b"\x08\x07", VERSION + b"\x08\1\0"]
)
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


receivers = st.sampled_from((0, 5, 2**64 - 1))
sessions = st.sampled_from((0, 1, 2**32 - 1))
spans = st.lists(st.builds(LostSpan, st.integers(0, 9), st.integers(0, 2**40)), max_size=2).map(tuple)
acknowledgements = st.builds(
    Acknowledgement,
    session=sessions,
    received_bytes=st.integers(0, 2**64 - 1),
    lost=st.just(()) | spans,
    is_cut=st.booleans(),
)
ended = st.just(()) | st.lists(acknowledgements, max_size=2).map(tuple)
plain_reports = st.builds(Report, receiver=receivers, received=acknowledgements, ended=ended)
full_reports = st.builds(
    Report,
    receiver=receivers,
    received=acknowledgements,
    ended=ended,
    ages_ms=st.dictionaries(st.integers(0, 9), st.floats(0, 1e9), max_size=2),
    predicts=st.frozensets(st.sampled_from(("/odom", "/tf"))),
)
# The heads of two receivers, and anything behind them.
forged = st.builds(
    lambda receiver, session, rest: frame(Kind.REPORT, zigzag(receiver) + zigzag(session) + rest),
    receivers,
    st.sampled_from((-1, 0, 1, 2**32)),
    st.binary(max_size=14) | st.integers(-(2**65), 2**65).map(lambda number: zigzag(number) + bytes(5)),
)


@given(receivers, st.lists(st.tuples(acknowledgements, ended)))
def test_a_report_is_written_as_any_other(
    receiver: int, said: list[tuple[Acknowledgement, tuple[Acknowledgement, ...]]]
) -> None:
    writer = ReportWriter(receiver)
    for received, before in said:
        report = Report(receiver=receiver, received=received, ended=before)
        assert writer.to_bytes(received, before) == REPORTS.to_bytes(report)


@given(st.lists(plain_reports.map(REPORTS.to_bytes) | full_reports.map(REPORTS.to_bytes) | forged))
@example([b"", frame(Kind.REPORT, zigzag(0) + zigzag(0)), frame(Kind.REPORT, zigzag(0) * 3 + bytes(1))])
def test_a_report_is_read_as_any_other_whatever_came_before(received: list[bytes]) -> None:
    reader = ReportReader()
    for data in received:
        assert read(reader.from_bytes, data) == read(REPORTS.from_bytes, data)


def read(from_bytes: Callable[[bytes], Report], data: bytes) -> Report | None:
    """The report, or ``None`` where it is refused."""
    try:
        return from_bytes(data)
    except LinkError:
        return None

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reports in less time are the same reports, and what is none is refused all the same."""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import example, given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.chunks import Acknowledgement, LostSpan
from smarttestudo.link.protocol.messages import REPORTS, Report, ReportReader, ReportWriter
from smarttestudo.link.protocol.wire import Kind, frame, zigzag

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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reports as they travel: most differ from the one before only in how much was received."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.link.protocol.acknowledgements import NOTHING_RECEIVED, Acknowledgement
from smarttestudo.link.protocol.messages import REPORTS, Report
from smarttestudo.link.protocol.wire import Kind, Reader, frame, zigzag

_MAX_RECEIVED = 2**64


class _Frame:
    """The bytes before and after the number of received ones, in reports that say nothing else."""

    def __init__(self, receiver: int, received: Acknowledgement, ended: Sequence[Acknowledgement]) -> None:
        self.receiver = receiver
        self.said = (received.session, received.lost, received.is_cut, ended)
        self.head = frame(Kind.REPORT, zigzag(receiver) + zigzag(received.session))
        self.tail = REPORTS.to_bytes(self.report(0))[len(self.head) + len(zigzag(0)) :]

    def report(self, received_bytes: int) -> Report:
        """The report that so many bytes were received."""
        session, lost, is_cut, ended = self.said
        received = Acknowledgement(session=session, received_bytes=received_bytes, lost=lost, is_cut=is_cut)
        return Report(receiver=self.receiver, received=received, ended=ended)


class ReportWriter:
    """Gives what ``REPORTS.to_bytes`` gives for the reports of one ``receiver``, in less time."""

    def __init__(self, receiver: int) -> None:
        self._frame = _Frame(receiver, NOTHING_RECEIVED, ())

    def to_bytes(self, received: Acknowledgement, ended: Sequence[Acknowledgement]) -> bytes:
        """The report of what was received, and of nothing else."""
        if self._frame.said != (received.session, received.lost, received.is_cut, ended):
            self._frame = _Frame(self._frame.receiver, received, ended)
        return self._frame.head + zigzag(received.received_bytes) + self._frame.tail


class ReportReader:
    """Gives what ``REPORTS.from_bytes`` gives, in less time where reports come from one receiver."""

    def __init__(self) -> None:
        self._frame = _Frame(0, NOTHING_RECEIVED, ())

    def from_bytes(self, data: bytes) -> Report:
        """The report of these bytes. Raises ``LinkError`` for anything else."""
        if data.startswith(self._frame.head):
            reader = Reader(data, len(self._frame.head))
            received_bytes = reader.zigzag()
            if reader.rest() == self._frame.tail and 0 <= received_bytes < _MAX_RECEIVED:
                return self._frame.report(received_bytes)
        report = REPORTS.from_bytes(data)
        self._frame = _Frame(report.receiver, report.received, report.ended)
        return report

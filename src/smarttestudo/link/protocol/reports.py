# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reports as they travel: most differ from the one before only in how much was received."""

from __future__ import annotations

from smarttestudo.link.protocol.messages import REPORTS, Report
from smarttestudo.link.protocol.wire import Kind, Reader, frame, zigzag

_NOTHING_ELSE = bytes(2)
"""How a report ends that has neither ages nor predictions."""
_MAX_RECEIVED = 2**64


def _head(receiver: int, session: int) -> bytes:
    return frame(Kind.REPORT, zigzag(receiver) + zigzag(session))


class ReportWriter:
    """Gives what ``REPORTS.to_bytes`` gives for the reports of one ``receiver``, in less time."""

    def __init__(self, receiver: int) -> None:
        self._receiver = receiver
        self._session = 0
        self._head = _head(receiver, 0)

    def to_bytes(self, session: int, received_bytes: int) -> bytes:
        """The report that so many bytes of a session were received, and nothing else."""
        if session != self._session:
            self._session, self._head = session, _head(self._receiver, session)
        return self._head + zigzag(received_bytes) + _NOTHING_ELSE


class ReportReader:
    """Gives what ``REPORTS.from_bytes`` gives, in less time where reports come from one receiver."""

    def __init__(self) -> None:
        self._receiver = self._session = 0
        self._head = _head(0, 0)

    def from_bytes(self, data: bytes) -> Report:
        """The report of these bytes. Raises ``LinkError`` for anything else."""
        if data.startswith(self._head):
            reader = Reader(data, len(self._head))
            received_bytes = reader.zigzag()
            if reader.rest() == _NOTHING_ELSE and 0 <= received_bytes < _MAX_RECEIVED:
                return Report(receiver=self._receiver, session=self._session, received_bytes=received_bytes)
        report = REPORTS.from_bytes(data)
        self._receiver, self._session = report.receiver, report.session
        self._head = _head(report.receiver, report.session)
        return report

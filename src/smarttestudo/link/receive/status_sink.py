# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The statuses of robots, from what arrives of them."""

from __future__ import annotations

import re
from collections.abc import Mapping

from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.status import RuntimeStatus, status_from_text
from smarttestudo.link.openmetrics.status import status_metrics
from smarttestudo.link.protocol.status_stream import MAX_STATUS_BYTES
from smarttestudo.pacing.cdr import string_text

_SHA256 = re.compile(r"(?:[0-9a-f]{64})?", re.ASCII)


class StatusSink:
    """A ``Sink`` that keeps the newest message of ``topic`` of each robot, and reads it when it is asked."""

    def __init__(self, topic: str) -> None:
        self.unreadable = 0
        """Messages that were no status of this version, or one of names that no robot has."""
        self._topic = topic
        self._newest: dict[str, bytes] = {}
        self._statuses: dict[str, RuntimeStatus] = {}

    def open(self, robot: str, stream: StreamInfo) -> None:
        """Any stream may come."""

    def write(self, message: ReceivedMessage) -> None:
        """A message arrived."""
        if message.stream.topic == self._topic:
            self._newest[message.robot] = message.payload

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """The last status of a run stays until the robot's next run is there."""
        if stream.topic == self._topic:
            self._newest.pop(robot, None)
            self._statuses.pop(robot, None)

    def close(self) -> None:
        """Nothing is open."""

    def statuses(self) -> Mapping[str, RuntimeStatus]:
        """The last status of each robot, by its name."""
        newest, self._newest = self._newest, {}
        for robot, payload in newest.items():
            status = _status(payload)
            if status is None:
                self.unreadable += 1
            else:
                self._statuses[robot] = status
        return self._statuses

    def source_hz(self, robot: str, topic: str) -> float | None:
        """The rate of the source of what ``robot`` sends as ``topic``; ``None`` while it is not known."""
        status = self.statuses().get(robot)
        if status is None:
            return None
        return next((one.source_hz for one in status.topics.values() if one.output == topic), None)


def _status(payload: bytes) -> RuntimeStatus | None:
    text = string_text(payload) if len(payload) <= MAX_STATUS_BYTES else None
    try:
        status = status_from_text(text or "")
        # Integers of JSON may be larger than a metric can be.
        status_metrics({"": status})
    except (ValueError, OverflowError):
        return None
    has_names = all(is_topic_name(name) for name in (status.node, *status.topics))
    return status if has_names and _SHA256.fullmatch(status.rules.sha256) else None

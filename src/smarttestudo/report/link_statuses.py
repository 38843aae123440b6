# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The history of a link, from the statuses of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.status_json import status_from_text
from smarttestudo.domain.units import counted
from smarttestudo.report.link_history import MAX_TOPICS, LinkHistory, LinkHistoryBuilder

_TEXT_TYPE = "std_msgs/msg/String"
_MESSAGES_PER_REPORT = 4096


def has_statuses(channels: Iterable[Channel]) -> bool:
    """Whether a recording with these channels lists statuses of a runtime."""
    return any(map(_is_status, channels))


def link_history(
    path: Path, start_ns: int, report: Callable[[float], None]
) -> tuple[LinkHistory | None, tuple[str, ...]]:
    """The history of a link by a recording's statuses, timed from ``start_ns``, and what was not understood.

    Raises:
        RecordingError: it cannot be read.
    """
    builder, decoder, unread = LinkHistoryBuilder(start_ns), RosbagDecoder(), 0
    with open_recording(path) as recording:
        length_ns = max(recording.end_ns - recording.start_ns, 1)
        for number, (channel, stamp_ns, payload) in enumerate(recording.messages({STATUS_TOPIC})):
            if number % _MESSAGES_PER_REPORT == 0:
                report((stamp_ns - recording.start_ns) / length_ns)
            if not _is_status(channel):
                continue
            try:
                text = getattr(decoder.decode(channel, payload), "data", "")
                builder.take(stamp_ns, status_from_text(str(text)))
            except (RecordingError, ValueError):
                unread += 1
    notices = []
    if unread:
        notices.append(f"{counted(unread, 'message')} on {STATUS_TOPIC} could not be understood")
    if builder.left_out:
        notices.append(f"of the link, the first {MAX_TOPICS} topics are shown")
    return builder.history(), tuple(notices)


def _is_status(channel: Channel) -> bool:
    return channel.topic == STATUS_TOPIC and channel.type_name == _TEXT_TYPE

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the recording of an incident holds what its record says."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.recording import HOLDS_NOTHING
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.units import counted, grouped

if TYPE_CHECKING:
    from smarttestudo.domain.incident import IncidentRecord


def content_notices(folder: Path, record: IncidentRecord) -> Iterator[str]:
    """Damage of the recording in ``folder``, and where it holds more or less than ``record`` says.

    All of it is read, with the checksums that it has.
    """
    messages, size_bytes = Counter[str](), Counter[str]()
    try:
        with open_recording(folder) as recording:
            for channel, _, payload in recording.messages():
                messages[channel.topic] += 1
                size_bytes[channel.topic] += len(payload)
            # An incident may hold none; how many there should be says its record.
            yield from (notice for notice in recording.notices() if not notice.endswith(HOLDS_NOTHING))
    except RecordingError as error:
        yield f"the recording cannot be read: {error}"
        return
    for topic in dict.fromkeys((*record.topics, *messages)):
        said = record.topics.get(topic)
        if said is None:
            yield f"{topic}: {counted(messages[topic], 'message')} of which the record says nothing"
        elif messages[topic] != said.messages:
            held = counted(messages[topic], "message")
            yield f"{topic}: the recording holds {held}, the record says {grouped(said.messages)}"
        elif size_bytes[topic] != said.size_bytes:
            held = counted(size_bytes[topic], "byte")
            yield f"{topic}: the messages have {held}, the record says {grouped(said.size_bytes)}"

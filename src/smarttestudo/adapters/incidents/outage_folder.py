# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What could not be sent during an outage, as a folder like that of an incident."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from smarttestudo.adapters.files.incident_store import PARTIAL_SUFFIX
from smarttestudo.adapters.files.whole_file import not_written
from smarttestudo.adapters.incidents.folders import (
    finish_folder,
    finished_record,
    unused_name,
    write_record,
)
from smarttestudo.adapters.incidents.mcap_records import StoredChannel
from smarttestudo.adapters.incidents.segments import BagFolder, SharedMessages
from smarttestudo.domain.incident import IncidentRecord, IncidentTopic
from smarttestudo.domain.remote_incidents import OUTAGE_NAME, OUTAGE_RULE
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.runtime.incidents.topic_ring import SourceMessage

_SEGMENT_NS = 60 * NS_PER_S


class OutageFolder:
    """A rosbag2 of the messages that rules let pass from ``from_ns`` on, below ``folder``.

    It has its name when the outage is over; until then it is hidden, and a killed run's is completed by the
    next. ``channels`` are the topics by name, which may grow. Raises ``OutputFileError``.
    """

    def __init__(
        self, folder: Path, channels: Mapping[str, StoredChannel], from_ns: int, rules_sha256: str
    ) -> None:
        name = unused_name(folder, OUTAGE_NAME, from_ns)
        self._channels = channels
        self._target = folder / name
        self._bag = BagFolder(path=folder / f".{name}{PARTIAL_SUFFIX}", name=name)
        self._shared = SharedMessages(channels, _SEGMENT_NS)
        self._record = IncidentRecord(
            name=OUTAGE_NAME,
            rule=OUTAGE_RULE,
            path="",
            line=0,
            triggered_ns=from_ns,
            from_ns=from_ns,
            to_ns=from_ns,
            values={},
            rules_sha256=rules_sha256,
            topics={},
        )
        try:
            self._bag.path.mkdir(parents=True)
            # What a killed run leaves says what it was.
            write_record(self._bag.path, self._record)
            self._shared.begin(self._bag, 0, [])
        except OSError as error:
            raise not_written(self._target, "an outage", error) from error

    def take(self, message: SourceMessage) -> None:
        """Keep a message."""
        try:
            self._shared.take(message)
        except OSError as error:
            raise not_written(self._target, "an outage", error) from error

    def end(self, to_ns: int) -> Path:
        """The outage is over; where its folder is."""
        try:
            self._shared.end(self._bag)
            contents = self._bag.contents()
            heard = {topic for content in contents.values() for topic in content.messages}
            record = replace(
                self._record,
                to_ns=to_ns,
                topics={topic: IncidentTopic(type_name="", messages=0, size_bytes=0) for topic in heard},
            )
            record = finished_record(record, contents, self._channels)
            finish_folder(self._bag.path, record, contents, self._channels)
            return self._bag.path.rename(self._target)
        except OSError as error:
            raise not_written(self._target, "an outage", error) from error

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recorder in virtual time that writes to a real disk, and what lies there in the end."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bags.bag_reading import read_bag
from incidents.incident_runs import AMPLE_BYTES, trigger
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.metadata_text import offered_qos
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.robot import Qos
from smarttestudo.incidents.folders import Failed, IncidentFolders
from smarttestudo.incidents.recorder import IncidentRecorder
from smarttestudo.incidents.ring_files import RingFiles
from smarttestudo.language.rule_set import RuleSet

MS = 1_000_000
START_MS = 1_000_000
LATCHED = "/tf_static"
# As long as those of sensor messages are with their comments.
DEFINITION = f"string data\n{4000 * chr(35)}\n"


def channel(topic: str, *, definition: str = DEFINITION) -> StoredChannel:
    return StoredChannel(
        topic=topic,
        type_name="std_msgs/msg/String",
        definition=definition,
        qos_text=offered_qos(Qos(reliable=True, transient_local=topic == LATCHED)),
    )


@dataclass
class FolderRun:
    """``came`` are the clock and the steady time of each message, both in ms, its topic and its payload."""

    rule_set: RuleSet
    folder: Path
    topics: tuple[str, ...] = ("/odom", "/scan", LATCHED)
    memory_bytes: int = AMPLE_BYTES
    ring_bytes: int | None = None
    failed: Failed | None = None
    came: list[tuple[int, int, str, bytes]] = field(default_factory=list)
    begun_ms: list[tuple[int, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.ring: RingFiles | None = None
        self.ring_errors: list[TestudoError] = []
        if self.ring_bytes is not None:
            ring_folder = self.folder.with_name("ring")
            ring_folder.mkdir()
            self.ring = RingFiles(ring_folder, self.ring_bytes, failed=self.ring_errors.append)
        self.folders = IncidentFolders(
            self.folder, {topic: channel(topic) for topic in self.topics}, ring=self.ring, failed=self.failed
        )
        self.clock_ms = self.steady_ms = START_MS
        self.recorder = IncidentRecorder(
            self.rule_set,
            self.folders,
            self.memory_bytes,
            START_MS * MS,
            rules_sha256="ab",
            store=None if self.ring is None else self.ring.store,
        )
        for topic in self.topics:
            self.recorder.on_subscribed(topic, START_MS * MS, transient_local=topic == LATCHED)

    def wait(self, by_ms: int) -> None:
        """The clock jumps where that is negative."""
        self.clock_ms += by_ms
        self.steady_ms += max(by_ms, 0)
        self.recorder.advance(self.clock_ms * MS)

    def message(self, topic: str, size_bytes: int = 20) -> None:
        payload = len(self.came).to_bytes(8, "little") + bytes(max(size_bytes - 8, 0))
        self.recorder.on_message(topic, self.clock_ms * MS, payload)
        self.came.append((self.clock_ms, self.steady_ms, topic, payload))

    def trigger(self) -> None:
        self.begun_ms.append((self.clock_ms, self.steady_ms))
        self.recorder.begin(trigger(self.rule_set, self.clock_ms * MS))

    def finish(self) -> list[Path]:
        """The folders of all incidents, in the order of their names."""
        self.recorder.finish(self.clock_ms * MS)
        if self.ring is not None:
            self.ring.close()
        return sorted(path for path in self.folder.iterdir())


def record_of(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "incident.json").read_text())
    return found


def payloads(folder: Path) -> Counter[bytes]:
    """The payloads of an incident with how often each is there; the clock may have been set back by 5 s."""
    found = read_bag(folder)
    notices = [one for one in found.notices if "stamps go back by up to " not in one]
    assert notices == ([] if found.messages else [f"{folder}: the recording holds no message"])
    return Counter(message.payload for message in found.messages)


def disk_bytes(folder: Path) -> int:
    """What the files below it take, each once whatever it is called."""
    found = (path.lstat() for path in folder.rglob("*") if path.is_file())
    return sum({(one.st_dev, one.st_ino): one.st_blocks * 512 for one in found}.values())

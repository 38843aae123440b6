# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that a robot offers, and who fetches them."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from link.zenoh.ends import refuse_warning, until
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import FileContent, McapWriter
from smarttestudo.bags.metadata_text import METADATA_NAME, metadata_text
from smarttestudo.domain.incident import FetchProgress, IncidentRecord, IncidentTopic, incident_text
from smarttestudo.link.zenoh import open_link_incidents, open_robot_end
from smarttestudo.link.zenoh.incidents import LinkIncidents
from smarttestudo.link.zenoh.robot_end import RobotEnd
from smarttestudo.link.zenoh.security import LinkOptions

S = 1_000_000_000
NAME = "20260102T030405678Z-near_miss"
ODOM = StoredChannel(topic="/odom", type_name="nav_msgs/msg/Odometry", definition="float64 x\n" * 90)
IMAGE = StoredChannel(topic="/image", type_name="sensor_msgs/msg/Image", definition="uint8[] data\n")


def write_incident(folder: Path, name: str = NAME, seconds: int = 6) -> Path:
    """Two files of odometry at 20 Hz and images at 2 Hz, with what belongs to an incident."""
    path = folder / name
    path.mkdir(parents=True)
    files: dict[str, FileContent] = {}
    estimates = random.Random(1)
    for number in range(2):
        writer = McapWriter(path / f"{name}_{number}.mcap")
        for tick in range(number * seconds * 20, (number + 1) * seconds * 20):
            writer.write(ODOM, tick * S // 20, tick.to_bytes(8, "little") * 90)
            if tick % 10 == 0:
                # No compression makes it smaller.
                writer.write(IMAGE, tick * S // 20, estimates.randbytes(40_960))
        files[f"{name}_{number}.mcap"] = writer.close()
    (path / METADATA_NAME).write_text(metadata_text(files, [ODOM, IMAGE]))
    record = IncidentRecord(
        name="near miss",
        rule="Close call",
        path="rules.adirf",
        line=3,
        triggered_ns=5 * S,
        from_ns=0,
        to_ns=12 * S,
        values={},
        rules_sha256="",
        topics={"/odom": IncidentTopic(type_name=ODOM.type_name, messages=240, size_bytes=1)},
    )
    (path / "incident.json").write_text(incident_text(record))
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@contextmanager
def listening_robot(
    endpoint: str, folder: Path, name: str = "r1", fetch_budget_kb_per_s: float = math.inf
) -> Iterator[RobotEnd]:
    options = LinkOptions(listen=(endpoint,), fetch_budget_kb_per_s=fetch_budget_kb_per_s)
    with open_robot_end(name, options, refuse_warning) as end:
        end.offer_incidents(folder)
        yield end


@contextmanager
def fetching_from(endpoint: str, robot: str | None = "r1") -> Iterator[LinkIncidents]:
    with open_link_incidents(LinkOptions(connect=(endpoint,)), refuse_warning) as incidents:
        if robot is not None:
            until(lambda: robot in incidents.robots(0))
        yield incidents


def never() -> bool:
    return False


class Progress:
    """What was said of a fetch; ``cancelled`` from ``until_bytes`` on."""

    def __init__(self, until_bytes: float = float("inf")) -> None:
        self.seen: list[FetchProgress] = []
        self.until_bytes = until_bytes

    def __call__(self, progress: FetchProgress) -> None:
        self.seen.append(progress)

    def cancelled(self) -> bool:
        return bool(self.seen) and self.seen[-1].got_bytes >= self.until_bytes

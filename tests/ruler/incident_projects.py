# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A project whose rules recorded something."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from bags.bag_factory import (
    BEST_EFFORT,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    small_mission,
    write_bag,
)
from smarttestudo.cli.main import main

MISSION: BagContent = small_mission(10.0)
"""A robot drives 10 m along y in 10 s."""
TRIGGER_NS = START_NS + 126 * 40_000_000
RULES = """\
begin
    SetFrequency /scan 1
    SetFrequency /map_name Full
    SetFrequency /odom 5
    Rule "Far"
    If CheckValue /odom pose_y > 5
    Then
        Record "near miss" /odom /gripper Before 3 s After 2 s
        Record "all of it" Before 500 ms After 60 s
    EndIf
end
"""
NEAR_MISS = "incidents/20231114T221325040Z-near_miss"
ALL_OF_IT = "incidents/20231114T221325040Z-all_of_it"


def write_incidents(folder: Path) -> None:
    """A recording, ``monday``, rules, ``far.adirf``, and what these record of it, in ``incidents``."""
    folder.mkdir(exist_ok=True)
    write_bag(folder / "monday", MISSION)
    (folder / "far.adirf").write_text(RULES)
    received = folder.parent / "received"
    arguments = ["replay", str(folder / "monday"), "--rules", str(folder / "far.adirf")]
    assert main([*arguments, "--output", str(received), "--incidents", str(folder / "incidents")]) == 0


def add_bad_incidents(folder: Path) -> None:
    """Beside those of ``write_incidents``: one of another version, and one whose record was cut."""
    record = (folder / NEAR_MISS / "incident.json").read_text()
    for name, text in (
        ("20231114T221400000Z-newer", record.replace('"version": 1', '"version": 7')),
        ("20231114T221401000Z-cut", record[:200]),
    ):
        (folder / "incidents" / name).mkdir()
        (folder / "incidents" / name / "incident.json").write_text(text)


COMPRESSED, RAW = "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/Image"
FRAME_NS = 200_000_000
CAMERA_INCIDENT = "seen/20231114T221323120Z-seen"
_SEEN = """\
begin
    SetFrequency /odom 5
    Rule "Seen"
    If CheckValue /odom pose_y > 3.1
    Then
        Record "seen" Before 8 s After 8 s
    EndIf
end
"""


def grey(frame: int) -> int:
    """How bright that frame of a camera is."""
    return 5 * frame


def jpeg(frame: int) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (64, 48), (grey(frame),) * 3).save(file, "JPEG")
    return file.getvalue()


def compressed(format_: str, data: bytes) -> Any:
    return message_of(COMPRESSED, format=format_, data=np.frombuffer(data, np.uint8))


def raw(encoding: str, data: bytes, *, width: int = 2, height: int = 1, step: int) -> Any:
    pixels = np.frombuffer(data, np.uint8)
    return message_of(RAW, encoding=encoding, width=width, height=height, step=step, data=pixels)


def write_camera_incident(folder: Path, more: dict[str, tuple[str, Any]] | None = None) -> None:
    """As ``write_incidents``, of a robot with a camera of 5 Hz, and one message of each topic of ``more``."""
    folder.mkdir(exist_ok=True)
    frames = [
        BagMessage(
            "/camera/compressed", START_NS + at * FRAME_NS, cdr(COMPRESSED, compressed("jpeg", jpeg(at)))
        )
        for at in range(50)
    ]
    others = {
        topic: (kind, BagMessage(topic, START_NS, cdr(kind, one)))
        for topic, (kind, one) in (more or {}).items()
    }
    mission = small_mission(10.0)
    topics = [BagTopic("/camera/compressed", COMPRESSED, (BEST_EFFORT,))]
    topics += [BagTopic(topic, kind, (BEST_EFFORT,)) for topic, (kind, _) in others.items()]
    messages = [*mission.messages, *frames, *(message for _, message in others.values())]
    content = BagContent((*mission.topics, *topics), tuple(sorted(messages, key=lambda one: one.stamp_ns)))
    write_bag(folder / "tuesday", content)
    recorded = "".join(f" {topic}" for topic in ("/odom", "/map_name", *(one.name for one in topics)))
    (folder / "seen.adirf").write_text(_SEEN.replace('"seen"', f'"seen"{recorded}'))
    received = folder.parent / "received_too"
    arguments = ["replay", str(folder / "tuesday"), "--rules", str(folder / "seen.adirf")]
    assert main([*arguments, "--output", str(received), "--incidents", str(folder / "seen")]) == 0

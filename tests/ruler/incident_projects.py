# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A project whose rules recorded something."""

from __future__ import annotations

from pathlib import Path

from bags.bag_factory import START_NS, BagContent, small_mission, write_bag
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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A flood of messages: whatever of it no incident holds is counted in the record, the log and the status."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from incidents.folder_runs import MS, payloads
from incidents.incident_runs import recorder_for, recording_rules, trigger
from robot.status.statuses import STATUS
from robot.status.virtual_robot import SECOND, VirtualRobot
from smarttestudo.bags.incident_record import read_record
from smarttestudo.domain.incident import MissingReason
from smarttestudo.domain.robot import Qos, Subscription
from smarttestudo.domain.units import grouped
from smarttestudo.incidents.live_incidents import LiveIncidents
from smarttestudo.incidents.missing import MOST_LOSSES, missing_text
from smarttestudo.incidents.part_kinds import INCIDENT_MEMORY
from smarttestudo.robot.diagnostics import recording_text
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import PartContext
from smarttestudo.robot.source import LiveSource

FLOOD_HZ = 20_000
RULES = recording_rules('Record "one" /odom Before 1 s After 1 s')
LONG_RULES = recording_rules('Record "one" /odom Before 60 min After 60 min')
ODOMETRY = LiveSource(
    type_name="nav_msgs/msg/Odometry", publishers=1, qos=Qos(reliable=True, transient_local=False)
)


class Robot(VirtualRobot):
    def definition(self, type_name: str) -> str:
        return "float64 x"


@dataclass
class LosingSubscription:
    dropped: int = 0


def flooded(robot: Robot, folder: Path, memory_mb: float) -> tuple[LiveIncidents, int]:
    """Half a second of a flood with an incident in it, and how many messages were sent.

    Every fourth is lost; nothing is written yet.
    """
    settings = Settings([INCIDENT_MEMORY], {INCIDENT_MEMORY.key: memory_mb})
    incidents = LiveIncidents(PartContext(robot=robot, settings=settings, resolve=str), folder)
    incidents.follow(LiveRules(rule_set=RULES), robot.now_ns())
    incidents.on_source("/odom", ODOMETRY, robot.now_ns())
    incidents.on_trigger(trigger(RULES, robot.now_ns()))
    subscription = LosingSubscription()
    sent = 0
    for number in range(FLOOD_HZ // 2):
        robot.elapsed_ns += SECOND // FLOOD_HZ
        if number % 4 == 3:
            subscription.dropped += 1
            continue
        payload, given_over = number.to_bytes(4, "little") + bytes(200), cast("Subscription", subscription)
        incidents.on_message("/odom", payload, None, robot.now_ns(), given_over)
        sent = number + 1
    incidents.on_wake(robot.now_ns())
    return incidents, sent


@pytest.mark.parametrize("memory_mb", [2.0, 100.0], ids=["slow disk", "fast disk"])
def test_what_an_incident_lacks_of_a_flood_is_in_its_record_the_log_and_the_status(
    tmp_path: Path, memory_mb: float
) -> None:
    robot = Robot()
    incidents, sent = flooded(robot, tmp_path, memory_mb)
    # The thread that writes begins only now.
    with incidents.running():
        robot.elapsed_ns += 3 * SECOND
        incidents.on_wake(robot.now_ns())
    (path,) = (one for one in tmp_path.iterdir() if one.is_dir())
    record = read_record(path)
    counts = [(one.reason, one.messages) for one in record.missing if one.messages is not None]
    lost, dropped = counts[0], counts[1:]
    assert lost == (MissingReason.LOST, (sent - 1) // 4)
    assert [reason for reason, _ in dropped] == [MissingReason.DISK] * (memory_mb == 2.0)
    total = sum(count for _, count in counts)
    assert sum(payloads(path).values()) + total == sent
    text = missing_text(record.missing)
    assert f"{grouped(lost[1])} of /odom (lost)" in text
    assert [line for line in robot.log_lines if "lacks" in line] == [f"incident {path.name}: {text}"]
    warned = [line for line in robot.log_lines if "faster than the disk" in line]
    assert len(warned) == len(dropped)
    state = incidents.added_to(STATUS).incidents
    assert state is not None
    assert (state.dropped, state.missing) == (sum(count for _, count in dropped), total)
    assert f"{grouped(total)} messages missing" in recording_text(state)


@given(st.lists(st.tuples(st.integers(1, 500), st.integers(0, 700)), min_size=1, max_size=300), st.data())
def test_all_losses_of_a_window_are_counted_and_told_in_few_entries(
    losses: list[tuple[int, int]], data: st.DataObject
) -> None:
    recorder, sink = recorder_for(LONG_RULES)
    begins = data.draw(st.integers(0, len(losses) - 1))
    now_ms = 0
    for number, (count, after_ms) in enumerate(losses):
        now_ms += after_ms
        if number == begins:
            recorder.begin(trigger(LONG_RULES, now_ms * MS))
        recorder.lose("/odom", count, now_ms * MS, now_ms * MS)
    recorder.finish(now_ms * MS)
    (one,) = sink.kept
    lost = [each for each in one.missing or () if each.reason is MissingReason.LOST]
    assert sum(each.messages or 0 for each in lost) == sum(count for count, _ in losses)
    assert len(lost) <= MOST_LOSSES
    assert (lost[0].from_ns, lost[-1].to_ns) == (losses[0][1] * MS, now_ms * MS)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of ``examples/robot_with_modes.adirf`` as they are, over a recording of such a robot."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bags.bag_factory import (
    LATCHED,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    qos,
    write_bag,
)
from bags.bag_reading import read_bag
from smarttestudo.cli.main import main

EXAMPLE = Path(__file__).parents[2] / "examples" / "robot_with_modes.adirf"
PROFILE = """\
allow_calls = ["/lidar/reset"]
allow_parameters = { "/camera_driver" = ["jpeg_quality"] }
"""
END_S = 200
EXECUTING, SUCCEEDED, ABORTED = 2, 4, 6
FATAL, ERROR, CHARGING, DISCHARGING = 50, 2, 1, 2
BOOL, STRING = "std_msgs/msg/Bool", "std_msgs/msg/String"
SCAN, BATTERY = "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/BatteryState"
GOALS, EVENT = "action_msgs/msg/GoalStatusArray", "lifecycle_msgs/msg/TransitionEvent"
LOG, DIAGNOSTICS = "rcl_interfaces/msg/Log", "diagnostic_msgs/msg/DiagnosticArray"
TOPICS = {
    "/mode": (STRING, LATCHED),
    "/estop": (BOOL, LATCHED),
    "/camera/left": (STRING, qos()),
    "/camera/right": (STRING, qos()),
    "/scan": (SCAN, qos()),
    "/battery_state": (BATTERY, qos()),
    "/navigate_to_pose/_action/status": (GOALS, LATCHED),
    "/diagnostics": (DIAGNOSTICS, qos()),
    "/rosout": (LOG, qos()),
    "/controller_server/transition_event": (EVENT, qos()),
}
Moment = tuple[float, str, dict[str, Any]]


def times_s(hz: float, from_s: float = 0.0, to_s: float = END_S) -> list[float]:
    return [from_s + number / hz for number in range(int((to_s - from_s) * hz))]


def goals(*statuses: int) -> dict[str, Any]:
    """The first goal is the oldest."""
    entries = []
    for number, status in enumerate(statuses):
        uuid = message_of("unique_identifier_msgs/msg/UUID", uuid=np.full(16, number, dtype=np.uint8))
        stamp = message_of("builtin_interfaces/msg/Time", sec=number + 1)
        info = message_of("action_msgs/msg/GoalInfo", goal_id=uuid, stamp=stamp)
        entries.append(message_of("action_msgs/msg/GoalStatus", goal_info=info, status=status))
    return {"status_list": entries}


def part(name: str, level: int) -> dict[str, Any]:
    return {"status": [message_of("diagnostic_msgs/msg/DiagnosticStatus", name=name, level=level)]}


def state(label: str) -> dict[str, Any]:
    return {"goal_state": message_of("lifecycle_msgs/msg/State", label=label)}


def day() -> Iterator[Moment]:
    yield from sensed()
    # The lidar's node says ERROR for a minute, another node that all is well.
    yield from (
        (t_s, "/diagnostics", part("lidar front", ERROR * (100 <= t_s < 160))) for t_s in times_s(1, 0.1)
    )
    yield from ((t_s, "/diagnostics", part("battery", 0)) for t_s in times_s(5, 0.15))
    for t_s, statuses in (
        (0.0, (ABORTED,)),
        (70.0, (ABORTED, EXECUTING)),
        (72.0, (ABORTED, ABORTED)),
        (80.0, (ABORTED, ABORTED, EXECUTING)),
        (82.0, (ABORTED, ABORTED, ABORTED)),
        (90.0, (ABORTED, ABORTED, ABORTED, EXECUTING)),
        (92.0, (ABORTED, ABORTED, ABORTED, EXECUTING, EXECUTING)),
        (92.1, (ABORTED, ABORTED, ABORTED, ABORTED, EXECUTING)),
        (95.0, (ABORTED, ABORTED, ABORTED, ABORTED, SUCCEEDED)),
    ):
        yield t_s, "/navigate_to_pose/_action/status", goals(*statuses)
    for t_s, name, level in (
        (2.0, "controller_server", 20),
        (170.0, "planner_server", FATAL),
        (175.0, "controller_server", FATAL),
        (178.0, "controller_server", FATAL),
    ):
        yield t_s, "/rosout", {"name": name, "level": level}
    for t_s, label in ((3.0, "active"), (180.0, "deactivating"), (180.1, "inactive"), (190.0, "active")):
        yield t_s, "/controller_server/transition_event", state(label)


def sensed() -> Iterator[Moment]:
    """Cameras, of which one is there for a while, the scan, the battery, the mode and the emergency stop."""
    yield from ((t_s, "/camera/left", {}) for t_s in times_s(10))
    yield from ((t_s, "/camera/right", {}) for t_s in times_s(10, 22, 40))
    for t_s in times_s(20):
        near = np.array([0.4 if 40 <= t_s < 44 else 5.0], dtype=np.float32)
        yield t_s, "/scan", {"range_min": 0.1, "range_max": 9.0, "ranges": near}
    for t_s in times_s(2):
        yield t_s, "/battery_state", {"power_supply_status": CHARGING if 50 <= t_s < 60 else DISCHARGING}
    for t_s, text in ((0.0, "driving"), (20.0, "docking"), (30.0, "driving")):
        yield t_s, "/mode", {"data": text}
    for t_s, is_pressed in ((0.0, False), (65.0, True), (68.0, False)):
        yield t_s, "/estop", {"data": is_pressed}


def recording(folder: Path) -> Path:
    messages = [
        BagMessage(
            topic,
            START_NS + round(t_s * 1e9) + number,
            cdr(TOPICS[topic][0], message_of(TOPICS[topic][0], **fields)),
        )
        for number, (t_s, topic, fields) in enumerate(day())
    ]
    messages.sort(key=lambda one: one.stamp_ns)
    topics = tuple(BagTopic(name, type_name, (offered,)) for name, (type_name, offered) in TOPICS.items())
    return write_bag(folder / "bag", BagContent(topics, tuple(messages)))


@pytest.fixture(scope="module")
def replayed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what a replay of the day left."""
    folder = tmp_path_factory.mktemp("day")
    bag = recording(folder)
    (folder / "profile.toml").write_text(PROFILE, encoding="utf-8")
    options = ["--profile", str(folder / "profile.toml"), "--output", str(folder / "out")]
    options += ["--decisions", str(folder / "decisions.jsonl"), "--incidents", str(folder / "incidents")]
    assert main(["replay", str(bag), "--rules", str(EXAMPLE), *options]) == 0
    return folder


def decisions(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "decisions.jsonl").read_text("utf-8").splitlines()]


def test_rates_follow_words_margins_and_patterns(replayed: Path) -> None:
    rates: dict[str, list[tuple[int, float | None, str | None]]] = defaultdict(list)
    for one in decisions(replayed):
        if "topic" in one and one["t"] >= 15:
            rates[one["topic"]].append((int(one["t"]), one["to_hz"], one["rule"]))
    assert rates["/camera/left"] == [(20, 10.0, "Docking"), (30, 2.0, None)]
    assert rates["/camera/right"] == [(20, 10.0, "Docking"), (30, 2.0, None)]
    assert rates["/scan"] == [
        *((40, 20.0, None), (44, 2.0, None), (55, 0.5, "Charging"), (60, 2.0, None)),
        *((65, None, "Emergency stop"), (68, 2.0, None)),
    ]
    assert rates["/diagnostics"] == [(100, None, "Anything in error"), (169, 0.5, None)]


def test_a_camera_that_appears_is_relayed_from_its_first_message(replayed: Path) -> None:
    out = [one for one in read_bag(replayed / "out").messages if one.topic == "/camera/right"]
    assert out[0].stamp_ns - START_NS < 22.01e9


def test_faults_are_one_incident_each(replayed: Path) -> None:
    records = [
        json.loads(path.read_text("utf-8")) for path in sorted(replayed.glob("incidents/*/incident.json"))
    ]
    begun = [(one["name"], round((one["triggered_ns"] - START_NS) / 1e9, 1)) for one in records]
    assert begun == [
        *(("goal aborted", 72.0), ("goal aborted", 82.0), ("lidar error", 100.1)),
        *(("controller fatal", 175.0), ("controller inactive", 180.1)),
    ]
    assert not any(one.get("moments") for one in records)


def test_actions_are_decided_once_and_not_done(replayed: Path) -> None:
    acted = [
        (round(one["t"], 1), one["event"], one["action"], one["target"])
        for one in decisions(replayed)
        if "action" in one
    ]
    notice = ("Notify", "The emergency stop is pressed")
    assert acted == [
        *((65.0, "begin", *notice), (68.0, "end", *notice)),
        (100.1, "begin", "Call", "/lidar/reset"),
    ]

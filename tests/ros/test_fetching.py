# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a running robot records, and what it could not send in an outage, at its operator's over the link."""

from __future__ import annotations

import json
import re
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_reading import read_bag, read_with_rosbags
from ros.live_incidents import COUNT, ODOM, numbers, recorded
from ros.ros_processes import LINE_TIMEOUT_S, Process, SmallRobot
from ros.test_incidents import trigger
from ros.test_link import WITHOUT_ROS

RULES = """\
begin
  SetFrequency /odom 5
  SetFrequency /count Full
  Rule "Far" If CheckValue /odom pose_x > 4 Then
    Record "near miss" /odom /count Before 2 s After 500 ms
  EndIf
end
"""
LOST = re.compile(r"/count: lost (\d+) messages before they could be relayed")


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != "read"}


def lost_before(runtime: Process) -> int:
    """How many messages of /count it said to have lost before they could be relayed."""
    return sum(int(number) for line in runtime.output for number in LOST.findall(line))


def until(condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + LINE_TIMEOUT_S
    while not condition():
        assert time.monotonic() < end_s, "it took too long"
        time.sleep(0.05)


def test_an_incident_is_listed_fetched_and_after_a_kill_fetched_to_its_end(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    there, here = robot.folder / "incidents", operators.folder / "fetched"
    mirrored = operators.folder / "mirrored"
    operators.receiver(endpoint, "--incidents", str(mirrored))
    source = robot.source(odom=ODOM, count=COUNT)
    runtime = robot.runtime(RULES, "--link", endpoint, "--robot", "tb3", "--incidents", str(there))
    runtime.line_with("/count: std_msgs/msg/String")
    heard = robot.operator(span_s=2.0, count={"type": "std_msgs/msg/String", "topic": "/count"})
    heard.line_with("heard 1")
    trigger(source)
    name = recorded(runtime)

    def testudo(*words: str) -> list[str]:
        return [
            sys.executable,
            "-c",
            WITHOUT_ROS,
            "incidents",
            *words,
            "--connect",
            endpoint,
            "--robot",
            "tb3",
        ]

    listing = operators.command(*testudo("list", "--json"))
    (listed,) = json.loads(listing.line_with(name))
    assert (listed["name"], listed["label"], listed["rule"]) == (name, "near miss", "Far")
    assert listing.exit_code() == 0
    fetch = testudo("fetch", name, "--output", str(here))
    killed = operators.command(*fetch)
    until(lambda: (here / f".{name}.partial").is_dir() or (here / name).is_dir())
    killed.signal(signal.SIGKILL)
    killed.exit_code()
    again = operators.command(*fetch)
    again.line_with(f"MB in {here / name}")
    assert again.exit_code() == 0
    assert contents(here / name) == contents(there / name)
    assert read_with_rosbags(here / name) == read_bag(there / name).messages
    # What the operator's end fetches by itself is the same.
    until((mirrored / "tb3" / name).is_dir)
    assert contents(mirrored / "tb3" / name) == contents(there / name)


@pytest.mark.contract
def test_what_could_not_be_sent_in_an_outage_is_caught_up_with(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    there, here = robot.folder / "incidents", operators.folder / "gaps"
    first = operators.receiver(endpoint, "--catch-up", str(here))
    station = operators.operator(count={"type": "std_msgs/msg/String", "topic": "/count", "reliable": True})
    robot.source(count={**COUNT, "hz": 20})
    # Of a topic that is Full, all that fits into its queue is sent after all.
    rules = RULES.replace("/count Full", "/count 200")
    runtime = robot.runtime(
        rules, "--link", endpoint, "--robot", "tb3", "--incidents", str(there), "--catch-up"
    )
    station.line_with("heard 1")
    first.signal(signal.SIGKILL)
    first.exit_code()
    until(lambda: any(there.glob(".*-outage.partial/*.mcap")))
    second = operators.receiver(endpoint, "--catch-up", str(here))
    name = Path(runtime.line_with(": kept for who asks").partition("outage ")[2].partition(":")[0]).name
    second.line_with(f"tb3: outage {here / 'tb3' / name}")
    assert contents(here / "tb3" / name) == contents(there / name)
    record = json.loads((here / "tb3" / name / "incident.json").read_text())
    assert (record["name"], record["rule"]) == ("outage", "(link)")
    found = numbers(read_bag(here / "tb3" / name).messages)
    assert found == sorted(set(found))
    # What a busy machine loses before it could be sent is said, and not missed in the outage.
    while found[-1] - found[0] + 1 - len(found) > lost_before(runtime):
        runtime.line_with("/count: lost ")
    # It takes a second of silence at least until the robot's end knows.
    assert record["topics"]["/count"]["messages"] == len(found) > 10

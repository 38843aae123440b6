# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run --incidents``: what a running robot's rules record, from before it mattered."""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path

import pytest

from bags.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from ros.live_incidents import COUNT, FRAMES, HEARD_COUNT, ODOM, numbers, record_of, recorded
from ros.ros_processes import TESTUDO, Process, SmallRobot
from smarttestudo.domain.errors import RecordingError

RULES = """\
begin
  SetFrequency /odom 5
  Rule "Far" If CheckValue /odom pose_x > 4 Then
    Record "near miss" /odom /count Before 2 s After 500 ms
  EndIf
end
"""


def start(robot: SmallRobot, folder: Path, *options: str, rules: str = RULES) -> Process:
    runtime = robot.runtime(rules, "--incidents", str(folder), *options)
    runtime.line_with("/count: std_msgs/msg/String")
    return runtime


def trigger(source: Process) -> None:
    source.say("home odom")
    source.say("move odom")


@pytest.mark.parametrize("data_path", ["auto", "rclpy"])
@pytest.mark.contract
def test_an_incident_of_a_running_robot_is_whole(robot: SmallRobot, data_path: str) -> None:
    folder = robot.folder / "incidents"
    source = robot.source(odom=ODOM, count=COUNT, tf_static=FRAMES)
    runtime = start(robot, folder, "--data-path", data_path)
    # The runtime heard what it relayed for so long, too.
    heard = robot.operator(span_s=2.5, odom={"type": "nav_msgs/msg/Odometry"}, count=HEARD_COUNT)
    heard.line_with("heard 1")
    trigger(source)
    path = folder / recorded(runtime)
    messages = read_bag(path).messages
    found = numbers(messages)
    record = record_of(path)
    lost = sum(one["messages"] for one in record["missing"] if one["topic"] == "/count")
    assert found == sorted(set(found))
    # What a busy machine loses is not known through rclpy.
    assert found[-1] - found[0] + 1 - len(found) <= lost or data_path == "rclpy"
    assert {one["reason"] for one in record["missing"]} <= {"lost"}
    assert [one["topic"] for one in record["latched"]] == ["/tf_static"]
    assert read_with_rosbags(path) == messages
    assert sum(len(read_with_mcap(one)) for one in path.glob("*.mcap")) == len(messages)
    assert record["from_ns"] <= min(one.stamp_ns for one in messages)
    assert max(one.stamp_ns for one in messages) <= record["to_ns"]


@pytest.mark.contract
def test_a_killed_run_is_completed_by_the_next_which_goes_on(robot: SmallRobot) -> None:
    folder = robot.folder / "incidents"
    source = robot.source(odom=ODOM, count=COUNT)
    first = start(robot, folder, rules=RULES.replace("500 ms", "600 s"))
    heard = robot.operator(span_s=1.0, count={"type": "std_msgs/msg/String", "topic": "/count"})
    heard.line_with("heard 1")
    source.say("move odom")
    while not (left := [one.parent for one in folder.glob(".*.partial/*.mcap") if _holds_messages(one)]):
        time.sleep(0.01)
    first.signal(signal.SIGKILL)
    assert first.exit_code() == -signal.SIGKILL
    messages = read_bag(left[0]).messages
    second = robot.runtime(RULES, "--incidents", str(folder))
    name = second.line_with("was not ended; completed with").partition("incident ")[2].partition(":")[0]
    assert read_with_rosbags(folder / name) == messages
    found = numbers(messages)
    assert found == sorted(set(found))
    assert "killed" in {one["reason"] for one in record_of(folder / name)["missing"]}
    second.line_with("/count: std_msgs/msg/String")
    trigger(source)
    assert (folder / recorded(second)).is_dir()


def _holds_messages(file: Path) -> bool:
    try:
        return len(read_bag(file.parent).messages) > 0
    except RecordingError:
        # It was made a moment ago.
        return False


@pytest.mark.contract
def test_a_full_disk_ends_incidents_which_are_named_and_relays_go_on(robot: SmallRobot) -> None:
    folder = robot.folder / "incidents"
    folder.mkdir()
    source = robot.source(odom=ODOM, count=COUNT)
    rules = robot.folder / "rules.adirf"
    rules.write_text(RULES, encoding="utf-8")
    run = [sys.executable, "-c", TESTUDO, "run", "--rules", str(rules), "--incidents", str(folder)]
    on_small_disk = f'mount -t tmpfs -o size=60k none "{folder}" && exec "$@"'
    namespace = ["unshare", "--user", "--map-root-user", "--mount"]
    runtime = robot.command(*namespace, "sh", "-c", on_small_disk, "sh", *run)
    runtime.line_with("/count: std_msgs/msg/String")
    operator = robot.operator(span_s=1.0, odom={"type": "nav_msgs/msg/Odometry"})
    operator.line_with("heard 1")
    trigger(source)
    assert "No space left on device" in runtime.line_with("ends early")
    operator.line_with("heard 2")
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    # Whatever was lost of it, it is said once.
    assert len([line for line in runtime.output if "incident " in line and "error" in line]) == 1


def test_a_topic_that_is_dead_from_the_start_is_recorded(robot: SmallRobot) -> None:
    folder = robot.folder / "incidents"
    rule = 'If CheckValue /scan rate < 1 Then Record "dead lidar" /odom /scan Before 2 s After 5 s EndIf'
    robot.source(odom=ODOM)
    runtime = robot.runtime(f"begin\n  {rule}\nend\n", "--incidents", str(folder))
    path = folder / recorded(runtime)
    record = record_of(path)
    assert (record["name"], record["values"]) == ("dead lidar", {"/scan rate": 0})
    # A busy machine may lose some as well.
    reasons = {(one["topic"], one["reason"]) for one in record["missing"]} - {("/odom", "lost")}
    assert reasons == {("/odom", "late"), ("/scan", "late")}
    assert {one.topic for one in read_bag(path).messages} == {"/odom"}


def test_incidents_beyond_their_share_of_the_disk_are_deleted_and_named(robot: SmallRobot) -> None:
    folder = robot.folder / "incidents"
    names = [f"2026010{day}T000000000Z-old" for day in (1, 2, 3)]
    for name in names:
        (folder / name).mkdir(parents=True)
        (folder / name / "incident.json").write_text("{}")
        (folder / name / f"{name}_0.mcap").write_bytes(bytes(900_000))
    (folder / names[1] / "read").touch()
    runtime = robot.runtime(RULES, "--incidents", str(folder), "--incidents-max-gb", "0.002")
    runtime.line_with(f"incident {names[1]}: deleted to make room, read")
    assert sorted(path.name for path in folder.glob("[!.]*")) == [names[0], names[2]]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a live incident holds every message of its window, by the word of others who heard the same."""

from __future__ import annotations

import signal
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from random import Random
from typing import Any

import pytest

from bags.bag_factory import BagMessage
from bags.bag_reading import read_bag
from ros.live_incidents import COUNT, FRAMES, HEARD_COUNT, ODOM, numbers, record_of, recorded
from ros.ros_processes import Process, SmallRobot, threads_of
from smarttestudo.loop.input_log import read_inputs
from smarttestudo.loop.inputs import MessageInput

INCIDENTS = 10
S = 1_000_000_000
CLOCK = {"type": "rosgraph_msgs/msg/Clock", "hz": 100, "from_s": 10_000, "step_ms": 10}


def rules(record: str) -> str:
    return f"""\
begin
  SetFrequency /odom 5
  SetFrequency /count 5
  Rule "Far" If CheckValue /odom pose_x > 4 Then
    SetFrequency /odom 10
    {record}
  EndIf
end
"""


def leave(source: Process, runtime: Process) -> None:
    """Have the block begin to hold."""
    source.say("move odom")
    runtime.line_with("/odom: 5 Hz → 10 Hz")


def come_home(source: Process, runtime: Process) -> None:
    """Have it hold no longer."""
    source.say("home odom")
    runtime.line_with("/odom: 10 Hz → 5 Hz")


def leave_at_random(random: Random, source: Process, runtime: Process, subscriber: Process) -> None:
    """Have incidents at random moments, among what the subscriber hears."""
    for _ in range(INCIDENTS):
        for _ in range(random.randint(1, 12)):
            subscriber.line_with("heard ")
        leave(source, runtime)
        for _ in range(random.randint(0, 3)):
            subscriber.line_with("heard ")
        come_home(source, runtime)


def whole(folder: Path, moments: int) -> list[Path]:
    """The incidents of so many moments, once they are there."""
    while True:
        found = sorted(folder.glob("[!.]*"))
        if sum(record_of(path).get("moments", 1) for path in found) >= moments:
            return found
        time.sleep(0.01)


def lost(record: dict[str, Any], topic: str, *reasons: str) -> int:
    missing = (one for one in record["missing"] if one["topic"] == topic and one["reason"] in reasons)
    return sum(one["messages"] for one in missing)


def stamps(messages: Iterable[BagMessage | MessageInput], topic: str) -> list[int]:
    return [one.stamp_ns for one in messages if one.topic == topic]


@pytest.mark.parametrize("data_path", ["auto", "rclpy"])
def test_incidents_at_random_moments_hold_what_the_loop_and_a_plain_subscriber_heard(
    robot: SmallRobot, data_path: str
) -> None:
    folder, inputs = robot.folder / "incidents", robot.folder / "inputs"
    source = robot.source(odom=ODOM, count=COUNT, tf_static=FRAMES)
    runtime = robot.runtime(
        rules('Record "near miss" /odom /count Before 2 s After 500 ms'),
        *("--incidents", str(folder), "--record-inputs", str(inputs), "--data-path", data_path),
    )
    runtime.line_with("/count: std_msgs/msg/String")
    robot.operator(odom={"type": "nav_msgs/msg/Odometry"}).line_with("heard")
    subscriber = robot.operator(span_s=0.1, count=HEARD_COUNT)
    leave_at_random(Random(data_path), source, runtime, subscriber)
    paths = whole(folder, INCIDENTS)
    heard = {int(value) for _, value, _ in subscriber.result()["count"]}
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    given = [one for one in read_inputs(inputs) if isinstance(one, MessageInput)]
    for path in paths:
        messages, record = read_bag(path).messages, record_of(path)
        from_ns, to_ns = record["from_ns"], record["to_ns"]
        assert {one["reason"] for one in record["missing"]} <= {"lost", "late"}
        for topic in ("/odom", "/count"):
            of_loop = [one for one in stamps(given, topic) if from_ns <= one <= to_ns]
            of_incident = stamps(messages, topic)
            assert Counter(of_incident) == Counter(of_loop)
        found = numbers(messages)
        assert found == sorted(set(found))
        # What is lost through rclpy is not said, which does not know of it.
        between = {number for number in heard if found[0] <= number <= found[-1]}
        assert len(between - set(found)) <= lost(record, "/count", "lost") or data_path == "rclpy"
        was_heard_before = "/tf_static" in {one["topic"] for one in record["latched"]}
        (static_ns,) = stamps(messages, "/tf_static")
        # What was heard before the window stands at its beginning.
        assert from_ns <= static_ns <= (from_ns if was_heard_before else to_ns)


@pytest.mark.parametrize("is_relayed", [True, False])
def test_incidents_of_a_topic_that_comes_without_python_hold_what_a_plain_subscriber_heard(
    robot: SmallRobot, is_relayed: bool
) -> None:
    folder = robot.folder / "incidents"
    text = rules('Record "near miss" /odom /count Before 2 s After 500 ms')
    runtime = robot.runtime(
        text if is_relayed else text.replace("SetFrequency /count 5", ""),
        *("--incidents", str(folder), "--data-path", "fast"),
    )
    runtime.line_with("compiled relays")
    threads = threads_of(runtime.pid)
    source = robot.source(odom=ODOM, count=COUNT)
    runtime.line_with("/count: std_msgs/msg/String")
    robot.operator(odom={"type": "nav_msgs/msg/Odometry"}).line_with("heard")
    subscriber = robot.operator(span_s=0.1, count=HEARD_COUNT)
    while not threads_of(runtime.pid) - threads:
        subscriber.line_with("heard ")
    leave_at_random(Random(3), source, runtime, subscriber)
    paths = whole(folder, INCIDENTS)
    heard = {int(value) for _, value, _ in subscriber.result()["count"]}
    for path in paths:
        messages, record = read_bag(path).messages, record_of(path)
        assert {one["reason"] for one in record["missing"]} <= {"lost", "late"}
        at_ns = stamps(messages, "/count")
        assert at_ns == sorted(at_ns)
        assert record["from_ns"] <= at_ns[0] <= at_ns[-1] <= record["to_ns"]
        found = numbers(messages)
        assert found == sorted(set(found))
        between = {number for number in heard if found[0] <= number <= found[-1]}
        assert len(between - set(found)) <= lost(record, "/count", "lost")


def test_a_past_that_memory_cannot_hold_comes_from_disk(robot: SmallRobot) -> None:
    folder, ring = robot.folder / "incidents", robot.folder / "ring"
    source = robot.source(odom=ODOM, count={**COUNT, "size_bytes": 10_000})
    record = rules('Record "long" /odom /count Before 5 s After 500 ms')
    keep = ("--incident-ring", str(ring), "--incident-memory", "2")
    runtime = robot.runtime(record, "--incidents", str(folder), *keep)
    runtime.line_with("/count: std_msgs/msg/String")
    subscriber = robot.operator(span_s=6.0, count=HEARD_COUNT)
    subscriber.line_with("heard 1")
    leave(source, runtime)
    path = folder / recorded(runtime)
    messages, entry = read_bag(path).messages, record_of(path)
    assert sum(len(one.payload) for one in messages if one.stamp_ns < entry["triggered_ns"]) > 2_000_000
    found = numbers(messages)
    assert found == sorted(set(found))
    assert found[-1] - found[0] + 1 - len(found) <= lost(entry, "/count", "lost", "memory", "disk")
    other = robot.runtime(record, "--incidents", str(robot.folder / "other"), *keep)
    assert other.exit_code() == 1
    assert "another run records here; name another folder with --incident-ring" in other.output[-1]
    runtime.signal(signal.SIGKILL)
    runtime.exit_code()
    assert [one.name for one in ring.iterdir()] == [".lock"]


def test_a_clock_that_jumps_in_a_window_neither_keeps_it_open_nor_costs_messages(robot: SmallRobot) -> None:
    folder = robot.folder / "incidents"
    source = robot.source(odom=ODOM, count=COUNT, clock=CLOCK)
    runtime = robot.runtime(
        rules('Record "jump" /odom /count Before 1 s After 2 s'),
        *("--incidents", str(folder), "--ros-args", "-p", "use_sim_time:=true"),
    )
    runtime.line_with("/count: std_msgs/msg/String")
    subscriber = robot.operator(span_s=1.0, count=HEARD_COUNT)
    subscriber.line_with("heard 1")
    # The clock stands still until it jumps, so that no window ends before.
    source.say("hush clock")
    leave(source, runtime)
    source.say("rewind clock")
    source.say("speak clock")
    back = folder / recorded(runtime)
    come_home(source, runtime)
    source.say("hush clock")
    leave(source, runtime)
    source.say("skip clock")
    source.say("speak clock")
    ahead = folder / recorded(runtime)
    heard = {int(value) for _, value, _ in subscriber.result()["count"]}
    for path in (back, ahead):
        # In the order of their stamps, which jump.
        found = sorted(numbers(read_bag(path).messages))
        assert len(found) == len(set(found))
        between = {number for number in heard if found[0] <= number <= found[-1]}
        assert len(between - set(found)) <= lost(record_of(path), "/count", "lost")
    record, at_ns = record_of(back), stamps(read_bag(back).messages, "/count")
    before = [one for one in at_ns if one >= 10_000 * S]
    after = [one for one in at_ns if one < 10_000 * S]
    assert after
    assert max(before) - record["triggered_ns"] + max(after) - min(after) <= 2 * S
    assert max(stamps(read_bag(ahead).messages, "/count")) <= record_of(ahead)["to_ns"]

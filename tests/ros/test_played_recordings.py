# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recording of a run, with what SmartTestudo said of itself, played beside another run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from bags.bag_factory import BagContent, BagMessage, BagTopic, odometry
from replays.replay_runs import replay_content
from ros.ros_processes import SmallRobot, on_every_data_path
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.recording_sink import RecordingSink
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import OWN_TOPICS, STATUS_TOPIC, TEXT_TYPE
from smarttestudo.domain.recording import Storage
from smarttestudo.domain.robot import Qos
from smarttestudo.pacing.cdr import string_message

ODOMETRY = "nav_msgs/msg/Odometry"
TOPICS = ("/odom", "/odom_filtered")
RULES = "begin SetFrequency /odom Full SetFrequency /odom_filtered Full end"
LATCHED = Qos(reliable=True, transient_local=True, depth=1)


def drive() -> BagContent:
    messages = (
        BagMessage(topic, 10**18 + number * 50_000_000, odometry(float(number), 0.0))
        for number in range(40)
        for topic in TOPICS
    )
    return BagContent(tuple(BagTopic(topic, ODOMETRY) for topic in TOPICS), tuple(messages))


def replayed(folder: Path) -> Path:
    """With ``/testudo/decisions``."""
    return replay_content(drive(), RULES[6:-4], folder, storage=Storage.MCAP).output


def received(folder: Path) -> Path:
    """With ``/testudo/decisions`` and ``/testudo/status``, as ``testudo receive --record`` leaves it."""
    with open_recording(replayed(folder)) as recording:
        messages = [(channel, stamp_ns, payload) for channel, stamp_ns, payload in recording.messages()]
    clock = [0]
    sink = RecordingSink(folder / "drive", pytest.fail, lambda: clock[0])
    status = StreamInfo(topic=STATUS_TOPIC, type_name=TEXT_TYPE, qos=LATCHED)
    sink.open("ada", status)
    for number, (channel, stamp_ns, payload) in enumerate(messages):
        clock[0] = stamp_ns
        qos = Qos(reliable=True, transient_local=channel.transient_local)
        stream = StreamInfo(topic=channel.topic, type_name=channel.type_name, qos=qos)
        sink.open("ada", stream)
        for of, sent in ((stream, payload), (status, string_message('{"node": "/smarttestudo"}'))):
            if of is stream or number % 20 == 0:
                sink.write(ReceivedMessage(robot="ada", stream=of, payload=sent, offered_ns=1, age_ns=None))
    sink.close()
    return folder / "drive" / "ada"


@pytest.mark.contract
@on_every_data_path
@pytest.mark.parametrize("record", [replayed, received])
def test_all_topics_of_a_recording_that_is_played_beside_a_run_are_relayed(
    robot: SmallRobot, data_path: str, tmp_path: Path, record: Callable[[Path], Path]
) -> None:
    bag = record(tmp_path)
    with open_recording(bag) as recording:
        said = OWN_TOPICS & {channel.topic for channel in recording.channels}
    assert said
    topics: dict[str, Any] = {topic[1:]: {"type": ODOMETRY} for topic in TOPICS}
    operator = robot.operator(**topics)
    runtime = robot.runtime(RULES, "--data-path", data_path)
    runtime.line_with("Relaying 2 topics")
    robot.player(bag)
    operator.line_with("heard")
    runtime.signal(2)
    assert runtime.exit_code() == 0
    assert "SmartTestudo node" not in "".join(runtime.output)

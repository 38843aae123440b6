# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folders that a robot keeps of what its operator's end missed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from mcap.reader import make_reader

from bags.bag_factory import BagMessage
from bags.bag_reading import read_bag, read_with_rosbags
from loop.loop_driver import rule_set_of
from robot.memory_link import MemoryLink
from robot.status.virtual_robot import SECOND, VirtualRobot
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.domain.link import LinkState, MessageOrigin, MissedMessage
from smarttestudo.domain.robot import Qos
from smarttestudo.domain.status import RulesInForce
from smarttestudo.incidents.folder import complete_incidents
from smarttestudo.incidents.live_outages import FOLDER_NS, MAX_FOLDERS, LiveOutages, OutageFolder
from smarttestudo.loop.relay import Relayed
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.robot.source import LiveSource

QOS = Qos(reliable=True, transient_local=False, depth=5)
IMU = "sensor_msgs/msg/Imu"


class Robot(VirtualRobot):
    def definition(self, type_name: str) -> str:
        return "float64 x"


class Run:
    """A robot whose operator's end misses what the test says, at 4 looks a second."""

    def __init__(self, folder: Path) -> None:
        self.robot = Robot(sources={})
        self.link = MemoryLink()
        self.folder = folder
        self.outages = LiveOutages(self.robot, self.link, folder, Settings())
        rules = LiveRules(
            rule_set=rule_set_of("begin SetFrequency /imu 10 end"),
            output_topics={},
            in_force=RulesInForce(sha256="abc"),
        )
        self.outages.follow(rules, 0)
        for topic in ("/imu", "/count"):
            self.outages.on_source(topic, LiveSource(type_name=IMU, publishers=1, qos=QOS), 0)

    def miss(self, *numbers: int, topic: str = "/imu") -> None:
        """A message each, of so many seconds after the start."""
        self.link.missed += [
            MissedMessage(
                origin=MessageOrigin(topic=topic, stamp_ns=number * SECOND), payload=bytes([number])
            )
            for number in numbers
        ]

    def look(self, *, is_connected: bool) -> None:
        self.robot.elapsed_ns += SECOND // 4
        self.link.state = LinkState(is_connected=is_connected)
        self.outages.poll()

    def found(self) -> list[Path]:
        return sorted(self.folder.iterdir()) if self.folder.exists() else []


def types_of(folder: Path) -> set[tuple[str, int]]:
    """The type of each message with its payload, a byte."""
    found = set()
    for path in folder.glob("*.mcap"):
        with path.open("rb") as file:
            for schema, _, message in make_reader(file).iter_messages():
                assert schema is not None
                found.add((schema.name, message.data[0]))
    return found


@pytest.fixture
def run(tmp_path: Path) -> Run:
    return Run(tmp_path / "incidents")


def test_a_connection_that_is_mended_before_anything_was_missed_leaves_no_folder(run: Run) -> None:
    with run.outages.running():
        for _ in range(200):
            run.look(is_connected=False)
            run.look(is_connected=True)
    assert run.found() == []


def test_what_was_missed_is_in_the_folder_and_nothing_else_in_the_order_of_its_stamps(run: Run) -> None:
    with run.outages.running():
        run.miss(3, 4)
        run.look(is_connected=False)
        # A topic whose message gave way late.
        run.miss(2, topic="/count")
        run.look(is_connected=False)
        run.miss(5)
        run.look(is_connected=True)
        run.look(is_connected=True)
    (folder,) = run.found()
    expected = [
        BagMessage(topic, number * SECOND, bytes([number]))
        for topic, number in (("/count", 2), ("/imu", 3), ("/imu", 4), ("/imu", 5))
    ]
    assert read_bag(folder).messages == expected
    assert read_bag(folder).notices == []
    assert read_with_rosbags(folder) == expected
    record = json.loads((folder / "incident.json").read_text())
    assert (record["name"], record["rule"], record["rules_sha256"]) == ("outage", "(link)", "abc")
    assert (record["from_ns"], record["to_ns"]) == (2 * SECOND, 5 * SECOND)
    assert record["topics"]["/imu"]["messages"] == 3


def test_what_is_known_to_be_missed_only_once_the_link_is_back_is_in_the_same_folder(run: Run) -> None:
    with run.outages.running():
        run.miss(3)
        run.look(is_connected=False)
        run.link.is_settled = False
        for number in (4, 5):
            run.look(is_connected=True)
            run.miss(number)
        run.link.is_settled = True
        run.look(is_connected=True)
    (folder,) = run.found()
    assert [message.payload for message in read_bag(folder).messages] == [b"\x03", b"\x04", b"\x05"]


def test_what_was_missed_has_the_type_that_its_topic_had_then(run: Run) -> None:
    with run.outages.running():
        run.miss(3, 4)
        other = LiveSource(type_name="sensor_msgs/msg/LaserScan", publishers=1, qos=QOS)
        run.outages.on_source("/imu", other, 5 * SECOND)
        run.miss(5)
        run.look(is_connected=True)
    (folder,) = run.found()
    assert types_of(folder) == {(IMU, 3), (IMU, 4), ("sensor_msgs/msg/LaserScan", 5)}


def test_an_outage_of_a_killed_run_lasts_until_its_last_message(run: Run) -> None:
    channels = {"/imu": StoredChannel(topic="/imu", type_name=IMU, definition="float64 x")}
    outage = OutageFolder(run.folder, channels, 3 * SECOND, "abc")
    for number in (4, 3, 9, 8):
        outage.write(
            MissedMessage(origin=MessageOrigin(topic="/imu", stamp_ns=number * SECOND), payload=b"text")
        )
    (found,) = complete_incidents(run.folder)
    record = json.loads((run.folder / found.name / "incident.json").read_text())
    assert found.last_ns == 9 * SECOND
    assert (record["from_ns"], record["to_ns"], record["missing"]) == (3 * SECOND, 9 * SECOND, [])


def test_a_short_cut_in_which_something_was_missed_has_a_folder_of_that_alone(run: Run) -> None:
    with run.outages.running():
        run.miss(7)
        run.look(is_connected=True)
    (folder,) = run.found()
    assert [message.stamp_ns for message in read_bag(folder).messages] == [7 * SECOND]


def test_a_message_is_of_its_source_while_it_is_sent_and_a_repeated_one_of_none(run: Run) -> None:
    seen: list[MessageOrigin | None] = []
    for repeated in (False, True):
        relayed = Relayed("/imu", stamp_ns=1, payload=b"", size_bytes=0, repeated=repeated)
        run.outages.before_publish(relayed)
        seen.append(run.link.origin())
        run.outages.after_publish()
    assert seen == [MessageOrigin(topic="/imu", stamp_ns=run.robot.now_ns()), None]
    assert run.link.origin() is None


def test_an_outage_that_lasts_is_several_folders_and_then_said_to_be_kept_no_more(run: Run) -> None:
    with run.outages.running():
        for number in range(2 * MAX_FOLDERS):
            run.miss(number)
            run.look(is_connected=False)
            run.robot.elapsed_ns += FOLDER_NS
            run.look(is_connected=False)
        run.look(is_connected=True)
        assert sum("kept no more" in line for line in run.robot.log_lines) == 1
        run.miss(100)
        run.look(is_connected=False)
    assert len(run.found()) == MAX_FOLDERS + 1


def test_what_waits_at_the_end_of_the_run_is_missed_too(run: Run) -> None:
    with run.outages.running():
        run.look(is_connected=False)
        run.miss(9)
    (folder,) = run.found()
    assert [message.stamp_ns for message in read_bag(folder).messages] == [9 * SECOND]

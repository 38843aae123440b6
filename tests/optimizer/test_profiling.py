# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles measured in a recording."""

from __future__ import annotations

import statistics
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic, cdr, message_of, write_bag
from smarttestudo.bags.metadata_text import offered_qos
from smarttestudo.bags.qos import qos_profiles
from smarttestudo.bags.writer import create_recording
from smarttestudo.cli.main import main
from smarttestudo.domain.recording import Channel, Storage
from smarttestudo.domain.robot import Qos
from smarttestudo.optimizer.profiling import TopicMeasure, proposed_tiers_hz
from smarttestudo.rules.profile_file import load_profile

S = 1_000_000_000
SCAN = Channel(topic="/scan", type_name="sensor_msgs/msg/LaserScan")
MAP = Channel(topic="/map", type_name="nav_msgs/msg/OccupancyGrid")
IMAGE = Channel(topic="/image", type_name="sensor_msgs/msg/Image")
EMPTY = Channel(topic="/empty", type_name="std_msgs/msg/Empty")


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """Five scans a second of 2 and 4 KB, one map, an image every second that stands for 6 MB."""
    path = tmp_path / "bag"
    with create_recording(path, storage=Storage.MCAP, declared_bytes={"/image": 6_000_000}) as writer:
        writer.add(EMPTY)
        writer.write(MAP, S, bytes(1000))
        for number in range(11):
            writer.write(SCAN, S + number * S // 5, bytes(2000 if number % 2 else 4000))
            if number % 5 == 0:
                writer.write(IMAGE, S + number * S // 5, bytes(10))
    return path


def test_what_is_measured_reads_back_as_a_profile(bag: Path, tmp_path: Path) -> None:
    output = tmp_path / "profile.toml"
    assert main(["profile", "--bag", str(bag), "-o", str(output)]) == 0
    profile = load_profile(output)
    scan = profile.topic("/scan")
    assert scan.type_name == "sensor_msgs/msg/LaserScan"
    assert scan.message_kb == pytest.approx((6 * 4 + 5 * 2) / 11, abs=1e-6)
    assert scan.source_hz == 5
    assert scan.tiers_hz == (0.25, 0.5, 1.25, 2.5, 4, 5)
    assert profile.topic("/map").message_kb == 1
    assert (profile.topic("/map").source_hz, profile.topic("/map").tiers_hz) == (0.5, None)
    assert profile.topic("/image").message_kb == 6000
    assert profile.topic("/empty").message_kb is None


def test_of_a_topic_too_slow_for_tiers_and_of_empty_messages_the_profile_reads_back(tmp_path: Path) -> None:
    path = tmp_path / "slow"
    with create_recording(path, storage=Storage.MCAP) as writer:
        for number in range(3):
            writer.write(MAP, S + number * 100 * S, bytes(1000))
            writer.write(SCAN, S + number * S, b"")
    output = tmp_path / "profile.toml"
    assert main(["profile", "--bag", str(path), "-o", str(output)]) == 0
    profile = load_profile(output)
    assert profile.topic("/map").source_hz == 0.01
    assert profile.topic("/map").tiers_hz is None
    assert profile.topic("/scan").message_kb is None


@pytest.mark.parametrize("last_ns", [300 * 86_400 * S, 1_000_000_100])
def test_of_stamps_that_no_source_has_the_profile_reads_back_without_a_rate(
    tmp_path: Path, last_ns: int
) -> None:
    path = tmp_path / "jumped"
    with create_recording(path, storage=Storage.MCAP) as writer:
        writer.write(MAP, S, bytes(1000))
        writer.write(MAP, last_ns, bytes(1000))
    output = tmp_path / "profile.toml"
    assert main(["profile", "--bag", str(path), "-o", str(output)]) == 0
    entry = load_profile(output).topic("/map")
    assert (entry.message_kb, entry.source_hz, entry.tiers_hz) == (1, None, None)
    assert "did the clock jump?" in output.read_text()


def test_the_profile_of_a_recording_with_a_strange_name_reads_back(tmp_path: Path, bag: Path) -> None:
    strange, output = tmp_path / "two\nlines \x01", tmp_path / "profile.toml"
    bag.rename(strange)
    assert main(["profile", "--bag", str(strange), "-o", str(output)]) == 0
    assert load_profile(output).topic("/map").message_kb == 1
    assert output.read_text().startswith(r"# Measured by testudo profile in two\nlines \u0001: ")


def test_publishers_are_said_where_the_recording_lists_what_each_of_them_offered(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "two"
    (offered,) = qos_profiles(offered_qos(Qos(reliable=True, transient_local=False, depth=10)))
    with create_recording(path) as writer:
        writer.write(replace(SCAN, qos=(offered, offered)), S, bytes(1000))
        writer.write(replace(MAP, qos=(offered,)), S, bytes(1000))
        writer.write(IMAGE, S, bytes(1000))
    assert main(["profile", "--bag", str(path)]) == 0
    printed = capsys.readouterr().out
    (of_scan,) = (part for part in printed.split("\n\n") if part.startswith('[topics."/scan"]'))
    assert "# 2 publishers, measured together; live, each of them has the topic's rate\n" in of_scan
    assert printed.count("publishers") == 1


def test_of_a_topic_with_two_types_the_first_is_measured(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "two"
    with create_recording(path, storage=Storage.MCAP) as writer:
        for number in range(11):
            writer.write(SCAN, S + number * S // 5, bytes(2000))
            writer.write(replace(EMPTY, topic="/scan"), S + number * S // 5 + 1, bytes(10))
        writer.write(replace(EMPTY, topic="no name"), S, bytes(10))
    output = tmp_path / "profile.toml"
    assert main(["profile", "--bag", str(path), "-o", str(output)]) == 0
    scan = load_profile(output).topic("/scan")
    assert (scan.type_name, scan.message_kb, scan.source_hz) == (SCAN.type_name, 2.0, 5.0)
    assert capsys.readouterr().err.splitlines() == [
        "note: /scan: recorded with two types; left out of the second: all messages",
        "note: no name: no name of a ROS topic; left out",
    ]


def test_every_number_says_where_it_comes_from(bag: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["profile", "--bag", str(bag)]) == 0
    printed = capsys.readouterr().out
    assert "# Measured by testudo profile in bag: 2.0 s, 4 topics, " in printed
    assert "# mean of 11 messages, the largest 4.0\n" in printed
    assert "# mean of 3 messages, the largest 6000.0, declared by the recording\n" in printed
    assert (
        "# (n - 1) / (last - first); intervals of 200.0 ms, jitter (standard deviation) 0.0 ms\n" in printed
    )
    assert "# 5, 10, 25, 50, 80, 100 % of source_hz\n" in printed
    assert "source_hz = 0.5  # 1 message at one time: no levels, Full for optimize\n" in printed


def test_a_profile_that_exists_is_not_overwritten(
    bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "profile.toml"
    output.write_text("mine")
    assert main(["profile", "--bag", str(bag), "-o", str(output)]) == 1
    assert capsys.readouterr().err == f"{output}: error: the file exists already; give another name\n"
    assert output.read_text() == "mine"


def test_topics_may_be_named_by_several_options(bag: Path, tmp_path: Path) -> None:
    output = tmp_path / "profile.toml"
    named = ("--topics", "/map", "--topics", "/scan")
    assert main(["profile", "--bag", str(bag), *named, "-o", str(output)]) == 0
    assert set(load_profile(output).topics) == {"/map", "/scan"}


@given(intervals_ns=st.lists(st.integers(1, 10 * S), min_size=2, max_size=30))
def test_jitter_is_the_standard_deviation_of_the_intervals(intervals_ns: list[int]) -> None:
    measure, stamp_ns = TopicMeasure("type"), 5
    measure.record(stamp_ns, 100)
    for interval_ns in intervals_ns:
        stamp_ns += interval_ns
        measure.record(stamp_ns, 100)
    assert measure.jitter_s == pytest.approx(statistics.pstdev(intervals_ns) / S, rel=1e-6, abs=1e-9)
    assert measure.source_hz == pytest.approx(len(intervals_ns) * S / sum(intervals_ns))


@given(source_hz=st.floats(1e-3, 1e5))
def test_proposed_tiers_never_fall(source_hz: float) -> None:
    tiers = proposed_tiers_hz(source_hz)
    assert list(tiers) == sorted(tiers)


def test_a_profile_counts_the_streams_and_the_optimizer_what_they_all_take(
    tmp_path: Path,
) -> None:
    """Ten parts at 10 Hz each and 0.1 KB: at a level of 2 Hz they take ten times what one would."""
    type_name = "diagnostic_msgs/msg/DiagnosticArray"
    status = "diagnostic_msgs/msg/DiagnosticStatus"
    messages = [
        BagMessage(
            "/parts",
            START_NS + number * S // 100,
            cdr(type_name, message_of(type_name, status=[message_of(status, name=f"part {number % 10}")])),
        )
        for number in range(1000)
    ]
    bag = write_bag(tmp_path / "bag", BagContent((BagTopic("/parts", type_name),), tuple(messages)))
    output = tmp_path / "profile.toml"
    assert main(["profile", "--bag", str(bag), "-o", str(output)]) == 0
    entry = load_profile(output).topic("/parts")
    assert (entry.streams, entry.tiers_hz) == (10, tuple(proposed_tiers_hz(10)))
    assert entry.source_hz == pytest.approx(100, rel=0.01)
    rules = tmp_path / "rules.adirf"
    rules.write_text("begin SetFrequency /parts 2 end")
    needed_kb = 2 * 10 * (entry.message_kb or 0)
    for budget_kb, exit_code in ((needed_kb * 1.01, 0), (needed_kb * 0.99, 1)):
        profile = tmp_path / "with_budget.toml"
        profile.write_text(f"budget_kb_per_s = {budget_kb}\n{output.read_text()}")
        assert main(["optimize", str(rules), "--profile", str(profile)]) == exit_code

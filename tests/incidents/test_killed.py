# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a run leaves that is killed while it records, and what the next one makes of it."""

from __future__ import annotations

import struct
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.bag_factory import BagMessage
from bags.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from incidents.folder_runs import MS, FolderRun, record_of
from incidents.incident_runs import recording_rules
from smarttestudo.bags.mcap.record_bytes import StoredChannel, file_start
from smarttestudo.bags.mcap.writer import McapWriter, complete_file, complete_files
from smarttestudo.domain.errors import RecordingError
from smarttestudo.incidents.folder import complete_incidents

LOST_NS = 500_000_000
CHANNEL = StoredChannel(topic="/odom", type_name="std_msgs/msg/String", definition="string data\n")
# Long as those of sensor messages, and with a letter that takes two bytes.
OTHER = StoredChannel(topic="/scan", type_name="sensor_msgs/msg/LaserScan", definition=700 * "\u00b0")
CHANNELS = (CHANNEL, OTHER, replace(CHANNEL, qos_text="changed"))
STAMP_NS = 1_700_000_000_000_000_000
SECTOR_BYTES = 512


def messages_in(bag: Path) -> list[BagMessage]:
    """What can be read of a folder that was not ended; an incident that just began has no file yet."""
    has_file = any(file.stat().st_size >= len(file_start()) for file in bag.glob("*.mcap"))
    return read_bag(bag).messages if has_file else []


def numbers(messages: Sequence[BagMessage]) -> list[int]:
    return [struct.unpack_from("<Q", message.payload)[0] for message in messages]


def completed_as_left(
    folder: Path, left: Mapping[str, Sequence[BagMessage]], began_ns: int
) -> dict[str, list[int]]:
    """Complete the incidents that were left with these messages; the numbers of those that have any.

    One without any began after ``began_ns``.
    """
    completed = {one.name: one for one in complete_incidents(folder)}
    assert set(completed) == set(left)
    for name, messages in left.items():
        found = numbers(messages)
        record = record_of(folder / name)
        assert completed[name].error is None
        assert record["topics"].get("/odom", {"messages": 0})["messages"] == len(found)
        if not found:
            # It was killed as the incident began.
            assert record["triggered_ns"] > began_ns
            continue
        assert found == list(range(found[0], found[-1] + 1))
        assert read_bag(folder / name).messages == messages
        assert read_bag(folder / name).notices == []
        assert read_with_rosbags(folder / name) == messages
        with_mcap = [message for file in (folder / name).glob("*.mcap") for message in read_with_mcap(file)]
        assert sorted(numbers(with_mcap)) == found
        assert {one["reason"] for one in record["missing"]} <= {"killed", "late"}
    assert list(complete_incidents(folder)) == []
    return {name: numbers(messages) for name, messages in left.items() if messages}


def record_until_killed(folder: Path, messages: int) -> FolderRun:
    """What lies on the disk after so many messages, 100 a second: two incidents, a moment every 300 ms."""
    rules = recording_rules(*(f'Record "{name}" /odom Before 500 ms After 700 ms' for name in ("one", "two")))
    run = FolderRun(rules, folder, topics=("/odom",))
    for number in range(messages):
        if number % 30 == 29:
            run.trigger()
        run.message("/odom", 1000)
        run.wait(10)
    return run


@settings(max_examples=15)
@given(st.integers(31, 130))
def test_whenever_a_run_is_killed_all_that_it_wrote_is_completed(count: int) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name, "incidents")
        run = record_until_killed(folder, count)
        left = {path.name[1:-8]: messages_in(path) for path in folder.glob(".*.partial")}
        assert left
        found = completed_as_left(folder, left, run.clock_ms * MS - LOST_NS)
        assert all(of_one[-1] == count - 1 for of_one in found.values())


def test_a_killed_run_leaves_the_moments_until_half_a_second_before(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "one" /odom Before 1 s After 10 s'), tmp_path, topics=("/odom",))
    for number in range(40):
        if number % 10 == 0:
            run.trigger()
        run.message("/odom")
        run.wait(100)
    (one,) = complete_incidents(tmp_path)
    record = record_of(tmp_path / one.name)
    assert (record["moments"], len(record["further_moments"])) == (4, 3)
    assert record["to_ns"] == record["further_moments"][-1]["triggered_ns"] + 10_000 * MS
    assert [missing["to_ns"] for missing in record["missing"] if missing["reason"] == "killed"] == [
        record["to_ns"]
    ]


def test_a_file_that_is_cut_anywhere_is_completed_as_far_as_it_goes(tmp_path: Path) -> None:
    path = tmp_path / "whole.mcap"
    writer = McapWriter(path)
    ends = []
    for number in range(8):
        writer.write(CHANNEL, number, struct.pack("<Q", number))
        ends.append(path.stat().st_size)
    unended = path.read_bytes()
    writer.close()
    whole = path.read_bytes()
    channel_end = ends[0] - (ends[1] - ends[0])
    cut = tmp_path / "cut.mcap"
    for size in range(len(file_start()), len(unended) + 1):
        cut.write_bytes(unended[:size])
        content = complete_file(cut)
        expected = sum(end <= size for end in ends)
        topics = [channel.topic for channel in content.channels]
        assert (content.message_count, topics) == (expected, ["/odom"] * (size >= channel_end))
        assert numbers(read_with_mcap(cut)) == list(range(expected))
        assert (cut.read_bytes() == whole) == (expected == len(ends))


@given(
    st.lists(st.tuples(st.sampled_from(CHANNELS), st.integers(1, 300_000)), min_size=2, max_size=20),
    st.data(),
)
def test_a_file_whose_end_never_reached_the_disk_holds_no_message_that_nobody_sent(
    messages: list[tuple[StoredChannel, int]], data: st.DataObject
) -> None:
    with tempfile.TemporaryDirectory() as name:
        path = Path(name, "one_0.mcap")
        writer = McapWriter(path)
        sent, ends = [], []
        for number, (channel, size) in enumerate(messages):
            sent.append(bytes([1 + number]) * size)
            writer.write(channel, STAMP_NS + number, sent[-1])
            ends.append(path.stat().st_size)
        writer.abandon()
        raw = path.read_bytes()
        # What a file ends with may be zeros that were sent.
        sectors = (ends[-1] - messages[-1][1]) // SECTOR_BYTES
        reached = SECTOR_BYTES * data.draw(st.integers(0, sectors))
        path.write_bytes(raw[:reached] + bytes(len(raw) - reached))
        files = complete_files(path.parent)
        assert path.exists() == (reached > 0)
        if reached:
            expected = sent[: sum(end <= reached for end in ends)]
            assert [message.payload for message in read_with_mcap(path)] == expected
            assert files[path.name].message_count == len(expected)
            found = {channel.topic for channel in files[path.name].channels}
            assert found <= {channel.topic for channel, _ in messages}


def test_zeros_with_which_the_last_message_of_a_killed_run_ends_are_its_own(tmp_path: Path) -> None:
    path = tmp_path / "one_0.mcap"
    writer = McapWriter(path)
    writer.write(CHANNEL, STAMP_NS, bytes(2000))
    writer.abandon()
    complete_file(path)
    assert [message.payload for message in read_with_mcap(path)] == [bytes(2000)]


@pytest.mark.parametrize("at", range(0, 60, 7))
def test_a_file_with_something_else_in_it_is_completed_or_named(tmp_path: Path, at: int) -> None:
    path = tmp_path / "one_0.mcap"
    writer = McapWriter(path)
    for number in range(20):
        writer.write(CHANNEL, STAMP_NS + number, b"text")
    writer.abandon()
    raw = bytearray(path.read_bytes())
    raw[300 + at : 310 + at] = b"\xff" * 10
    path.write_bytes(raw)
    try:
        content = complete_file(path)
    except RecordingError:
        assert path.read_bytes() == raw
    else:
        assert content.message_count == len(read_with_mcap(path))


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\n"[:5], b"SQLite format 3\0", bytes(100)])
def test_a_file_of_another_kind_is_named_and_left_alone(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "other.mcap"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match="damaged"):
        complete_file(path)
    assert path.read_bytes() == content


def test_a_folder_that_cannot_be_completed_costs_only_itself(tmp_path: Path) -> None:
    record_until_killed(tmp_path / "incidents", 80)
    (broken, *others) = sorted((tmp_path / "incidents").glob(".*.partial"))
    (broken / "incident.json").write_text("{")
    said = {one.name: str(one) for one in complete_incidents(tmp_path / "incidents")}
    assert len(said) == 1 + len(others)
    assert "cannot be completed" in said[broken.name[1:-8]]
    assert broken.exists()
    assert all("completed with" in said[path.name[1:-8]] for path in others)


@pytest.mark.parametrize("written_bytes", [0, 5, len(file_start()) - 1])
def test_a_file_with_less_than_a_beginning_costs_nothing(tmp_path: Path, written_bytes: int) -> None:
    record_until_killed(tmp_path / "incidents", 80)
    (partial, *_) = sorted((tmp_path / "incidents").glob(".*.partial"))
    name, before = partial.name[1:-8], read_bag(partial).messages
    (partial / f"{name}_9.mcap").write_bytes(file_start()[:written_bytes])
    assert all(one.error is None for one in complete_incidents(tmp_path / "incidents"))
    assert read_bag(tmp_path / "incidents" / name).messages == before
    assert not (tmp_path / "incidents" / name / f"{name}_9.mcap").exists()


def test_links_are_not_followed(tmp_path: Path) -> None:
    folder = tmp_path / "incidents"
    record_until_killed(folder, 50)
    secret = tmp_path / "secret.mcap"
    secret.write_bytes(b"secret")
    partial = next(iter(folder.glob(".*.partial")))
    (partial / "linked.mcap").symlink_to(secret)
    (folder / ".elsewhere.partial").symlink_to(tmp_path)
    assert all(one.error is None for one in complete_incidents(folder))
    assert secret.read_bytes() == b"secret"
    assert (folder / ".elsewhere.partial").is_symlink()

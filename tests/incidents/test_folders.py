# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents on disk: whole, each message once, what is missing named, and what they share stored once."""

from __future__ import annotations

import errno
import gc
import os
import resource
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from incidents.folder_runs import (
    LATCHED,
    MS,
    START_MS,
    FolderRun,
    channel,
    disk_bytes,
    payloads,
    record_of,
)
from incidents.incident_runs import AMPLE_BYTES, recording_rules
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.incidents.background import BackgroundSink
from smarttestudo.incidents.folder_lock import FolderLock
from smarttestudo.incidents.recorder import IncidentRecorder
from smarttestudo.incidents.recovery import complete_incidents
from smarttestudo.incidents.segments import Segment

LONGEST_PART = 10
"""A part of a window that incidents share is at most a tenth of it, or a second."""


def random_run(seed: int, folder: Path, ring_bytes: int | None) -> FolderRun:
    """A minute of a robot that triggers at random, with little or ample memory, and a clock that may jump."""
    random = Random(seed)
    records = [
        f'Record "one" /odom /scan Before {random.randint(0, 6000)} ms After {random.randint(0, 4000)} ms'
    ]
    if random.random() < 0.5:
        records.append(f'Record "two" /scan Before {random.randint(0, 3000)} ms After 1 s')
    memory_bytes = random.choice([3000, 20_000, 10_000_000])
    run = FolderRun(recording_rules(*records), folder, memory_bytes=memory_bytes, ring_bytes=ring_bytes)
    jumps = random.random() < 0.3
    for _ in range(random.randint(20, 100)):
        run.wait(random.choice([0, 1, 10, 40, 200]))
        if jumps and random.random() < 0.02:
            run.wait(random.choice([-5000, 5000]))
        kind = random.random()
        if kind < 0.06:
            run.trigger()
        else:
            topic = LATCHED if kind < 0.1 else random.choice(["/odom", "/scan"])
            run.message(topic, random.choice([8, 20, 300]))
    run.finish()
    return run


@settings(max_examples=150)
@given(st.integers(0, 2**32), st.sampled_from((None, None, AMPLE_BYTES, 2000)))
def test_every_message_of_a_window_is_there_once_or_named_as_missing(
    seed: int, ring_bytes: int | None
) -> None:
    with tempfile.TemporaryDirectory() as name:
        expect_windows(random_run(seed, Path(name, "incidents"), ring_bytes), ring_bytes)


def expect_windows(run: FolderRun, ring_bytes: int | None) -> None:
    stamps = {payload: (clock_ms, steady_ms, topic) for clock_ms, steady_ms, topic, payload in run.came}
    found = sorted(run.folder.iterdir())
    recordings = run.rule_set.blocks[0].recordings
    assert len(found) == len(run.begun_ms) * len(recordings) - run.recorder.refused
    steady_by_clock = dict(run.begun_ms)
    for path in found:
        record, held = record_of(path), payloads(path)
        assert set(held.values()) <= {1}
        recording = next(one for one in recordings if one.name == record["name"])
        begun_ms = steady_by_clock[record["triggered_ns"] // 1_000_000]
        if list(steady_by_clock).count(record["triggered_ns"] // 1_000_000) > 1:
            continue
        from_ms = begun_ms - recording.before_ns // 1_000_000
        to_ms = begun_ms + recording.after_ns // 1_000_000
        missing = {one["topic"]: one["messages"] for one in record["missing"] if one["reason"] == "memory"}
        for topic in (*recording.topics, LATCHED):
            window = {
                payload
                for payload, (_, steady_ms, name) in stamps.items()
                if name == topic and from_ms <= steady_ms <= to_ms
            }
            if topic == LATCHED:
                earlier = [one for one, came in stamps.items() if came[2] == LATCHED and came[1] < from_ms]
                window |= set(earlier[-1:])
            lacking = window - set(held)
            assert len(lacking) == missing.get(topic, 0)
            assert ring_bytes != AMPLE_BYTES or not lacking
        part_ms = max(1000, (to_ms - from_ms) // LONGEST_PART)
        assert all(
            steady_ms >= from_ms - part_ms
            for payload, (_, steady_ms, name) in stamps.items()
            if payload in held and name != LATCHED
        )


def burst(folder: Path, *, before_s: int = 30, after_s: int = 10) -> FolderRun:
    """A robot of 1.3 MB/s, 50 incidents in 10 s."""
    rules = recording_rules(f'Record "burst" /odom /scan Before {before_s} s After {after_s} s')
    run = FolderRun(rules, folder, memory_bytes=100_000_000)
    run.message(LATCHED, 160_000)
    for tick in range(20 * (before_s + after_s + 11)):
        run.wait(50)
        run.message("/odom", 700)
        run.message("/scan", 64_000)
        if 0 <= tick - 20 * before_s < 200 and tick % 4 == 0:
            run.trigger()
    return run


@pytest.mark.parametrize("after_s", [10, 0])
def test_50_incidents_in_10_s_take_little_more_than_what_they_share(tmp_path: Path, after_s: int) -> None:
    run = burst(tmp_path / "incidents", after_s=after_s)
    folders = run.finish()
    assert len(folders) == 50
    # The first and the last window overlap, so that what they hold is what all of them do.
    shared = {payload for folder in (folders[0], folders[-1]) for payload in payloads(folder)}
    assert disk_bytes(tmp_path / "incidents") <= 1.2 * sum(map(len, shared))


def test_one_of_many_is_read_alike_by_all(tmp_path: Path) -> None:
    folders = burst(tmp_path / "incidents", before_s=3, after_s=2).finish()
    for path in (folders[0], folders[17], folders[-1]):
        messages = read_bag(path).messages
        assert read_with_rosbags(path) == messages
        with_mcap = [message for file in path.glob("*.mcap") for message in read_with_mcap(file)]
        assert sorted(with_mcap, key=lambda one: one.stamp_ns) == messages


def test_what_another_incident_shared_stays_when_that_is_deleted(tmp_path: Path) -> None:
    folders = burst(tmp_path / "incidents", before_s=3, after_s=2).finish()
    expected = payloads(folders[1])
    for path in folders[0].iterdir():
        path.unlink()
    assert payloads(folders[1]) == expected


def test_a_chain_of_incidents_that_overlap_keeps_no_more_in_memory_than_a_few(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "a" /odom Before 3 s After 0 s'), tmp_path / "incidents")
    kept = []
    # What was there before is of no interest, and takes long to look through.
    gc.collect()
    gc.freeze()
    for _ in range(40):
        for _ in range(20):
            run.wait(50)
            run.message("/odom")
        run.trigger()
        gc.collect()
        kept.append(sum(isinstance(one, Segment) for one in gc.get_objects()))
    gc.unfreeze()
    assert len(run.finish()) == 40
    assert max(kept) == max(kept[:10])


@pytest.mark.full
def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    first, second = (
        {
            str(file.relative_to(root)): file.read_bytes()
            for root in [tmp_path / name]
            for folder in burst(root, before_s=3, after_s=2).finish()
            for file in folder.iterdir()
        }
        for name in ("one", "two")
    )
    assert first == second


def test_a_topic_without_messages_or_definition_is_listed(tmp_path: Path) -> None:
    assert channel("/odom", definition="") != channel("/odom")
    run = FolderRun(recording_rules('Record "silent" /odom Before 1 s After 1 s'), tmp_path / "incidents")
    run.trigger()
    (path,) = run.finish()
    assert read_bag(path).messages == []
    assert set(record_of(path)["topics"]) == {"/odom"}


@contextmanager
def files_of_at_most(size_bytes: int) -> Iterator[None]:
    """The system refuses to let a file grow further."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_what_cannot_be_written_ends_its_incidents_which_are_named_and_no_others(tmp_path: Path) -> None:
    failed: list[str] = []
    run = FolderRun(
        recording_rules('Record "one" /odom Before 1 s After 1 s', 'Record "two" /scan Before 1 s After 1 s'),
        tmp_path / "incidents",
        failed=lambda name, error: failed.append(f"{name} {error}"),
    )
    run.trigger()
    with files_of_at_most(100_000):
        for _ in range(20):
            run.wait(20)
            run.message("/odom", 10_000)
            run.message("/scan", 100)
    assert [line.partition(" ")[0] for line in failed] == ["19700101T001640000Z-one"]
    assert "File too large" in failed[0]
    run.wait(5000)
    run.trigger()
    run.message("/odom")
    run.finish()
    sent = [payload for _, _, topic, payload in run.came if topic == "/odom"]
    assert list(complete_incidents(tmp_path / "incidents")) == []
    assert len(list((tmp_path / "incidents").iterdir())) == 4
    path = tmp_path / "incidents" / "19700101T001640000Z-one"
    found = payloads(path)
    (lost,) = (one for one in record_of(path)["missing"] if one["reason"] != "late")
    assert list(found) == sent[: len(found)]
    assert len(found) >= 8
    assert (lost["topic"], lost["reason"], lost["messages"]) == ("/odom", "disk", 20 - len(found))
    assert (lost["from_ns"], lost["to_ns"]) == (
        (START_MS + 20 * (len(found) + 1)) * MS,
        (START_MS + 400) * MS,
    )
    for name, expected in (("one", [sent[-1]]), ("two", [])):
        assert list(payloads(tmp_path / "incidents" / f"19700101T001645400Z-{name}")) == expected


FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize(
    "refused", ["pathlib.Path.mkdir", "tempfile.mkstemp", "os.open", "os.writev", "os.link"]
)
def test_a_disk_that_is_full_as_an_incident_begins_is_said_once_and_what_is_lost_is_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: str
) -> None:
    failed: list[str] = []
    run = FolderRun(
        recording_rules('Record "one" /odom /scan Before 1 s After 1 s'),
        tmp_path / "incidents",
        failed=lambda name, error: failed.append(f"{name} {error}"),
    )

    def full(*_: object, **__: object) -> None:
        raise FULL

    def fill() -> None:
        for _ in range(50):
            run.wait(10)
            run.message("/odom")
            run.message("/scan")

    run.message(LATCHED)
    run.wait(1500)
    fill()
    with monkeypatch.context() as patched:
        patched.setattr(refused, full)
        run.trigger()
        run.trigger()
        fill()
    fill()
    run.wait(5000)
    run.trigger()
    run.message("/odom")
    paths = run.finish()
    assert len(paths) == 3
    in_window = [payload for _, _, _, payload in run.came[:-1]]
    assert list(payloads(paths[2])) == [in_window[0], run.came[-1][3]]
    names = [path.name for path in paths[:2]]
    assert [line.partition(" ")[0] for line in failed] == names
    assert all(
        line.endswith("No space left on device; free some space or write to another disk") for line in failed
    )
    for path in paths[:2]:
        missing = {one["topic"]: one for one in record_of(path)["missing"]}
        assert {one["reason"] for one in missing.values()} == {"disk"}
        lost = sum(one["messages"] for one in missing.values())
        held = payloads(path)
        assert set(held) <= set(in_window)
        assert set(held.values()) <= {1}
        assert len(held) + lost == len(in_window)
        assert lost >= 100


def test_a_disk_that_is_too_slow_costs_messages_that_are_counted(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "one" /odom Before 1 s After 1 s'), tmp_path / "incidents")
    failed: list[str] = []
    sink = BackgroundSink(run.folders, 2000, failed=lambda name, _: failed.append(name))
    run.recorder = IncidentRecorder(run.rule_set, sink, 100_000, START_MS * MS)
    run.recorder.hear("/odom", START_MS * MS, transient_local=False)
    run.trigger()
    # The thread that writes begins only now.
    for _ in range(10):
        run.wait(10)
        run.message("/odom", 600)
    with sink.running():
        run.recorder.finish(run.clock_ms * MS + 2_000_000_000)
    assert failed == []
    (path,) = (tmp_path / "incidents").iterdir()
    held = payloads(path)
    lost = next(one for one in record_of(path)["missing"] if one["reason"] == "disk")
    assert len(held) + lost["messages"] == 10
    assert (lost["from_ns"], lost["to_ns"]) == (
        (START_MS + 10 * (len(held) + 1)) * MS,
        (START_MS + 100) * MS,
    )


def test_one_run_at_a_time_records_into_a_folder(tmp_path: Path) -> None:
    first = FolderLock(tmp_path / "incidents", "--incidents")
    with pytest.raises(OutputFileError, match="another run records here") as raised:
        FolderLock(tmp_path / "incidents", "--incidents")
    assert raised.value.remedy == "name another folder with --incidents"
    first.release()
    FolderLock(tmp_path / "incidents", "--incidents").release()


@pytest.mark.parametrize("name", ["../../up", "/etc/passwd", "a/b", "x" * 10_000, "Größe ✗", "…"])
def test_no_name_leads_out_of_the_folder(tmp_path: Path, name: str) -> None:
    run = FolderRun(recording_rules(f'Record "{name}" /odom Before 1 s After 1 s'), tmp_path / "incidents")
    run.trigger()
    run.message("/odom")
    run.trigger()
    folders = run.finish()
    assert len(folders) == 2
    assert all(len(path.name) <= 82 and path.is_dir() for path in folders)
    assert {record_of(path)["name"] for path in folders} == {name}
    assert list(tmp_path.iterdir()) == [tmp_path / "incidents"]
    assert all(len(payloads(path)) == 1 for path in folders)


@pytest.mark.full
def test_without_hard_links_each_incident_has_its_own_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr("os.link", refused)
    run = burst(tmp_path / "incidents", before_s=2, after_s=1)
    folders = run.finish()
    assert len(folders) == 50
    monkeypatch.undo()
    whole = burst(tmp_path / "linked", before_s=2, after_s=1).finish()
    for one, other in zip(folders, whole, strict=True):
        assert set(payloads(one)) <= set(payloads(other))
        assert record_of(one)["missing"] == record_of(other)["missing"]

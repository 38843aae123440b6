# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents on disk: whole, each message once, with all moments of a rule, and what is missing named."""

from __future__ import annotations

import errno
import math
import os
import resource
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from incidents.folder_runs import LATCHED, MS, START_MS, FolderRun, channel, disk_bytes, payloads, record_of
from incidents.incident_runs import AMPLE_BYTES, recording_rules, trigger, windows
from smarttestudo.bags.incident_record import read_record, signal_texts
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.incidents.background import BackgroundSink
from smarttestudo.incidents.folder import complete_incidents
from smarttestudo.incidents.live_incidents import FolderLock
from smarttestudo.incidents.recorder import IncidentRecorder


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
    steady_by_clock = dict(run.begun_ms)
    expected = {
        one.name: windows(
            [steady_ms for _, steady_ms in run.begun_ms], one.before_ns // MS, one.after_ns // MS
        )
        for one in recordings
    }
    assert len(found) == sum(map(len, expected.values()))
    for path in found:
        record, held = record_of(path), payloads(path)
        assert set(held.values()) <= {1}
        recording = next(one for one in recordings if one.name == record["name"])
        begun_ms = steady_by_clock[record["triggered_ns"] // MS]
        if [clock_ms for clock_ms, _ in run.begun_ms].count(record["triggered_ns"] // MS) > 1:
            continue
        moments_ms = next(one for one in expected[recording.name] if one[0] == begun_ms)
        assert record.get("moments", 1) == len(moments_ms)
        assert len(record.get("further_moments", ())) == len(moments_ms) - 1
        from_ms = begun_ms - recording.before_ns // MS
        to_ms = moments_ms[-1] + recording.after_ns // MS
        missing = Counter[str]()
        for one in record["missing"]:
            if one["reason"] == "memory":
                missing[one["topic"]] += one["messages"]
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
            assert len(lacking) == missing[topic]
            assert ring_bytes != AMPLE_BYTES or not lacking
        assert all(
            from_ms <= steady_ms <= to_ms
            for payload, (_, steady_ms, name) in stamps.items()
            if payload in held and name != LATCHED
        )


def burst(folder: Path, *, before_s: float = 30, after_s: float = 10) -> FolderRun:
    """A robot of 1.3 MB/s whose rule begins to hold 50 times in 10 s."""
    rules = recording_rules(f'Record "burst" /odom /scan Before {before_s} s After {after_s} s')
    run = FolderRun(rules, folder, memory_bytes=100_000_000)
    run.message(LATCHED, 160_000)
    for tick in range(round(20 * (before_s + after_s + 11))):
        run.wait(50)
        run.message("/odom", 700)
        run.message("/scan", 64_000)
        if 0 <= tick - 20 * before_s < 200 and tick % 4 == 0:
            run.trigger()
    return run


@pytest.mark.parametrize(
    ("before_s", "after_s", "incidents"), [(30, 10, 1), (30, 0, 1), (3, 2, 1), (1, 0, 2), (0.5, 0.5, 2)]
)
def test_50_beginnings_in_10_s_take_little_more_than_the_messages_of_their_windows(
    tmp_path: Path, before_s: float, after_s: float, incidents: int
) -> None:
    folders = burst(tmp_path / "incidents", before_s=before_s, after_s=after_s).finish()
    assert len(folders) == incidents
    assert sum(record_of(path)["moments"] for path in folders) == 50
    in_any = {payload for path in folders for payload in payloads(path)}
    assert disk_bytes(tmp_path / "incidents") <= 1.2 * sum(map(len, in_any))


def test_each_moment_of_an_incident_is_in_its_record_with_its_values(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "one" /odom Before 1 s After 1 s'), tmp_path / "incidents")
    for x in (1.5, math.inf, 2.5):
        run.recorder.begin(trigger(run.rule_set, run.clock_ms * MS, values={"/odom speed": x}))
        run.wait(100)
    (path,) = run.finish()
    record = record_of(path)
    assert (record["triggered_ns"], record["values"]) == (START_MS * MS, {"/odom speed": 1.5})
    assert (record["moments"], record["to_ns"]) == (3, (START_MS + 1200) * MS)
    assert record["further_moments"] == [
        {
            "time": "1970-01-01 00:16:40.100 UTC",
            "triggered_ns": (START_MS + 100) * MS,
            "values": {"/odom speed": None},
            "infinite": {"/odom speed": "inf"},
        },
        {
            "time": "1970-01-01 00:16:40.200 UTC",
            "triggered_ns": (START_MS + 200) * MS,
            "values": {"/odom speed": 2.5},
        },
    ]
    assert [one.values for one in read_record(path).further_moments] == [
        {"/odom speed": math.inf},
        {"/odom speed": 2.5},
    ]


def test_a_text_that_the_rule_read_stands_in_the_record_and_long_ones_leave_it_small(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "one" /odom Before 10 s After 1 s'), tmp_path / "incidents")
    for text in ("docking", *("\x1b[2J" * 250 + "…" for _ in range(500))):
        run.recorder.begin(trigger(run.rule_set, run.clock_ms * MS, values={"/mode data": text}))
        run.wait(10)
    (path,) = run.finish()
    record = read_record(path)
    assert [*signal_texts(record.values)] == ['/mode data = "docking"']
    assert (record.moments, len(record.further_moments)) == (501, 156)
    assert (path / "incident.json").stat().st_size < 2_000_000


def test_a_record_of_one_moment_is_what_earlier_versions_wrote(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "one" /odom Before 1 s After 1 s'), tmp_path / "incidents")
    run.trigger()
    (path,) = run.finish()
    assert not {"moments", "further_moments"} & record_of(path).keys()
    assert read_record(path).moments == 1


def test_a_record_of_very_many_moments_counts_what_it_does_not_list(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "one" /odom Before 10 s After 1 s'), tmp_path / "incidents")
    values = {f"/odom {number}": 1.0 for number in range(4)}
    for _ in range(1500):
        run.recorder.begin(trigger(run.rule_set, run.clock_ms * MS, values=values))
        run.wait(10)
    (path,) = run.finish()
    record = read_record(path)
    assert (record.moments, len(record.further_moments)) == (1500, 999)


def test_an_incident_of_many_moments_is_read_alike_by_all(tmp_path: Path) -> None:
    (path,) = burst(tmp_path / "incidents", before_s=3, after_s=2).finish()
    messages = read_bag(path).messages
    assert read_with_rosbags(path) == messages
    with_mcap = [message for file in path.glob("*.mcap") for message in read_with_mcap(file)]
    assert sorted(with_mcap, key=lambda one: one.stamp_ns) == messages


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


def test_a_latched_message_that_memory_gave_up_stands_at_the_start_of_the_window(tmp_path: Path) -> None:
    rules = recording_rules('Record "one" /odom Before 5 s After 1 s')
    run = FolderRun(rules, tmp_path / "incidents", memory_bytes=3000, ring_bytes=AMPLE_BYTES)
    run.message(LATCHED, 2000)
    run.wait(3000)
    run.message(LATCHED, 2000)
    run.wait(2500)
    run.message("/odom", 500)
    run.wait(500)
    run.trigger()
    (path,) = run.finish()
    record, messages = record_of(path), read_bag(path).messages
    assert record["missing"] == [one for one in record["missing"] if one["reason"] == "ended"]
    assert record["latched"] == [{"topic": LATCHED, "stamp_ns": START_MS * MS}]
    assert [(one.topic, one.stamp_ns - record["from_ns"]) for one in messages] == [
        (LATCHED, 0),
        (LATCHED, 2000 * MS),
        ("/odom", 4500 * MS),
    ]


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


@pytest.mark.parametrize("refused", ["pathlib.Path.mkdir", "tempfile.mkstemp", "os.open", "os.writev"])
def test_a_disk_that_is_full_as_an_incident_begins_is_said_once_and_what_is_lost_is_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: str
) -> None:
    failed: list[str] = []
    run = FolderRun(
        recording_rules(*(f'Record "{name}" /odom /scan Before 1 s After 1 s' for name in ("one", "two"))),
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
        fill()
    fill()
    run.wait(5000)
    run.trigger()
    run.message("/odom")
    paths = run.finish()
    assert len(paths) == 4
    in_window = [payload for _, _, _, payload in run.came[:-1]]
    for path in paths[2:]:
        assert list(payloads(path)) == [in_window[0], run.came[-1][3]]
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
    run.recorder.on_subscribed("/odom", START_MS * MS, transient_local=False)
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
    assert (lost["from_ns"], lost["to_ns"]) == ((START_MS + 10 * (len(held) + 1)) * MS, (START_MS + 100) * MS)


def test_one_run_at_a_time_records_into_a_folder(tmp_path: Path) -> None:
    first = FolderLock(tmp_path / "incidents", "--incidents")
    with pytest.raises(OutputFileError, match="another run records here") as raised:
        FolderLock(tmp_path / "incidents", "--incidents")
    assert raised.value.remedy == "name another folder with --incidents"
    first.release()
    FolderLock(tmp_path / "incidents", "--incidents").release()


@pytest.mark.parametrize("name", ["../../up", "/etc/passwd", "a/b", "x" * 10_000, "Größe ✗", "…"])
def test_no_name_leads_out_of_the_folder(tmp_path: Path, name: str) -> None:
    records = 2 * [f'Record "{name}" /odom Before 1 s After 1 s']
    run = FolderRun(recording_rules(*records), tmp_path / "incidents")
    run.trigger()
    run.message("/odom")
    folders = run.finish()
    assert len(folders) == 2
    assert all(len(path.name) <= 82 and path.is_dir() for path in folders)
    assert {record_of(path)["name"] for path in folders} == {name}
    assert list(tmp_path.iterdir()) == [tmp_path / "incidents"]
    assert all(len(payloads(path)) == 1 for path in folders)

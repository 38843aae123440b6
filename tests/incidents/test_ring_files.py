# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What memory has no room for is kept on disk, as far as that has room."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from incidents.folder_runs import MS, START_MS, FolderRun, payloads, record_of
from incidents.incident_runs import AMPLE_BYTES, recording_rules
from smarttestudo.incidents.background import BackgroundSink
from smarttestudo.incidents.recorder import IncidentRecorder

RULES = recording_rules('Record "long" /odom /scan Before 20 s After 1 s')
MEMORY_BYTES = 100_000


def fill(run: FolderRun, *, seconds: int = 20) -> None:
    """A robot of 52 KB/s, which is ten times the memory in 20 s."""
    for _ in range(20 * seconds):
        run.wait(50)
        run.message("/odom", 100)
        run.message("/scan", 2500)


def given_up(folder: Path) -> dict[str, int]:
    """How many messages of each topic the record says that neither memory nor disk had room for."""
    missing = record_of(folder)["missing"]
    return {one["topic"]: one["messages"] for one in missing if one["reason"] == "memory"}


def test_an_incident_has_its_past_from_memory_and_disk(tmp_path: Path) -> None:
    run = FolderRun(RULES, tmp_path / "incidents", memory_bytes=MEMORY_BYTES, ring_bytes=AMPLE_BYTES)
    fill(run, seconds=30)
    assert run.recorder.held_bytes <= MEMORY_BYTES
    run.trigger()
    fill(run, seconds=2)
    (path,) = run.finish()
    window = [
        payload
        for _, steady_ms, topic, payload in run.came
        if run.begun_ms[0][1] - 20_000 <= steady_ms <= run.begun_ms[0][1] + 1000
    ]
    assert payloads(path) == dict.fromkeys(window, 1)
    assert record_of(path)["missing"] == []


def test_incidents_with_a_ring_are_those_with_ample_memory_byte_by_byte(tmp_path: Path) -> None:
    found = []
    for name, memory_bytes, ring_bytes in (("a", AMPLE_BYTES, None), ("b", MEMORY_BYTES, AMPLE_BYTES)):
        (tmp_path / name).mkdir()
        run = FolderRun(
            RULES, tmp_path / name / "incidents", memory_bytes=memory_bytes, ring_bytes=ring_bytes
        )
        for _ in range(4):
            fill(run, seconds=7)
            run.trigger()
        folders = run.finish()
        found.append(
            [(file.name, file.read_bytes()) for folder in folders for file in sorted(folder.iterdir())]
        )
    assert found[0] == found[1]


def test_the_ring_takes_no_more_than_its_share_of_the_disk_and_what_went_is_counted(tmp_path: Path) -> None:
    run = FolderRun(RULES, tmp_path / "incidents", memory_bytes=MEMORY_BYTES, ring_bytes=500_000)
    assert run.ring is not None
    for _ in range(20):
        fill(run, seconds=1)
        assert run.ring.size_bytes <= 500_000
    run.trigger()
    (path,) = run.finish()
    held = payloads(path)
    assert sum(given_up(path).values()) == len(run.came) - len(held) > 0
    # The newest are those that stay, all that fit.
    newest = [payload for _, _, _, payload in run.came[-2 * 500_000 // 2600 :]]
    assert set(held) >= set(newest)


def test_what_no_window_asks_for_any_more_is_given_back(tmp_path: Path) -> None:
    run = FolderRun(RULES, tmp_path / "incidents", memory_bytes=MEMORY_BYTES, ring_bytes=AMPLE_BYTES)
    assert run.ring is not None
    fill(run, seconds=100)
    # 20 s of it, and what is left in the oldest of its files.
    assert 0 < run.ring.size_bytes <= 20 * 52_000 + AMPLE_BYTES // 64
    assert not list((tmp_path / "ring").iterdir())
    run.ring.close()
    assert run.ring.size_bytes == 0


def test_a_disk_that_is_full_costs_what_it_cannot_take_and_is_named_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = []

    def full(*asked: object) -> int:
        refused.append(asked)
        raise OSError(28, os.strerror(28))

    run = FolderRun(RULES, tmp_path / "incidents", memory_bytes=MEMORY_BYTES, ring_bytes=AMPLE_BYTES)
    assert run.ring is not None
    fill(run, seconds=5)
    with monkeypatch.context() as patched:
        patched.setattr("os.pwrite", full)
        fill(run, seconds=1)
        assert "No space left on device" in str(run.ring.problem)
    fill(run, seconds=5)
    run.trigger()
    (path,) = run.finish()
    assert [str(error) for error in run.ring_errors] == [
        f"{tmp_path / 'ring'}: error: what came before an incident cannot be written: "
        "No space left on device; free some space or write to another disk"
    ]
    assert run.ring.problem is None
    assert sum(given_up(path).values()) == len(refused) >= 20
    assert len(payloads(path)) == len(run.came) - sum(given_up(path).values())


def test_the_loop_only_hands_over_and_what_waits_too_long_is_counted(tmp_path: Path) -> None:
    run = FolderRun(RULES, tmp_path / "incidents", ring_bytes=AMPLE_BYTES)
    failed: list[str] = []
    sink = BackgroundSink(
        run.folders, 10_000, failed=lambda name, error: failed.append(f"{name} {error}"), ring=run.ring
    )
    run.recorder = IncidentRecorder(run.rule_set, sink, 20_000, START_MS * MS, store=sink.store)
    for topic in run.topics:
        run.recorder.on_subscribed(topic, START_MS * MS, transient_local=False)
    # The thread that writes begins only now.
    fill(run, seconds=1)
    assert run.ring is not None
    assert run.ring.size_bytes == 0
    run.trigger()
    with sink.running():
        run.recorder.finish(run.clock_ms * MS + 2_000_000_000)
    run.ring.close()
    assert failed == []
    (path,) = (tmp_path / "incidents").iterdir()
    assert sum(given_up(path).values()) == len(run.came) - len(payloads(path)) > 0

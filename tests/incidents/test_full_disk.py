# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A disk that refuses a write, or every write from some moment on, while incidents are recorded.

Whichever it is: once the run has ended and another one begins, every incident says that it was the disk.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from incidents.folder_runs import LATCHED, FolderRun, channel, payloads, record_of
from incidents.incident_runs import recording_rules
from smarttestudo.bags.mcap.record_bytes import file_start
from smarttestudo.domain.incident import MissingReason
from smarttestudo.domain.link import MessageOrigin, MissedMessage
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.incidents.folder import complete_incidents
from smarttestudo.incidents.live_outages import OutageFolder

WRITES = ("mkdir", "open", "fdopen", "writev", "write", "pwrite", "posix_fallocate", "rename", "replace")
MESSAGES = 12
SIZE_BYTES = 300
ONCE = 1
FOR_GOOD = 10_000


@contextmanager
def refusing(monkeypatch: pytest.MonkeyPatch, first: int, count: int) -> Iterator[list[str]]:
    """Refuse ``count`` writes from number ``first`` on; the names of those that were refused."""
    refused: list[str] = []
    number = 0
    usual = {name: getattr(os, name) for name in WRITES}

    def refusing_one(name: str, write: Callable[..., Any]) -> Callable[..., Any]:
        def refuse(*given: Any, **named: Any) -> Any:
            nonlocal number
            if name == "open" and not given[1] & os.O_CREAT:
                return write(*given, **named)
            number += 1
            if not first <= number < first + count:
                return write(*given, **named)
            refused.append(name)
            if name == "writev" and len(b"".join(given[1])) > SIZE_BYTES:
                # A disk takes what it has room for.
                return usual["write"](given[0], b"".join(given[1])[:50])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        return refuse

    with monkeypatch.context() as patched:
        for name, write in usual.items():
            patched.setattr(f"os.{name}", refusing_one(name, write))
        yield refused


def recorded(folder: Path, failed: list[str]) -> FolderRun:
    """Two incidents of two moments each; the run ends within the second."""
    return FolderRun(
        recording_rules(
            'Record "one" /odom Before 1 s After 1 s', 'Record "two" /odom Before 900 ms After 1 s'
        ),
        folder,
        failed=lambda name, error: failed.append(f"{name}: {error}"),
    )


def drive(run: FolderRun) -> None:
    run.message(LATCHED)
    for number in range(MESSAGES):
        run.wait(100)
        run.message("/odom", SIZE_BYTES)
        if number in {3, 8}:
            run.trigger()


@pytest.mark.parametrize("count", [ONCE, FOR_GOOD], ids=["once", "for good"])
def test_whichever_write_fails_incidents_of_a_run_that_ended_say_that_it_was_the_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count: int
) -> None:
    tried: set[str] = set()
    for first in range(1, 1000):
        failed: list[str] = []
        folder = tmp_path / str(first)
        run = recorded(folder, failed)
        with refusing(monkeypatch, first, count) as refused:
            drive(run)
            run.finish()
        if not refused:
            break
        tried.update(refused)
        expect_the_disk(run, failed)
    assert tried >= set(WRITES) - ({"write"} if count == ONCE else set())


def expect_the_disk(run: FolderRun, failed: list[str]) -> None:
    """All that the incidents of ``run`` lack is told, and that it was for the disk."""
    completed = list(complete_incidents(run.folder))
    assert all(one.error is None for one in completed)
    found = sorted(run.folder.iterdir())
    assert not [path for path in found if path.name.startswith(".")]
    # An incident of which nothing could be written was told by the run.
    assert len(found) == 2 or len({line.partition(":")[0] for line in failed}) >= 2 - len(found)
    for path in found:
        record, held = record_of(path), payloads(path)
        missing = [one for one in record["missing"] if one["reason"] not in {"ended", "late"}]
        assert {one["reason"] for one in missing} <= {"disk"}
        began_ms = record["from_ns"] // 1_000_000
        window = {payload for clock_ms, _, topic, payload in run.came if clock_ms >= began_ms}
        lacking = len(window - set(held))
        assert not lacking or missing, "what is not there is told"
        if all(one["messages"] is not None for one in missing):
            assert sum(one["messages"] for one in missing) >= lacking


def test_a_run_that_is_killed_after_all_says_so(tmp_path: Path) -> None:
    run = recorded(tmp_path / "incidents", [])
    drive(run)
    assert len(list(complete_incidents(run.folder))) == 2
    for path in run.folder.iterdir():
        assert {one["reason"] for one in record_of(path)["missing"]} == {"killed"}


def test_a_disk_that_stays_full_takes_the_end_of_its_incidents_from_their_reserve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failed: list[str] = []
    rules = recording_rules('Record "one" /odom Before 1 s After 1 s')
    run = FolderRun(rules, tmp_path / "incidents", failed=lambda name, _: failed.append(name))
    run.message("/odom", SIZE_BYTES)
    run.trigger()
    (partial,) = run.folder.iterdir()
    assert (partial / "reserve").stat().st_blocks * 512 >= 64_000
    with refusing(monkeypatch, 1, 2):
        run.message("/odom", SIZE_BYTES)
    assert len(failed) == 1
    (path,) = run.finish()
    assert not path.name.startswith(".")
    assert sorted(one.suffix for one in path.iterdir()) == [".json", ".mcap", ".yaml"]
    (lost,) = (one for one in record_of(path)["missing"] if one["reason"] == "disk")
    assert (lost["topic"], lost["messages"]) == ("/odom", 1)


def empty(path: Path) -> None:
    path.mkdir()


def of_a_reserve(path: Path) -> None:
    path.mkdir()
    (path / "reserve").write_bytes(bytes(1000))


def of_files_without_data(path: Path) -> None:
    path.mkdir()
    (path / ".incident.json-abcdefgh.partial").write_bytes(b"{")
    (path / "20260102T030405678Z-near_miss_0.mcap").touch()


def of_a_message(path: Path) -> None:
    path.mkdir()
    (path / "20260102T030405678Z-near_miss_0.mcap").write_bytes(file_start())


def of_somebody(path: Path) -> None:
    path.mkdir()
    (path / "notes.txt").touch()


@pytest.mark.parametrize(
    ("make", "name", "stays"),
    [
        (empty, "20260102T030405678Z-near_miss", False),
        (empty, "20260102T030405678Z-near_miss-2", False),
        (empty, "20260102T030405678Z-outage", False),
        (of_a_reserve, "20260102T030405678Z-near_miss", False),
        (of_files_without_data, "20260102T030405678Z-near_miss", False),
        (of_a_message, "20260102T030405678Z-near_miss", True),
        (of_somebody, "20260102T030405678Z-near_miss", True),
        (empty, "mine", True),
    ],
)
def test_a_folder_that_was_only_begun_is_gone_at_the_next_start_and_no_other(
    tmp_path: Path, make: Callable[[Path], None], name: str, *, stays: bool
) -> None:
    path = tmp_path / f".{name}.partial"
    make(path)
    before = sorted(tmp_path.rglob("*"))
    assert list(complete_incidents(tmp_path)) == []
    assert sorted(tmp_path.rglob("*")) == (before if stays else [])


def test_a_link_to_an_empty_folder_is_none_of_ours(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    link = tmp_path / ".20260102T030405678Z-near_miss.partial"
    link.symlink_to(tmp_path / "elsewhere")
    assert list(complete_incidents(tmp_path)) == []
    assert link.is_symlink()


def test_an_outage_that_cannot_be_begun_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with refusing(monkeypatch, 2, FOR_GOOD), pytest.raises(OutputFileError):
        OutageFolder(tmp_path, {}, 0, "")
    assert list(tmp_path.iterdir()) == []


def test_an_outage_whose_disk_is_full_says_what_it_lacks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    channels = {"/odom": channel("/odom")}
    outage = OutageFolder(tmp_path, channels, 0, "")
    missed = [
        MissedMessage(origin=MessageOrigin(topic="/odom", stamp_ns=number), payload=bytes(SIZE_BYTES))
        for number in range(10)
    ]
    for one in missed[:4]:
        outage.write(one)
    with refusing(monkeypatch, 1, FOR_GOOD):
        with pytest.raises(OutputFileError, match="cannot be written"):
            outage.write(missed[4])
        for one in missed[5:]:
            outage.write(one)
    path = outage.end()
    assert sum(payloads(path).values()) == 4
    (lost,) = record_of(path)["missing"]
    assert (lost["topic"], lost["reason"], lost["messages"], lost["from_ns"]) == ("/odom", "disk", 6, 4)
    assert sorted(one.suffix for one in path.iterdir()) == [".json", ".mcap", ".yaml"]


def test_a_record_of_an_older_version_that_a_killed_run_left_says_killed(tmp_path: Path) -> None:
    run = FolderRun(recording_rules('Record "one" /odom Before 1 s After 1 s'), tmp_path / "incidents")
    run.trigger()
    (partial,) = run.folder.iterdir()
    record = partial / "incident.json"
    text = record.read_text().replace('"missing": [', '"other": [')
    record.write_text(text)
    (partial / "reserve").unlink()
    assert [one.error for one in complete_incidents(run.folder)] == [None]
    (path,) = run.folder.iterdir()
    assert {one["reason"] for one in record_of(path)["missing"]} == {MissingReason.KILLED.value}

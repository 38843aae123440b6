# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents of earlier versions, which had files in common by hard links, and the disk that they take."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from bags.bag_factory import BagMessage
from bags.bag_reading import read_bag, read_with_rosbags
from incidents.folder_runs import channel, disk_bytes
from smarttestudo.bags.mcap.writer import FileContent, McapWriter
from smarttestudo.cli.main import main
from smarttestudo.domain.incident import IncidentRecord, IncidentTopic
from smarttestudo.incidents.folder import (
    as_if_killed,
    complete_incidents,
    finish_folder,
    finished_record,
    make_reserve,
    write_record,
)
from smarttestudo.incidents.store import make_room

S = 1_000_000_000
ODOM = channel("/odom")
NAMES = ("19700101T001640000Z-near_miss", "19700101T001642000Z-near_miss")
RECORD = IncidentRecord(
    name="near miss",
    rule="Close call",
    path="rules.adirf",
    line=7,
    triggered_ns=1000 * S,
    from_ns=997 * S,
    to_ns=1002 * S,
    values={},
    rules_sha256="ab",
    topics={"/odom": IncidentTopic(type_name="", messages=0, size_bytes=0)},
)


def segment(
    folder: Path, number: int, begin_s: int, *, is_open: bool = False
) -> tuple[str, FileContent | None]:
    """A file of one second, 4 KB a message."""
    name = f"{folder.name.removeprefix('.').removesuffix('.partial')}_{number}.mcap"
    writer = McapWriter(folder / name)
    for tick in range(10):
        stamp_ns = begin_s * S + tick * S // 10
        writer.write(ODOM, stamp_ns, stamp_ns.to_bytes(8, "little") + bytes(4000))
    if is_open:
        writer.abandon()
        return name, None
    return name, writer.close()


def write_two(folder: Path, *, is_killed: bool = False) -> list[Path]:
    """Two incidents 2 s apart with windows of 5 s: what both have lies there once, under names of its own."""
    paths = [folder / (f".{name}.partial" if is_killed else name) for name in NAMES]
    of_both: list[dict[str, FileContent | None]] = [{}, {}]
    for path in paths:
        path.mkdir(parents=True)
    for begin_s in range(997, 1004):
        first = begin_s >= 1002
        name, content = segment(
            paths[first], len(of_both[first]), begin_s, is_open=is_killed and begin_s == 1001
        )
        of_both[first][name] = content
        if 999 <= begin_s < 1002:
            other = f"{NAMES[1]}_{len(of_both[1])}.mcap"
            os.link(paths[0] / name, paths[1] / other)
            of_both[1][other] = content
        if is_killed and begin_s == 1001:
            break
    for path, files, moved_ns in zip(paths, of_both, (0, 2 * S), strict=True):
        record = replace(
            RECORD,
            triggered_ns=RECORD.triggered_ns + moved_ns,
            from_ns=RECORD.from_ns + moved_ns,
            to_ns=RECORD.to_ns + moved_ns,
        )
        if is_killed:
            make_reserve(path, {})
            write_record(path, as_if_killed(record))
        else:
            contents = {name: content for name, content in files.items() if content is not None}
            finish_folder(path, finished_record(record, contents, {"/odom": ODOM}), contents, {})
    return paths


def seconds(messages: Sequence[BagMessage]) -> list[float]:
    return [one.stamp_ns / S for one in messages]


def test_incidents_that_share_files_are_listed_and_read_as_before(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = write_two(tmp_path)
    assert main(["incidents", "list", str(tmp_path), "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [(one["incident"], one["messages"], one["moments"]) for one in listed] == [
        (name, 50, 1) for name in NAMES
    ]
    for path, begin_s in zip(paths, (997, 999), strict=True):
        messages = read_bag(path).messages
        assert seconds(messages) == [begin_s + tick / 10 for tick in range(50)]
        assert read_with_rosbags(path) == messages
        assert main(["incidents", "show", str(tmp_path), path.name]) == 0
        assert capsys.readouterr().err == ""


def test_what_another_incident_shares_stays_when_one_is_deleted(tmp_path: Path) -> None:
    paths = write_two(tmp_path)
    expected = read_bag(paths[1]).messages
    assert main(["incidents", "delete", str(tmp_path), paths[0].name]) == 0
    assert read_bag(paths[1]).messages == expected


def test_the_limit_of_the_disk_counts_a_shared_file_once(tmp_path: Path) -> None:
    paths = write_two(tmp_path)
    taken_bytes = disk_bytes(tmp_path)
    assert taken_bytes < sum(map(disk_bytes, paths))
    assert list(make_room(tmp_path, taken_bytes)) == []
    assert [one.name for one in make_room(tmp_path, taken_bytes - 1)] == [NAMES[0]]


def test_a_run_that_was_killed_while_incidents_shared_files_is_completed(tmp_path: Path) -> None:
    write_two(tmp_path, is_killed=True)
    assert [(one.name, one.messages, one.error) for one in complete_incidents(tmp_path)] == [
        (NAMES[0], 50, None),
        (NAMES[1], 30, None),
    ]
    for name, begin_s, count in zip(NAMES, (997, 999), (50, 30), strict=True):
        assert seconds(read_bag(tmp_path / name).messages) == [begin_s + tick / 10 for tick in range(count)]
        record = json.loads((tmp_path / name / "incident.json").read_text())
        (missing,) = record["missing"]
        assert missing["reason"] == "killed"

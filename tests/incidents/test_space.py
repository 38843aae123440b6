# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Room for new incidents: what was read goes first, then the oldest, and nothing without a word."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.incidents.store import RemovedIncident, make_room

FILE_BYTES = 8192


def named(number: int) -> str:
    return f"20260102T03040567{number}Z-near_miss"


def add(folder: Path, name: str, *, files: int = 1, is_read: bool = False) -> Path:
    path = folder / name
    path.mkdir(parents=True)
    (path / "incident.json").touch()
    for number in range(files):
        (path / f"{name}_{number}.mcap").write_bytes(bytes(FILE_BYTES))
    if is_read:
        (path / "read").touch()
    return path


def removed(folder: Path, files: float) -> list[str]:
    return [one.name for one in make_room(folder, round(files * FILE_BYTES))]


def test_those_that_were_read_go_first_and_then_the_oldest(tmp_path: Path) -> None:
    for number in range(6):
        add(tmp_path, named(number), is_read=number in {2, 3})
    assert removed(tmp_path, 6) == []
    assert list(make_room(tmp_path, 5 * FILE_BYTES)) == [RemovedIncident(name=named(2), was_read=True)]
    assert removed(tmp_path, 3) == [named(3), named(0)]


def test_the_newest_and_what_is_no_whole_incident_stay(tmp_path: Path) -> None:
    add(tmp_path, named(0), is_read=True)
    add(tmp_path, named(1))
    add(tmp_path, f".{named(2)}.partial")
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "text").write_bytes(bytes(FILE_BYTES))
    (tmp_path / "linked").symlink_to(tmp_path / "notes")
    assert removed(tmp_path, 0) == [named(0)]
    assert {path.name for path in tmp_path.iterdir()} == {named(1), f".{named(2)}.partial", "notes", "linked"}


def test_a_shared_file_is_freed_with_the_last_that_has_it(tmp_path: Path) -> None:
    first = add(tmp_path, named(0), files=1)
    second = add(tmp_path, named(1), files=0)
    (second / f"{second.name}_0.mcap").hardlink_to(first / f"{first.name}_0.mcap")
    add(tmp_path, named(2))
    add(tmp_path, named(3))
    assert removed(tmp_path, 3) == []
    assert removed(tmp_path, 2) == [named(0), named(1)]


def test_the_incident_that_was_just_recorded_stays_though_the_clock_is_behind(tmp_path: Path) -> None:
    for written, number in enumerate((5, 3, 4, 1)):
        record = add(tmp_path, named(number)) / "incident.json"
        os.utime(record, ns=(0, written))
    # The order is that in which they were written, not that of their names.
    assert removed(tmp_path, 3) == [named(5)]
    assert removed(tmp_path, 0) == [named(3), named(4)]
    add(tmp_path, named(2))
    os.utime(tmp_path / named(2) / "incident.json", ns=(0, 0))
    gone = list(make_room(tmp_path, 0, named(2)))
    assert [one.name for one in gone] == [named(1)]


@given(st.lists(st.tuples(st.integers(0, 3), st.booleans()), max_size=8), st.integers(0, 20))
def test_an_unread_one_never_goes_before_one_that_was_read(
    incidents: list[tuple[int, bool]], files: int
) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number, (count, is_read) in enumerate(incidents):
            add(folder, named(number), files=count, is_read=is_read)
        gone = list(make_room(folder, files * FILE_BYTES))
        assert [one.was_read for one in gone] == sorted((one.was_read for one in gone), reverse=True)
        if any(not one.was_read for one in gone):
            left = [path for path in sorted(folder.iterdir())[:-1] if (path / "read").exists()]
            assert left == []
        for was_read in (True, False):
            names = [one.name for one in gone if one.was_read is was_read]
            assert names == sorted(names)

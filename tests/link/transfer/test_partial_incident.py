# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folder of an incident that is being fetched, whatever somebody did to it meanwhile."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.link.transfer.messages import PlannedFile, TransferPiece, TransferPlan
from smarttestudo.link.transfer.order import ByteRange, RangePart
from smarttestudo.link.transfer.partial_incident import STATE_NAME, PartialIncident

NAME = "20260102T030405678Z-near_miss"
DATA = bytes(range(200))


def plan(token: int = 1, data: bytes = DATA, *, name: str = "a.mcap") -> TransferPlan:
    sha256 = hashlib.sha256(data).hexdigest()
    return TransferPlan(token=bytes([token] * 16), files=(PlannedFile(name, len(data), sha256),), levels=())


def piece(start: int, end: int) -> TransferPiece:
    part = RangePart(ByteRange(0, 0, len(DATA)), start, end - start)
    return TransferPiece(parts=(part,), body=DATA[start:end], advised_bytes=1, waiting=0)


def begin(folder: Path) -> Path:
    """Half of it is there."""
    with PartialIncident(folder, NAME, plan()) as partial:
        partial.write(piece(0, 100))
        partial.save()
        return partial.path


def test_another_fetch_goes_on(tmp_path: Path) -> None:
    begin(tmp_path)
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        assert partial.cursor == 100
        partial.write(piece(100, 200))
        path = partial.finish()
    assert path == tmp_path / NAME
    assert {one.name: one.read_bytes() for one in path.iterdir()} == {"a.mcap": DATA}


def test_what_a_kill_left_of_a_state_is_no_part_of_the_incident(tmp_path: Path) -> None:
    (begin(tmp_path) / f".{STATE_NAME}-aa5xrize.partial").touch()
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        partial.write(piece(100, 200))
        path = partial.finish()
    assert [one.name for one in path.iterdir()] == ["a.mcap"]


@pytest.mark.parametrize(
    "state", [b"", b"garbage", b"[" * 50_000, b'{"token": 1, "cursor": 100}', b'{"cursor": -1}', b"null"]
)
def test_a_state_that_was_edited_begins_anew(tmp_path: Path, state: bytes) -> None:
    (begin(tmp_path) / STATE_NAME).write_bytes(state)
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        assert partial.cursor == 0


def test_what_is_there_of_another_plan_is_deleted_and_nothing_else(tmp_path: Path) -> None:
    path = begin(tmp_path)
    (path / "mine.mcap").write_bytes(b"mine")
    (path / "folder").mkdir()
    with PartialIncident(tmp_path, NAME, plan(token=2, name="b.mcap")) as partial:
        assert partial.cursor == 0
    names = {one.name for one in path.iterdir() if not one.name.startswith(".")}
    assert names == {"b.mcap", "mine.mcap", "folder"}
    assert (path / "b.mcap").read_bytes() == bytes(len(DATA))
    assert (path / "mine.mcap").read_bytes() == b"mine"


def test_a_file_that_was_cut_begins_anew(tmp_path: Path) -> None:
    (begin(tmp_path) / "a.mcap").write_bytes(DATA[:50])
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        assert partial.cursor == 0


def test_what_is_not_what_the_robot_has_is_said_and_deleted(tmp_path: Path) -> None:
    with PartialIncident(tmp_path, NAME, plan(data=DATA[::-1])) as partial:
        partial.write(piece(0, 200))
        with pytest.raises(LinkError, match=r"a\.mcap is not what the robot has"):
            partial.finish()
        assert not (partial.path / "a.mcap").exists()
    assert not (tmp_path / NAME).exists()


def test_a_folder_in_which_nothing_was_written_goes_and_one_with_anything_in_it_stays(tmp_path: Path) -> None:
    with PartialIncident(tmp_path, NAME, plan()):
        pass
    with PartialIncident(tmp_path, NAME, plan(data=DATA[::-1])) as partial:
        partial.write(piece(0, 200))
        with pytest.raises(LinkError):
            partial.finish()
    with pytest.raises(OutputFileError, match="no room"):
        PartialIncident(tmp_path, NAME, replace(plan(), files=(PlannedFile("a.mcap", 2**60, ""),)))
    assert list(tmp_path.iterdir()) == []
    path = begin(tmp_path)
    with pytest.raises(OutputFileError, match="no room"):
        PartialIncident(
            tmp_path, NAME, TransferPlan(token=bytes(16), files=(PlannedFile("b", 2**60, ""),), levels=())
        )
    assert (path / "a.mcap").read_bytes()[:100] == DATA[:100]


@pytest.mark.parametrize("name", ["", "a.mcap", STATE_NAME, ".fetch.lock"])
@pytest.mark.parametrize("is_there", [True, False])
def test_links_lead_nowhere_and_are_named(tmp_path: Path, name: str, is_there: bool) -> None:
    outside = tmp_path / "outside"
    if is_there and name:
        outside.write_bytes(b"{}")
    elif is_there:
        outside.mkdir()
        (outside / "a.mcap").write_bytes(b"mine")
    folder = tmp_path / "folder"
    place = folder / f".{NAME}.partial" / name
    place.parent.mkdir(parents=True)
    place.symlink_to(outside)
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(TestudoError, match=name or "is a link"):
        begin(folder)
    for path in before:
        assert path == place or path.is_symlink() or path.exists()
    assert place.is_symlink()
    if name:
        assert not is_there or outside.read_bytes() == b"{}"
        assert outside.exists() == is_there
    else:
        assert not is_there or [one.name for one in outside.iterdir()] == ["a.mcap"]


def test_one_process_at_a_time_fetches_an_incident(tmp_path: Path) -> None:
    begin(tmp_path)
    is_refused = pytest.raises(OutputFileError, match="another process fetches this incident")
    with PartialIncident(tmp_path, NAME, plan()), is_refused:
        PartialIncident(tmp_path, NAME, plan())


@pytest.mark.parametrize("name", ["../x", "a/b", "", "x" * 10_000, ".hidden"])
def test_no_name_leads_out_of_the_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(LinkError):
        PartialIncident(tmp_path / "here", name, plan())
    assert list(tmp_path.iterdir()) == []


def test_what_the_disk_has_no_room_for_is_not_begun(tmp_path: Path) -> None:
    huge = TransferPlan(token=bytes(16), files=(PlannedFile("a.mcap", 2**60, "00" * 32),), levels=())
    with pytest.raises(
        OutputFileError, match=r"there is no room for 1 152 921 504 606\.8 MB with 50\.0 MB to spare"
    ):
        PartialIncident(tmp_path, NAME, huge)

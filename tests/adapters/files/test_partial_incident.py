# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folder of an incident that is being fetched, whatever somebody did to it meanwhile."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from smarttestudo.adapters.files.partial_incident import STATE_NAME, PartialIncident
from smarttestudo.adapters.files.whole_file import OutputFileError
from smarttestudo.domain.errors import LinkError
from smarttestudo.link.transfer_messages import PlannedFile, TransferPiece, TransferPlan
from smarttestudo.link.transfer_order import ByteRange, RangePart

NAME = "20260102T030405678Z-near_miss"
DATA = bytes(range(200))


def plan(token: int = 1, data: bytes = DATA) -> TransferPlan:
    sha256 = hashlib.sha256(data).hexdigest()
    return TransferPlan(
        token=bytes([token] * 16), files=(PlannedFile("a.mcap", len(data), sha256),), levels=()
    )


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


@pytest.mark.parametrize(
    "state", [b"", b"garbage", b"[" * 50_000, b'{"token": 1, "cursor": 100}', b'{"cursor": -1}', b"null"]
)
def test_a_state_that_was_edited_begins_anew(tmp_path: Path, state: bytes) -> None:
    (begin(tmp_path) / STATE_NAME).write_bytes(state)
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        assert partial.cursor == 0


def test_what_is_there_of_other_files_is_deleted(tmp_path: Path) -> None:
    path = begin(tmp_path)
    (path / "other.mcap").touch()
    with PartialIncident(tmp_path, NAME, plan(token=2)) as partial:
        assert partial.cursor == 0
        assert not (path / "other.mcap").exists()
        assert (path / "a.mcap").read_bytes() == bytes(len(DATA))


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


def test_links_lead_nowhere(tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "a.mcap").write_bytes(b"mine")
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / f".{NAME}.partial").symlink_to(outside)
    path = begin(folder)
    (path / "a.mcap").unlink()
    (path / "a.mcap").symlink_to(outside / "a.mcap")
    with PartialIncident(folder, NAME, plan()) as partial:
        assert partial.cursor == 0
    assert (outside / "a.mcap").read_bytes() == b"mine"


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
    with pytest.raises(OutputFileError, match="there is no room"):
        PartialIncident(tmp_path, NAME, huge)

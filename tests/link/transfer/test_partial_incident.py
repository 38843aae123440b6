# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folder of an incident that is being fetched, whatever somebody did to it meanwhile."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.link.transfer.order import ByteRange, TransferOrder
from smarttestudo.link.transfer.partial_incident import STATE_NAME, PartialIncident
from smarttestudo.link.transfer.plan import PlannedFile, TransferPlan

NAME = "20260102T030405678Z-near_miss"
DATA = bytes(range(200))


ORDER = TransferOrder([ByteRange(0, 0, 50), ByteRange(0, 50, 50)], [], [ByteRange(0, 100, 100)])


HALF = ORDER.size_bytes - 103
"""Up to where the last range begins, whose head has three bytes."""


def plan(version: int = 1, data: bytes = DATA, *, name: str = "a.mcap") -> TransferPlan:
    return TransferPlan(
        version=bytes([version] * 8),
        files=(PlannedFile(name, len(data), hashlib.sha256(data).hexdigest()),),
        levels=(),
        order_bytes=ORDER.size_bytes,
    )


def travelling(order: TransferOrder = ORDER, data: bytes = DATA) -> bytes:
    """All bytes of the order."""
    return b"".join(
        one if isinstance(one, bytes) else data[one.offset : one.offset + one.size_bytes]
        for one in order.stretches(0, order.size_bytes)
    )


def begin(folder: Path) -> Path:
    """Half of it is there."""
    with PartialIncident(folder, NAME, plan()) as partial:
        partial.write(travelling()[:HALF])
        partial.save()
        return partial.path


def test_another_fetch_goes_on(tmp_path: Path) -> None:
    begin(tmp_path)
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        assert (partial.cursor, partial.got_bytes) == (HALF, 100)
        partial.write(travelling()[HALF:])
        path = partial.finish()
    assert path == tmp_path / NAME
    assert {one.name: one.read_bytes() for one in path.iterdir()} == {"a.mcap": DATA}


@given(st.lists(st.integers(0, ORDER.size_bytes), max_size=8).map(sorted))
def test_however_it_is_cut_another_fetch_goes_on_with_the_next_byte(cuts: list[int]) -> None:
    whole = travelling()
    with TemporaryDirectory() as folder:
        for end in cuts:
            with PartialIncident(Path(folder), NAME, plan()) as partial:
                partial.write(whole[partial.cursor : end])
                partial.save()
        with PartialIncident(Path(folder), NAME, plan()) as partial:
            partial.write(whole[partial.cursor :])
            assert partial.got_bytes == len(DATA)
            assert (partial.finish() / "a.mcap").read_bytes() == DATA


@pytest.mark.parametrize(
    "lie",
    [
        ByteRange(1, 0, 5),
        ByteRange(0, 190, 20),
        ByteRange(0, 2**50, 5),
    ],
)
def test_a_range_that_is_in_no_file_is_refused(tmp_path: Path, lie: ByteRange) -> None:
    order = TransferOrder([lie], [])
    with PartialIncident(tmp_path, NAME, plan()) as partial, pytest.raises(LinkError, match="in no file"):
        partial.write(b"".join(one for one in order.stretches(0, 60) if isinstance(one, bytes)))


def test_no_more_is_written_than_the_plan_says(tmp_path: Path) -> None:
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        partial.write(travelling())
        with pytest.raises(LinkError, match="more than the incident has"):
            partial.write(travelling())


def test_what_a_kill_left_of_a_state_is_no_part_of_the_incident(tmp_path: Path) -> None:
    (begin(tmp_path) / f".{STATE_NAME}-aa5xrize.partial").touch()
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        partial.write(travelling()[HALF:])
        path = partial.finish()
    assert [one.name for one in path.iterdir()] == ["a.mcap"]


@pytest.mark.parametrize(
    "state", [b"", b"garbage", b"[" * 50_000, b'{"version": 1, "cursor": 100}', b'{"cursor": -1}', b"null"]
)
def test_a_state_that_was_edited_begins_anew(tmp_path: Path, state: bytes) -> None:
    (begin(tmp_path) / STATE_NAME).write_bytes(state)
    with PartialIncident(tmp_path, NAME, plan()) as partial:
        assert partial.cursor == 0


def test_what_is_there_of_another_plan_is_deleted_and_nothing_else(tmp_path: Path) -> None:
    path = begin(tmp_path)
    (path / "mine.mcap").write_bytes(b"mine")
    (path / "folder").mkdir()
    with PartialIncident(tmp_path, NAME, plan(version=2, name="b.mcap")) as partial:
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
        partial.write(travelling())
        with pytest.raises(LinkError, match=r"a\.mcap is not what the robot has"):
            partial.finish()
        assert not (partial.path / "a.mcap").exists()
    assert not (tmp_path / NAME).exists()


def test_a_folder_in_which_nothing_was_written_goes_and_one_with_anything_in_it_stays(tmp_path: Path) -> None:
    with PartialIncident(tmp_path, NAME, plan()):
        pass
    with PartialIncident(tmp_path, NAME, plan(data=DATA[::-1])) as partial:
        partial.write(travelling())
        with pytest.raises(LinkError):
            partial.finish()
    with pytest.raises(OutputFileError, match="no room"):
        PartialIncident(tmp_path, NAME, replace(plan(), files=(PlannedFile("a.mcap", 2**60, ""),)))
    assert list(tmp_path.iterdir()) == []
    path = begin(tmp_path)
    with pytest.raises(OutputFileError, match="no room"):
        PartialIncident(tmp_path, NAME, replace(plan(version=2), files=(PlannedFile("b", 2**60, ""),)))
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
    huge = replace(plan(), files=(PlannedFile("a.mcap", 2**60, "00" * 32),))
    with pytest.raises(
        OutputFileError, match=r"there is no room for 1 152 921 504 606\.8 MB with 50\.0 MB to spare"
    ):
        PartialIncident(tmp_path, NAME, huge)

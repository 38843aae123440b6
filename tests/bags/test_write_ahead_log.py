# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a recorder that crashed left in a log beside its .db3 is read, and nothing is written there."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.bag_factory import BagContent, small_mission, write_bag, write_humble_file
from bags.bag_reading import read_bag
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.sqlite.log import read_log
from smarttestudo.bags.sqlite.log_checksum import LogChecksum
from smarttestudo.domain.units import grouped

MISSION = small_mission()
FEW = BagContent(MISSION.topics, MISSION.messages[:1])
TOGETHER = "read together with crashed.db3-wal beside it, which holds what is not in it yet"
HEADER_BYTES = 32
FRAME_BYTES = 24 + 4096


@contextmanager
def recorder(path: Path) -> Iterator[sqlite3.Connection]:
    """A connection that writes as a recorder does: into the log, and never by itself into the file."""
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA wal_autocheckpoint = 0")
        yield database


def record(database: sqlite3.Connection, first: int, last: int) -> None:
    """Add messages of the mission in one transaction."""
    numbers = dict(database.execute("SELECT name, id FROM topics"))
    database.execute("BEGIN")
    for message in MISSION.messages[first:last]:
        row = (numbers[message.topic], message.stamp_ns, message.payload)
        database.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", row)
    database.execute("COMMIT")


def crashed(folder: Path, database: sqlite3.Connection) -> Path:
    """What is on the disk at this moment, as a crash would leave it."""
    (source,) = (row[2] for row in database.execute("PRAGMA database_list"))
    target = folder / "crash" / "crashed.db3"
    target.parent.mkdir(exist_ok=True)
    for suffix in ("", "-wal"):
        shutil.copy(source + suffix, str(target) + suffix)
    return target


@pytest.fixture
def crash(tmp_path: Path) -> Path:
    """The whole mission in the log, in transactions of twenty messages, and one message in the file."""
    with recorder(write_humble_file(tmp_path / "live.db3", FEW)) as database:
        for first in range(1, len(MISSION.messages), 20):
            record(database, first, first + 20)
        return crashed(tmp_path, database)


def rows_by_sqlite(path: Path, folder: Path) -> int:
    """What SQLite itself counts in a copy of the file and its log."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(path.parent, folder)
    with closing(sqlite3.connect(folder / path.name)) as database:
        return int(database.execute("SELECT count(*) FROM messages").fetchone()[0])


def log_of(path: Path) -> Path:
    return path.with_name(f"{path.name}-wal")


def test_messages_in_the_log_are_read_with_those_in_the_file(crash: Path) -> None:
    read = read_bag(crash)
    assert read.messages == list(MISSION.messages)
    assert read.notices == [f"{crash}: {TOGETHER}"]


def test_sizes_and_heads_are_those_of_the_messages(crash: Path) -> None:
    with open_recording(crash) as recording:
        assert [size for _, _, size in recording.sizes()] == [len(one.payload) for one in MISSION.messages]
        heads = [head for _, _, (_, head) in recording.heads(12)]
    assert heads == [message.payload[:12] for message in MISSION.messages]


def test_a_log_that_holds_everything_is_enough(tmp_path: Path) -> None:
    path = tmp_path / "live.db3"
    with recorder(path) as database:
        with closing(sqlite3.connect(write_humble_file(tmp_path / "made.db3", FEW))) as made:
            database.executescript(
                "BEGIN;" + "".join(line for line in made.iterdump() if "BEGIN" not in line)
            )
        record(database, 1, len(MISSION.messages))
        crash = crashed(tmp_path, database)
    assert crash.stat().st_size == 4096
    assert read_bag(crash).messages == list(MISSION.messages)


def test_neither_the_file_nor_the_log_nor_their_folder_is_touched(crash: Path) -> None:
    def state() -> dict[str, tuple[bytes, int]]:
        return {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in crash.parent.iterdir()}

    before = state()
    crash.parent.chmod(0o555)
    try:
        read_bag(crash)
    finally:
        crash.parent.chmod(0o755)
    assert state() == before


def ends_of_transactions(log: bytes) -> list[int]:
    starts = range(HEADER_BYTES, len(log), FRAME_BYTES)
    return [start + FRAME_BYTES for start in starts if any(log[start + 4 : start + 8])]


def test_a_log_cut_anywhere_gives_its_whole_transactions_and_says_what_is_left_out(
    crash: Path, tmp_path: Path
) -> None:
    data = log_of(crash).read_bytes()
    whole = [HEADER_BYTES, *ends_of_transactions(data)]
    for cut in (*range(0, len(data), len(data) // 20), 20, HEADER_BYTES, 40, whole[3], whole[3] + 24):
        log_of(crash).write_bytes(data[:cut])
        read = read_bag(crash)
        assert len(read.messages) == rows_by_sqlite(crash, tmp_path / "copy")
        assert read.messages == list(MISSION.messages[: len(read.messages)])
        left_out = cut - max((end for end in whole if end <= cut), default=0)
        expected = (
            f"the last {grouped(left_out)} bytes of {log_of(crash).name} are damaged, or of a transaction"
        )
        assert [expected in notice for notice in read.notices if "left out" in notice] == [True] * (
            left_out > 0
        )


def test_what_is_behind_a_damaged_byte_of_the_log_is_left_out(crash: Path, tmp_path: Path) -> None:
    data = log_of(crash).read_bytes()
    for place in range(3, len(data), len(data) // 12):
        damaged = bytearray(data)
        damaged[place] ^= 0x10
        log_of(crash).write_bytes(damaged)
        read = read_bag(crash)
        assert len(read.messages) == rows_by_sqlite(crash, tmp_path / "copy")
        assert sum("left out" in notice for notice in read.notices) == 1


def test_a_log_of_which_a_power_cut_left_zeros_is_named(crash: Path) -> None:
    data = log_of(crash).read_bytes()
    end = ends_of_transactions(data)[1]
    log_of(crash).write_bytes(data[:end] + bytes(5 * FRAME_BYTES))
    read = read_bag(crash)
    assert read.messages == list(MISSION.messages[:41])
    assert any(f"the last {grouped(5 * FRAME_BYTES)} bytes" in notice for notice in read.notices)


def test_frames_of_an_earlier_turn_of_the_log_are_not_taken_for_damage(tmp_path: Path) -> None:
    with recorder(write_humble_file(tmp_path / "live.db3", FEW)) as database:
        record(database, 1, 100)
        database.execute("PRAGMA wal_checkpoint(RESTART)")
        record(database, 100, 110)
        crash = crashed(tmp_path, database)
    read = read_bag(crash)
    assert read.messages == list(MISSION.messages[:110])
    assert read.notices == [f"{crash}: {TOGETHER}"]


@pytest.mark.parametrize("what", ["log", "file"])
def test_a_log_beside_a_cut_file_gives_what_either_holds(tmp_path: Path, what: str) -> None:
    with recorder(write_humble_file(tmp_path / "live.db3", FEW)) as database:
        record(database, 1, 140)
        database.execute("PRAGMA wal_checkpoint(RESTART)")
        record(database, 140, len(MISSION.messages))
        crash = crashed(tmp_path, database)
    size_bytes = crash.stat().st_size // 2
    crash.write_bytes(crash.read_bytes()[:size_bytes])
    if what == "file":
        log_of(crash).unlink()
    read = read_bag(crash)
    assert set(read.messages) < set(MISSION.messages)
    assert len(set(read.messages)) == len(read.messages)
    assert (MISSION.messages[-1] in read.messages) == (what == "log")
    assert any(" % readable, ends at " in notice for notice in read.notices)


def test_a_log_that_is_no_log_costs_a_notice(crash: Path) -> None:
    log_of(crash).write_text("dear diary, " * 40)
    read = read_bag(crash)
    assert read.messages == list(FEW.messages)
    assert len(read.notices) == 1
    assert "the last 480 bytes of crashed.db3-wal are damaged" in read.notices[0]


def test_an_empty_log_is_as_none(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "bag", MISSION) / "bag.db3"
    log_of(path).touch()
    assert read_log(path) is None
    assert read_bag(path).notices == []


@given(
    pieces=st.lists(
        st.binary(min_size=8, max_size=400).map(lambda data: data[: len(data) // 8 * 8]), max_size=5
    ),
    order=st.sampled_from(["little", "big"]),
)
def test_the_checksum_is_that_of_the_file_format(
    pieces: list[bytes], order: Literal["little", "big"]
) -> None:
    checksum = LogChecksum("<" if order == "little" else ">")
    first = second = 0
    for piece in pieces:
        for at in range(0, len(piece), 8):
            first = (first + int.from_bytes(piece[at : at + 4], order) + second) % 2**32
            second = (second + int.from_bytes(piece[at + 4 : at + 8], order) + first) % 2**32
        assert checksum.add(piece) == (first, second)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import io
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.bags.sqlite.recovered import DamagedRowError, SqlitePages

INTEGERS = st.integers(-(2**63), 2**63 - 1)
BLOBS = st.one_of(
    st.binary(max_size=40),
    st.builds(lambda n, b: b * n, st.integers(1, 9000), st.binary(min_size=1, max_size=2)),
)
ROWS = st.lists(st.tuples(INTEGERS, INTEGERS, BLOBS), max_size=40)


def database_file(path: Path, rows: list[tuple[int, int, bytes]], page_bytes: int) -> bytes:
    path.unlink(missing_ok=True)
    with closing(sqlite3.connect(path)) as database:
        database.execute(f"PRAGMA page_size = {page_bytes}")
        database.execute("PRAGMA synchronous = OFF")
        database.execute("CREATE TABLE messages (id INTEGER PRIMARY KEY, a INTEGER, b INTEGER, data BLOB)")
        database.executemany("INSERT INTO messages (a, b, data) VALUES (?, ?, ?)", rows)
        database.commit()
    return path.read_bytes()


def rows_in(data: bytes) -> dict[int, tuple[int, int, bytes]]:
    pages = SqlitePages(io.BytesIO(data))
    found = {}
    for offset in pages.rows():
        try:
            row = pages.row_at(offset)
        except DamagedRowError:
            continue
        match row.values:
            case (_, int() as a, int() as b, bytes() as blob):
                found[row.rowid] = (a, b, blob)
    return found


@settings(max_examples=60)
@given(rows=ROWS, page_bytes=st.sampled_from([512, 1024, 4096, 65536]))
def test_the_pages_hold_the_rows_that_sqlite_reads(
    rows: list[tuple[int, int, bytes]], page_bytes: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    data = database_file(tmp_path_factory.getbasetemp() / "pages.db3", rows, page_bytes)
    assert rows_in(data) == dict(enumerate(rows, start=1))


@settings(max_examples=40)
@given(rows=ROWS, gone=st.sets(st.integers(1, 40)), drops=st.booleans())
def test_rows_that_were_deleted_stay_deleted(
    rows: list[tuple[int, int, bytes]],
    gone: set[int],
    drops: bool,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    path = tmp_path_factory.getbasetemp() / "deleted.db3"
    database_file(path, rows, 512)
    with closing(sqlite3.connect(path)) as database:
        database.execute("PRAGMA synchronous = OFF")
        if drops:
            database.execute("DROP TABLE messages")
        else:
            database.executemany("DELETE FROM messages WHERE id = ?", [(number,) for number in gone])
        database.commit()
    kept = {} if drops else {n: row for n, row in enumerate(rows, start=1) if n not in gone}
    assert rows_in(path.read_bytes()) == kept


@settings(max_examples=40)
@given(rows=ROWS, share=st.floats(0, 1))
def test_what_is_left_of_a_cut_file_holds_whole_rows_only(
    rows: list[tuple[int, int, bytes]], share: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    data = database_file(tmp_path_factory.getbasetemp() / "pages.db3", rows, 512)
    cut = max(100, int(len(data) * share))
    expected = dict(enumerate(rows, start=1))
    assert rows_in(data[:cut]).items() <= expected.items()

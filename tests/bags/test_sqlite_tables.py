# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Queries without an end are not begun, and those that pages in circles would make are interrupted."""

from __future__ import annotations

import sqlite3
import struct
from contextlib import closing
from pathlib import Path

import pytest

from bags.bag_factory import small_mission, write_bag
from bags.bag_reading import read_bag
from bags.damaged_files import storage_file
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError

ENDLESS = "WITH RECURSIVE endless(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM endless) SELECT"
MISSION = small_mission(0.4)
PAGE_BYTES = 512


def altered(folder: Path, statements: str) -> Path:
    path = storage_file(write_bag(folder / "bag", MISSION)).rename(folder / "alone.db3")
    with closing(sqlite3.connect(path)) as database:
        database.executescript(statements)
    return path


@pytest.mark.parametrize(
    ("statements", "cause"),
    [
        (
            "ALTER TABLE messages RENAME TO stored; CREATE VIEW messages AS "
            f"{ENDLESS} n AS id, 1 AS topic_id, n AS timestamp, x'00' AS data FROM endless",
            "its messages is a view: only tables of stored values are read",
        ),
        (
            f"DROP TABLE topics; CREATE VIEW Topics AS {ENDLESS} n AS id, '/a' AS name FROM endless",
            "its Topics is a view: only tables of stored values are read",
        ),
        (
            "DROP TABLE message_definitions; CREATE VIEW message_definitions AS "
            f"{ENDLESS} '' AS topic_type, '' AS encoding, '' AS encoded_message_definition FROM endless",
            "its message_definitions is a view: only tables of stored values are read",
        ),
        (
            "DROP TABLE messages; CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id, timestamp, "
            "data AS (zeroblob(100000000)))",
            "its messages is computed: only tables of stored values are read",
        ),
        (
            "DROP TABLE messages; CREATE VIRTUAL TABLE messages USING fts5(topic_id, timestamp, data)",
            "its messages is computed: only tables of stored values are read",
        ),
    ],
    ids=["messages", "topics", "definitions", "generated", "virtual"],
)
def test_what_is_no_table_of_stored_values_is_refused(tmp_path: Path, statements: str, cause: str) -> None:
    path = altered(tmp_path, statements)
    with pytest.raises(RecordingError) as refused, open_recording(path):
        pass
    assert refused.value.cause == cause


def test_metadata_of_a_view_are_not_read(tmp_path: Path) -> None:
    path = altered(
        tmp_path,
        "DROP TABLE IF EXISTS metadata; "
        f"CREATE VIEW metadata AS {ENDLESS} n AS id, 'text' AS metadata FROM endless",
    )
    with open_recording(path) as recording:
        assert sum(1 for _ in recording.messages()) == len(MISSION.messages)


def test_pages_that_lead_to_the_same_page_again_and_again_end(tmp_path: Path) -> None:
    path = tmp_path / "bag.db3"
    with closing(sqlite3.connect(path)) as database:
        database.execute(f"PRAGMA page_size = {PAGE_BYTES}")
        database.execute(
            "CREATE TABLE topics (id INTEGER PRIMARY KEY, name, type, serialization_format, "
            "offered_qos_profiles)"
        )
        database.execute("INSERT INTO topics VALUES (1, '/a', 'std_msgs/msg/String', 'cdr', '')")
        database.execute("CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id, timestamp, data)")
        database.execute("INSERT INTO messages VALUES (1, 1, 5, x'00')")
        database.commit()
        (root,) = database.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchone()
    data = bytearray(path.read_bytes())
    first = len(data) // PAGE_BYTES
    leaf = bytes(data[(root - 1) * PAGE_BYTES : root * PAGE_BYTES])
    levels = 10
    for level in range(levels):
        page = inner_page(child=first + 1 + level)
        if level:
            data += page
        else:
            data[(root - 1) * PAGE_BYTES : root * PAGE_BYTES] = page
    data += leaf
    struct.pack_into(">I", data, 28, len(data) // PAGE_BYTES)
    path.write_bytes(data)
    assert len(read_bag(path).messages) == 1


def inner_page(child: int, cells: int = 40) -> bytes:
    """An inner page of a table, all of whose children are the same page."""
    content = b"".join(struct.pack(">IB", child, 1) for _ in range(cells))
    start = PAGE_BYTES - len(content)
    head = struct.pack(">BHHHBI", 5, 0, cells, start, 0, child)
    pointers = b"".join(struct.pack(">H", start + 5 * cell) for cell in range(cells))
    return (head + pointers).ljust(start, b"\0") + content

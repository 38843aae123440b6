# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A text of a channel that is not UTF-8 costs itself, never a message, and is said once."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Callable
from contextlib import closing
from functools import partial
from pathlib import Path

import pytest

from bags.bag_factory import ODOM
from bags.recorded_by_others import (
    COUNT,
    QOS_IN_NUMBERS,
    Table,
    channel,
    chunk,
    drive,
    odometry_at,
    schema,
    stamp_of,
    write_records,
    write_tables,
)
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.recording import RosbagRecording
from smarttestudo.cli.main import main

TEXT = "std_msgs/msg/String"
FIELDS = {
    "topic": ("/marked", "name"),
    "type": ("std_msgs/msg/Marked", "type"),
    "qos": ("- history: 3", "QoS"),
    "format": ("marked_cdr", "serialization format"),
    "definition": ("# marked\nstring data\n", "definition"),
}
ESCAPED = r"m\xe9rked"


def value(field: str, odd: str, usual: str) -> str:
    return FIELDS[field][0] if field == odd else usual


def mark(path: Path, field: str) -> Path:
    """The same file with a byte of another encoding in one text, wherever that stands."""
    word = b"history" if field == "qos" else b"marked" if field != "type" else b"Marked"
    data = path.read_bytes()
    assert word in data
    path.write_bytes(data.replace(word, word[:1] + b"\xe9" + word[2:]))
    return path


def in_mcap(
    folder: Path, field: str, *, is_packed: bool = True, is_closed: bool = True, first: str = "/odom"
) -> Path:
    described = (
        schema(1, ODOM.type_name),
        channel(1, first, 1),
        schema(2, value(field, "type", TEXT), text=value(field, "definition", "string data\n")),
        channel(
            2,
            value(field, "topic", "/text"),
            2,
            encoding=value(field, "format", "cdr"),
            qos=value(field, "qos", QOS_IN_NUMBERS),
        ),
    )
    records = [*described, *drive(), *drive(of=2)]
    return mark(
        write_records(
            folder / "a.mcap",
            *(chunk(*records, has_checksum=False) if is_packed else records),
            described=described,
            is_closed=is_closed,
        ),
        field,
    )


def in_tables(folder: Path, field: str, *, first: str = "/odom") -> Path:
    type_name = value(field, "type", TEXT)
    rows = [(stamp_of(number), odometry_at(number)) for number in range(COUNT)]
    tables = [
        Table(first, ODOM.type_name, rows),
        Table(
            value(field, "topic", "/text"),
            type_name,
            rows,
            serialization_format=value(field, "format", "cdr"),
            qos=value(field, "qos", QOS_IN_NUMBERS),
        ),
    ]
    definitions = {type_name: value(field, "definition", "string data\n")}
    return mark(
        write_tables(folder / "a.db3", tables, distribution="rolling", definitions=definitions), field
    )


MADE: dict[str, Callable[..., Path]] = {
    "chunks": in_mcap,
    "no chunks": partial(in_mcap, is_packed=False),
    "cut": partial(in_mcap, is_packed=False, is_closed=False),
    "tables": in_tables,
}


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("storage", MADE)
def test_a_text_that_is_not_utf_8_costs_itself_and_is_said_once(
    tmp_path: Path, storage: str, field: str
) -> None:
    path = MADE[storage](tmp_path, field)
    topic = "/" + ESCAPED if field == "topic" else "/text"
    with open_recording(path) as recording:
        assert isinstance(recording, RosbagRecording)
        counts = Counter(channel.topic for channel, *_ in recording.messages())
        notices = recording.notices()
        types = {channel.topic: channel.type_name for channel in recording.channels}
    assert counts == {"/odom": COUNT, topic: COUNT}
    assert types == {
        "/odom": ODOM.type_name,
        topic: TEXT if field != "type" else r"std_msgs/msg/M\xe9rked",
    }
    of_texts = [notice for notice in notices if "cut off" not in notice]
    (notice,) = of_texts
    assert FIELDS[field][1] in notice
    assert topic in notice or (field == "definition" and TEXT in notice)


@pytest.mark.parametrize("make", [in_mcap, in_tables])
def test_names_that_differ_in_such_a_byte_are_two_topics(tmp_path: Path, make: Callable[..., Path]) -> None:
    path = make(tmp_path, "topic", first="/mxrked")
    path.write_bytes(path.read_bytes().replace(b"/mxrked", b"/m\xffrked"))
    with open_recording(path) as recording:
        counts = Counter(channel.topic for channel, *_ in recording.messages())
    assert counts == {r"/m\xffrked": COUNT, "/" + ESCAPED: COUNT}


def test_what_is_odd_in_each_of_several_files_is_said_once(tmp_path: Path) -> None:
    for number in range(3):
        data = in_tables(tmp_path / str(number), "topic").read_bytes()
        # A copy would be left out.
        (tmp_path / f"a_{number}.db3").write_bytes(data + bytes(4096 * number))
    with open_recording(tmp_path) as recording:
        _, *notices = recording.notices()
    assert notices == [f"{tmp_path / 'a_0.db3'} and 2 other files: /{ESCAPED}: its name is not UTF-8"]


def test_check_and_info_say_the_same_of_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = MADE["no chunks"](tmp_path, "qos")
    rules = tmp_path / "rules.adirf"
    rules.write_text("begin\nSetFrequency /text Full If CheckValue /odom pose_x > 2\nend\n")
    main(["check", str(rules), "--bag", str(path)])
    checked = capsys.readouterr()
    main(["bag", "info", str(path)])
    told = capsys.readouterr()
    said = "the QoS profiles of /text cannot be read and were left out"
    for text in (checked.out + checked.err, told.out + told.err):
        assert text.count(said) == 1
        assert "damaged" not in text


@pytest.mark.parametrize("name", ["other", "topics"])
def test_another_table_whose_name_is_not_utf_8_costs_nothing(tmp_path: Path, name: str) -> None:
    rows = [(stamp_of(number), odometry_at(number)) for number in range(COUNT)]
    path = write_tables(tmp_path / "a.db3", [Table("/odom", ODOM.type_name, rows)])
    with closing(sqlite3.connect(path)) as database:
        column = "marked" if name == "topics" else "x"
        if name == "topics":
            database.execute(f"ALTER TABLE topics ADD COLUMN {column} TEXT")
        else:
            database.execute("CREATE TABLE marked (x TEXT)")
    mark(path, "topic")
    with open_recording(path) as recording:
        assert sum(1 for _ in recording.messages()) == COUNT
        assert recording.notices() == []

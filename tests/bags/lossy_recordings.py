# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of which something is lost, damaged or named twice."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import zstandard

from bags.bag_factory import ODOM
from bags.recorded_by_others import (
    COUNT,
    ODOMETRY,
    Table,
    channel,
    chunk,
    drive,
    odometry_at,
    schema,
    stamp_of,
    text_at,
    write_metadata,
    write_records,
    write_tables,
)
from bags.recording_case import Case, a_drive

TEXT = "std_msgs/msg/String"


def rows_deleted(folder: Path) -> Path:
    """Half of the rows are gone, and metadata.yaml still says how many there were."""
    rows = [(stamp_of(number), odometry_at(number)) for number in range(COUNT // 2)]
    write_tables(folder / "a_0.db3", [Table("/odom", ODOM.type_name, rows)])
    return write_metadata(folder, ["a_0.db3"], {"/odom": (ODOM.type_name, COUNT)}, storage="sqlite3")


def write_two_topics(folder: Path, storage: str, odom: int, text: int, promised: tuple[int, int]) -> Path:
    """So many messages of two topics, and metadata.yaml that promises as many or others."""
    if storage == "sqlite3":
        rows = [(stamp_of(number), odometry_at(number)) for number in range(odom)]
        texts = [(stamp_of(number), text_at(number)) for number in range(text)]
        write_tables(folder / "a_0.db3", [Table("/odom", ODOM.type_name, rows), Table("/text", TEXT, texts)])
    else:
        described = (*ODOMETRY, schema(2, TEXT), channel(2, "/text", 2))
        messages = [*drive(range(odom)), *drive(range(text), payload=text_at, of=2)]
        write_records(folder / "a_0.mcap", *chunk(*described, *messages), described=described)
    name = "a_0.db3" if storage == "sqlite3" else "a_0.mcap"
    topics = {"/odom": (ODOM.type_name, promised[0]), "/text": (TEXT, promised[1])}
    return write_metadata(folder, [name], topics, storage=storage)


def one_lost_and_one_gained(folder: Path, *, storage: str, gained: int) -> Path:
    """A topic has less than its metadata say, another more, perhaps as many."""
    return write_two_topics(folder, storage, 100, 20 + gained, (140, 20))


def named_otherwise(folder: Path, *, storage: str) -> Path:
    """The topic of the metadata is not the topic of the file."""
    write_two_topics(folder, storage, 100, 20, (100, 20))
    metadata = folder / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("name: /text", "name: /txt"))
    return folder


def one_file_lost_what_the_other_gained(folder: Path) -> Path:
    """Metadata from version 5 on have the messages of each file."""
    files = []
    for part, (count, promised) in enumerate(((40, 50), (60, 50))):
        numbers = range(part * 40, part * 40 + count)
        write_records(folder / f"a_{part}.mcap", *chunk(*ODOMETRY, *drive(numbers)))
        files.append({"path": f"a_{part}.mcap", "message_count": promised})
    topics = {"/odom": (ODOM.type_name, COUNT)}
    return write_metadata(folder, ["a_0.mcap", "a_1.mcap"], topics, version=5, files=files)


def in_both_storages(
    name: str, make: Callable[..., Path], said: Sequence[str], **more: Any
) -> tuple[Case, ...]:
    return tuple(
        a_drive(
            f"{name}, {storage}",
            partial(make, storage=storage),
            said=[said],
            is_quiet=False,
            is_whole=False,
            **more,
        )
        for storage in ("mcap", "sqlite3")
    )


def packed_one_by_one(folder: Path, *, storage: str) -> Path:
    """Each message is compressed, and every third one is damaged, the first one included."""

    def packed_at(number: int) -> bytes:
        data = zstandard.compress(odometry_at(number))
        return data if number % 3 else data[:-9] if number else b"?" + data

    packing: dict[str, Any] = {"compression_format": "zstd", "compression_mode": "MESSAGE"}
    if storage == "sqlite3":
        rows = [(stamp_of(number), packed_at(number)) for number in range(COUNT)]
        write_tables(folder / "a_0.db3", [Table("/odom", ODOM.type_name, rows)])
    else:
        write_records(folder / "a_0.mcap", *chunk(*ODOMETRY, *drive(payload=packed_at)))
    name = "a_0.db3" if storage == "sqlite3" else "a_0.mcap"
    return write_metadata(folder, [name], {"/odom": (ODOM.type_name, COUNT)}, storage=storage, **packing)


LOSSY_ONES = (
    a_drive(
        "rows that are gone",
        rows_deleted,
        messages={"/odom": COUNT // 2},
        passes={"/odom": (9, 12)},
        said=[["100 messages", "50"]],
        is_quiet=False,
        is_whole=False,
    ),
    *in_both_storages(
        "a topic lost what another gained",
        partial(one_lost_and_one_gained, gained=40),
        ["/odom 140, 100 can be read", "/text 20, 60 can be read"],
        messages={"/odom": COUNT, "/text": 60},
    ),
    *in_both_storages(
        "a topic gained more than another lost",
        partial(one_lost_and_one_gained, gained=80),
        ["160 messages, 200 can be read", "/odom 140, 100 can be read", "/text 20, 100 can be read"],
        messages={"/odom": COUNT, "/text": 100},
    ),
    *in_both_storages(
        "a topic of another name",
        named_otherwise,
        ["/txt 20, 0 can be read"],
        messages={"/odom": COUNT, "/text": 20, "/txt": 0},
    ),
    *in_both_storages(
        "messages packed one by one",
        packed_one_by_one,
        ["/odom: 34 messages that could not be decompressed were left out"],
        messages={"/odom": 66},
        rates_hz={"/odom": 6.65},
        passes={"/odom": (36, 42)},
        is_readable_by_others=False,
    ),
    a_drive(
        "a file lost what another gained",
        one_file_lost_what_the_other_gained,
        said=[["a_0.mcap 50, 40 can be read", "a_1.mcap 50, 60 can be read"]],
        is_quiet=False,
        is_whole=False,
    ),
)

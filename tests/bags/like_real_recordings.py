# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as those that robots and tools of others left, made anew."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import ODOM, BagContent, BagMessage, write_bag
from bags.recorded_by_others import (
    COUNT,
    ODOMETRY,
    QOS_IN_NUMBERS,
    QOS_IN_WORDS,
    Table,
    channel,
    chunk,
    drive,
    message,
    odometry_at,
    packed,
    rosbag2_metadata,
    schema,
    stamp_of,
    text_at,
    write_metadata,
    write_records,
    write_tables,
)
from bags.recording_case import Case, a_drive

STRING = "std_msgs/msg/String"


def merged_by_a_tool(folder: Path) -> Path:
    """One chunk with all schemas and channels within, of numbers with gaps; sent before it was recorded."""
    path, text = schema(2, "geometry_msgs/msg/PoseWithCovarianceStamped"), schema(3, "tf2_msgs/msg/TFMessage")
    described = (
        schema(1, ODOM.type_name),
        path,
        text,
        channel(6, "/odom", 1, qos=QOS_IN_WORDS),
        channel(24, "/amcl_pose", 2),
        channel(13, "/tf_static", 3),
    )
    messages = [message(number, odometry_at(number), of=6, late_ns=3_000_000) for number in range(COUNT)]
    return write_records(
        folder / "drive.mcap", *chunk(*described, *messages, frames=1), described=described, library="mcap go"
    )


def by_rosbag2(folder: Path) -> Path:
    """A chunk that is not compressed between two notes of rosbag2, and a topic that never came."""
    described = (*ODOMETRY, schema(2, STRING), channel(2, "/chatter", 2, qos=QOS_IN_NUMBERS))
    write_records(
        folder / "drive_0.mcap",
        rosbag2_metadata(8),
        *chunk(*described, *drive()),
        rosbag2_metadata(8),
        described=described,
    )
    topics = {"/odom": (ODOM.type_name, COUNT), "/chatter": (STRING, 0)}
    return write_metadata(folder, ["drive_0.mcap"], topics, version=8)


def from_stamp_zero(folder: Path) -> Path:
    """Converted from SQLite: relative names, no text of an empty type, stamps from 0, some of them equal."""
    described = (
        schema(1, "test_msgs/msg/Empty", text=""),
        channel(1, "a_empty", 1),
        schema(2, STRING),
        channel(2, "b_text", 2),
    )
    messages = [
        message(0, payload, of=of, log_ns=number * 10_000_000)
        for number in range(50)
        for of, payload in ((1, packed("B", 0)), (2, text_at(number)))
    ]
    write_records(
        folder / "a_0.mcap",
        *chunk(*described, *messages, frames=1),
        described=described,
        counts_stamp_0=False,
        library="mcap go",
    )
    return write_metadata(
        folder, ["a_0.mcap"], {"a_empty": ("test_msgs/msg/Empty", 50), "b_text": (STRING, 50)}
    )


NAMES = ("AAA", "BBB", "CCC")


def split_with_equal_stamps(folder: Path, storage: str) -> Path:
    """Five files within 2 us: stamps of 1 ns apart, many equal, and topics in another order in each file."""
    files = []
    for part in range(5):
        names = NAMES[part % 3 :] + NAMES[: part % 3]
        stamps = [1000 + part * 400 + number // 2 for number in range(200)]
        suffix = "db3" if storage == "sqlite3" else "mcap"
        path = folder / f"wbag_{part}.{suffix}"
        files.append(path.name)
        if storage == "sqlite3":
            write_tables(
                path, [Table(name, STRING, [(one, text_at(one)) for one in stamps]) for name in names]
            )
            continue
        described = [schema(number, STRING) for number in (1, 2, 3)]
        channels = [channel(number, name, number) for number, name in enumerate(names, start=1)]
        messages = [message(0, text_at(one), of=of, log_ns=one) for one in stamps for of in (1, 2, 3)]
        both = [*described, *channels]
        write_records(path, *chunk(*both, *messages, frames=1), described=both)
    topics = dict.fromkeys(NAMES, (STRING, 1000))
    return write_metadata(folder, files, topics, storage=storage, version=5)


def without_metadata(folder: Path, storage: str) -> Path:
    for part in range(3):
        path = folder / f"lost_{part}.{'db3' if storage == 'sqlite3' else 'mcap'}"
        numbers = (
            [*range(COUNT)][part::3]
            if storage == "sqlite3"
            else range(part * 33, part * 33 + 33 + (part == 2))
        )
        if storage == "sqlite3":
            numbers = range(part * 33, part * 33 + 33 + (part == 2))
            write_tables(
                path, [Table("/odom", ODOM.type_name, [(stamp_of(n), odometry_at(n)) for n in numbers])]
            )
        else:
            write_records(path, *chunk(*ODOMETRY, *drive(numbers), frames=1))
    return folder


def by_foxy(folder: Path) -> Path:
    """Two tables, an empty log beside them, and metadata of version 2, which names no QoS."""
    rows = [(stamp_of(number), odometry_at(number)) for number in range(COUNT)]
    tables = [Table("/odom", ODOM.type_name, rows), Table("/rosout", "rcl_interfaces/msg/Log", [])]
    path = write_tables(folder / "drive_0.db3", tables)
    path.with_name("drive_0.db3-wal").touch()
    path.with_name("drive_0.db3-shm").write_bytes(bytes(32768))
    write_metadata(
        folder,
        [f"{folder.name}/drive_0.db3"],
        {"/odom": (ODOM.type_name, COUNT), "/rosout": ("rcl_interfaces/msg/Log", 0)},
        storage="sqlite3",
        version=2,
    )
    meta = folder / "metadata.yaml"
    lines = meta.read_text().splitlines(keepends=True)
    meta.write_text("".join(line for line in lines if "offered_qos" not in line))
    return folder


def by_rolling(folder: Path) -> Path:
    rows = [(stamp_of(number), odometry_at(number)) for number in range(COUNT)]
    return write_tables(
        folder / "drive_0.db3",
        [Table("/odom", ODOM.type_name, rows, qos=QOS_IN_NUMBERS)],
        distribution="rolling",
    )


def of_another_format(folder: Path) -> Path:
    """Serialized by a middleware that does not write CDR."""
    described = (*ODOMETRY, schema(2, STRING), channel(2, "/chatter", 2, encoding="wrong_format"))
    messages = drive(payload=lambda _: b"???", of=2)
    return write_records(
        folder / "drive.mcap",
        *chunk(*described, *drive(), *messages),
        described=described,
    )


def of_rosbags(folder: Path) -> Path:
    content = BagContent(
        (ODOM,), tuple(BagMessage("/odom", stamp_of(number), odometry_at(number)) for number in range(COUNT))
    )
    return write_bag(folder / "drive", content, storage=StoragePlugin.MCAP)


LIKE_REAL_ONES = (
    a_drive("rosbags", of_rosbags),
    a_drive(
        "merged by a tool",
        merged_by_a_tool,
        messages={"/odom": COUNT, "/amcl_pose": 0, "/tf_static": 0},
    ),
    a_drive("rosbag2 in MCAP", by_rosbag2, messages={"/odom": COUNT, "/chatter": 0}),
    a_drive("Foxy", by_foxy, messages={"/odom": COUNT, "/rosout": 0}),
    a_drive("Rolling in SQLite", by_rolling),
    *(
        a_drive(
            f"no metadata, {storage}",
            partial(without_metadata, storage=storage),
            said=[["metadata.yaml is missing"]],
            is_quiet=False,
        )
        for storage in ("mcap", "sqlite3")
    ),
    *(
        Case(
            name=f"equal stamps in five files, {storage}",
            make=partial(split_with_equal_stamps, storage=storage),
            messages=dict.fromkeys(NAMES, 1000),
            rules="begin\nSetFrequency /AAA Full\nend\n",
        )
        for storage in ("mcap", "sqlite3")
    ),
    Case(
        name="stamps from 0",
        make=from_stamp_zero,
        messages={"a_empty": 50, "b_text": 50},
        duration_s=0.49,
        rates_hz={"a_empty": 100, "b_text": 100},
        rules="begin\nSetFrequency /b_text Full\nend\n",
        is_quiet=False,
    ),
    a_drive(
        "another serialization",
        of_another_format,
        messages={"/odom": COUNT, "/chatter": COUNT},
        rates_hz={"/odom": 10, "/chatter": 10},
        left_out={"/chatter": "wrong_format"},
        said=[["/chatter", "wrong_format"]],
        is_quiet=False,
    ),
)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as other tools write them: MCAP by its records, .db3 by its tables, metadata.yaml by hand."""

from __future__ import annotations

import dataclasses
import sqlite3
import struct
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    Schema,
    Statistics,
)
from mcap.stream_reader import StreamReader
from ruamel.yaml import YAML

from bags.bag_factory import ODOM, START_NS, TYPES, cdr, message_of

MAGIC = b"\x89MCAP0\r\n"
PERIOD_NS = 100_000_000
COUNT = 100
"""Messages of a topic that comes at 10 Hz for ten seconds."""
QOS_IN_NUMBERS = """\
- history: 3
  depth: 0
  reliability: 1
  durability: 2
  deadline: {sec: 0, nsec: 0}
  lifespan: {sec: 0, nsec: 0}
  liveliness: 1
  liveliness_lease_duration: {sec: 0, nsec: 0}
  avoid_ros_namespace_conventions: false"""

QOS_IN_WORDS = """\
- history: keep_last
  depth: 10
  reliability: reliable
  durability: volatile
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: automatic
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false"""


def stamp_of(number: int) -> int:
    return START_NS + number * PERIOD_NS


def odometry_at(number: int, *, x: float | None = None, header_ns: int | None = None) -> bytes:
    """An Odometry of a robot that is 10 cm further on with each message."""
    message = message_of(ODOM.type_name, child_frame_id="base_link")
    sec, nanosec = divmod(stamp_of(number) if header_ns is None else header_ns, 1_000_000_000)
    message.header.stamp.sec, message.header.stamp.nanosec = sec, nanosec
    message.header.frame_id = "odom"
    message.pose.pose.position.x = number / 10 if x is None else x
    message.pose.pose.orientation.w = 1.0
    return cdr(ODOM.type_name, message)


def text_at(number: int) -> bytes:
    return cdr("std_msgs/msg/String", message_of("std_msgs/msg/String", data=f"Hello {number}"))


def packed(layout: str, *values: object) -> bytes:
    """CDR of fields without texts, which ``layout`` aligns by itself."""
    return b"\0\1\0\0" + struct.pack(f"<{layout}", *values)


def schema(number: int, type_name: str, *, encoding: str = "ros2msg", text: str | None = None) -> Schema:
    if text is None:
        text, _ = TYPES.generate_msgdef(type_name, ros_version=2)
    return Schema(id=number, name=type_name, encoding=encoding, data=text.encode())


def channel(number: int, topic: str, schema_id: int, *, encoding: str = "cdr", qos: str = "") -> Channel:
    metadata = {"offered_qos_profiles": qos}
    return Channel(id=number, topic=topic, message_encoding=encoding, metadata=metadata, schema_id=schema_id)


def message(
    number: int, payload: bytes, *, of: int = 1, log_ns: int | None = None, late_ns: int = 0
) -> Message:
    log_ns = stamp_of(number) if log_ns is None else log_ns
    return Message(
        channel_id=of, log_time=log_ns, publish_time=max(log_ns - late_ns, 0), sequence=0, data=payload
    )


def drive(
    numbers: Iterable[int] = range(COUNT), *, payload: Callable[[int], bytes] = odometry_at, of: int = 1
) -> list[Message]:
    return [message(number, payload(number), of=of) for number in numbers]


ODOMETRY = (schema(1, ODOM.type_name), channel(1, ODOM.name, 1))


def written(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for one in records:
        one.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


def chunk(*records: McapRecord, frames: int = 0, has_checksum: bool = True) -> list[McapRecord]:
    """The records in one chunk, and an index of each channel in it.

    It is compressed as so many zstd frames, and not at all where that is 0.
    """
    data, places = bytearray(), dict[int, list[tuple[int, int]]]()
    for one in records:
        if isinstance(one, Message):
            places.setdefault(one.channel_id, []).append((one.log_time, len(data)))
        data += written(one)
    stamps = [one.log_time for one in records if isinstance(one, Message)]
    size = -(-len(data) // (frames or 1))
    pieces = [bytes(data[at : at + size]) for at in range(0, len(data), size)]
    whole = Chunk(
        compression="zstd" if frames else "",
        data=b"".join(map(zstandard.compress, pieces)) if frames else bytes(data),
        message_start_time=min(stamps, default=0),
        message_end_time=max(stamps, default=0),
        uncompressed_crc=zlib.crc32(data) if has_checksum else 0,
        uncompressed_size=len(data),
    )
    return [whole, *(MessageIndex(channel_id=of, records=at) for of, at in places.items())]


def write_records(
    path: Path,
    *records: McapRecord,
    described: Sequence[McapRecord] = ODOMETRY,
    is_closed: bool = True,
    counts_channels: bool = True,
    counts_stamp_0: bool = True,
    library: str = "libmcap 1.1.0",
) -> Path:
    """An MCAP file of these records; its summary has ``described``, an index of each chunk and the counts."""
    data = bytearray(MAGIC + written(Header(profile="ros2", library=library)))
    indexes: list[ChunkIndex] = []
    stamps: dict[int, list[int]] = {}
    for one in records:
        start = len(data)
        data += written(one)
        if isinstance(one, Chunk):
            indexes.append(_index_of(one, start, len(data) - start))
        elif isinstance(one, MessageIndex):
            indexes[-1].message_index_offsets[one.channel_id] = start
            indexes[-1].message_index_length += len(data) - start
            stamps.setdefault(one.channel_id, []).extend(stamp_ns for stamp_ns, _ in one.records)
        elif isinstance(one, Message):
            stamps.setdefault(one.channel_id, []).append(one.log_time)
    if is_closed:
        data += written(DataEnd(data_section_crc=0))
        summary_start = len(data)
        data += written(
            *described,
            *indexes,
            _statistics(
                described,
                len(indexes),
                stamps,
                counts_channels=counts_channels,
                counts_stamp_0=counts_stamp_0,
            ),
        )
        data += written(Footer(summary_start=summary_start, summary_offset_start=0, summary_crc=0)) + MAGIC
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    return path


def _index_of(one: Chunk, start: int, length: int) -> ChunkIndex:
    return ChunkIndex(
        chunk_length=length,
        chunk_start_offset=start,
        compression=one.compression,
        compressed_size=len(one.data),
        message_end_time=one.message_end_time,
        message_index_length=0,
        message_index_offsets={},
        message_start_time=one.message_start_time,
        uncompressed_size=one.uncompressed_size,
    )


def _statistics(
    described: Sequence[McapRecord],
    chunks: int,
    stamps: Mapping[int, Sequence[int]],
    *,
    counts_channels: bool,
    counts_stamp_0: bool,
) -> Statistics:
    every = [one for of_channel in stamps.values() for one in of_channel]
    return Statistics(
        attachment_count=0,
        channel_count=sum(isinstance(one, Channel) for one in described),
        channel_message_counts={of: len(found) for of, found in stamps.items() if counts_channels},
        chunk_count=chunks,
        message_count=len(every),
        message_end_time=max(every, default=0),
        message_start_time=min((one for one in every if one or counts_stamp_0), default=0),
        metadata_count=0,
        schema_count=sum(isinstance(one, Schema) for one in described),
    )


def rosbag2_metadata(version: int) -> Metadata:
    return Metadata(name="rosbag2", metadata={"serialized_metadata": f"version: {version}\n"})


@dataclasses.dataclass(frozen=True)
class Table:
    """What a row of ``topics`` and a message in ``messages`` say."""

    topic: str
    type_name: str
    payloads: Sequence[tuple[int, bytes]]
    serialization_format: str = "cdr"
    qos: str = ""


def write_tables(
    path: Path,
    tables: Sequence[Table],
    *,
    distribution: str = "foxy",
    definitions: Mapping[str, str] | None = None,
) -> Path:
    """A .db3 as Foxy writes it, with two tables; as Rolling does, with version 4 of the schema.

    ``definitions`` are those of types that ROS 2 has not.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    is_new = distribution != "foxy"
    with sqlite3.connect(path) as database:
        database.executescript(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
            "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL"
            f"{', type_description_hash TEXT NOT NULL' if is_new else ''});"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
            "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
            "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
        )
        if is_new:
            _describe(database, tables, distribution, definitions or {})
        for number, one in enumerate(tables, start=1):
            row = [number, one.topic, one.type_name, one.serialization_format, one.qos, *([""] * is_new)]
            database.execute(f"INSERT INTO topics VALUES ({', '.join('?' * len(row))})", row)
        rows = [
            (stamp_ns, number, payload)
            for number, one in enumerate(tables, start=1)
            for stamp_ns, payload in one.payloads
        ]
        database.executemany(
            "INSERT INTO messages (timestamp, topic_id, data) VALUES (?, ?, ?)", sorted(rows)
        )
    database.close()
    return path


def _describe(
    database: sqlite3.Connection, tables: Sequence[Table], distribution: str, definitions: Mapping[str, str]
) -> None:
    database.executescript(
        "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
        "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, "
        "metadata TEXT NOT NULL);"
        "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, "
        "encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, "
        "type_description_hash TEXT NOT NULL);"
    )
    database.execute("INSERT INTO schema VALUES (4, ?)", [distribution])
    for version in (8, 8):
        database.execute(
            "INSERT INTO metadata (metadata_version, metadata) VALUES (?, 'version: 8')", [version]
        )
    for type_name in dict.fromkeys(one.type_name.removesuffix("_Event") for one in tables):
        text = definitions.get(type_name) or TYPES.generate_msgdef(type_name, ros_version=2)[0]
        database.execute(
            "INSERT INTO message_definitions (topic_type, encoding, encoded_message_definition, "
            "type_description_hash) VALUES (?, 'ros2msg', ?, '')",
            [type_name, text],
        )


def write_metadata(
    folder: Path,
    names: Sequence[str],
    topics: Mapping[str, tuple[str, int]],
    *,
    storage: str = "mcap",
    version: int = 4,
    **more: Any,
) -> Path:
    """metadata.yaml of the files ``names``, with the type and the messages of each topic."""
    total = sum(count for _, count in topics.values())
    information: dict[str, Any] = {
        "version": version,
        "storage_identifier": storage,
        "relative_file_paths": list(names),
        "duration": {"nanoseconds": PERIOD_NS * (COUNT - 1)},
        "starting_time": {"nanoseconds_since_epoch": START_NS},
        "message_count": total,
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": topic,
                    "type": type_name,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": "",
                },
                "message_count": count,
            }
            for topic, (type_name, count) in topics.items()
        ],
        "compression_format": "",
        "compression_mode": "",
        **more,
    }
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "metadata.yaml").open("w") as file:
        yaml = YAML(typ="safe")
        yaml.default_flow_style = False
        yaml.dump({"rosbag2_bagfile_information": information}, file)
    return folder


def plain_counts(path: Path) -> Counter[str]:
    """The messages of each topic that mcap and SQLite find in the file, or in all files of the folder."""
    files = [path] if path.is_file() else [one for one in path.rglob("*") if one.suffix in {".mcap", ".db3"}]
    found: Counter[str] = Counter()
    for one in files:
        found.update(_counts_of_mcap(one) if one.suffix == ".mcap" else _counts_of_tables(one))
    return found


def _counts_of_mcap(path: Path) -> Counter[str]:
    topics: dict[int, str] = {}
    found: Counter[str] = Counter()
    with path.open("rb") as file:
        for one in StreamReader(file).records:
            if isinstance(one, Channel):
                topics[one.id] = one.topic
            elif isinstance(one, Message):
                found[topics[one.channel_id]] += 1
    return found


def _counts_of_tables(path: Path) -> Counter[str]:
    with sqlite3.connect(f"{path.as_uri()}?immutable=1", uri=True) as database:
        rows = database.execute(
            "SELECT name, count(*) FROM messages JOIN topics ON topics.id = topic_id GROUP BY name"
        ).fetchall()
    database.close()
    return Counter(dict(rows))

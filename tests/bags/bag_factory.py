# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Small bags of every kind, written with rosbags, mcap and plain SQL."""

from __future__ import annotations

import itertools
import shutil
import sqlite3
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapFileWriter
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from ruamel.yaml import YAML

START_NS = 1_700_000_000_000_000_000
FOREVER = QosTime(9223372036, 854775807)
CUSTOM_TYPE = "robot_msgs/msg/Gripper"
CUSTOM_DEFINITION = "float64 opening\nbool holds\n"
KINDS = [
    *itertools.product(StoragePlugin, (CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE)),
    (StoragePlugin.MCAP, CompressionMode.STORAGE),
]
"""Each way of storing a bag, with each compression that it has."""
TYPES = get_typestore(Stores.ROS2_HUMBLE)
TYPES.register(get_types_from_msg(CUSTOM_DEFINITION, CUSTOM_TYPE))


def qos(
    *,
    durability: QosDurability = QosDurability.VOLATILE,
    reliability: QosReliability = QosReliability.RELIABLE,
) -> Qos:
    return Qos(
        QosHistory.KEEP_LAST,
        10,
        reliability,
        durability,
        FOREVER,
        FOREVER,
        QosLiveliness.AUTOMATIC,
        FOREVER,
        False,
    )


LATCHED = qos(durability=QosDurability.TRANSIENT_LOCAL)
BEST_EFFORT = qos(reliability=QosReliability.BEST_EFFORT)


@dataclass(frozen=True)
class BagTopic:
    name: str
    type_name: str
    qos: tuple[Qos, ...] = ()


@dataclass(frozen=True)
class BagMessage:
    topic: str
    stamp_ns: int
    payload: bytes


@dataclass(frozen=True)
class BagContent:
    topics: tuple[BagTopic, ...]
    messages: tuple[BagMessage, ...] = field(default=())

    def between(self, first: int, last: int | None) -> BagContent:
        return BagContent(self.topics, self.messages[first:last])


ODOM = BagTopic("/odom", "nav_msgs/msg/Odometry", (qos(),))
AMCL = BagTopic("/amcl_pose", "geometry_msgs/msg/PoseWithCovarianceStamped", (qos(),))
SCAN = BagTopic("/scan", "sensor_msgs/msg/LaserScan", (BEST_EFFORT,))
IMAGE = BagTopic("/image", "sensor_msgs/msg/Image", (BEST_EFFORT,))
GRIPPER = BagTopic("/gripper", CUSTOM_TYPE, (qos(),))
MAP_NAME = BagTopic("/map_name", "std_msgs/msg/String", (LATCHED,))


def message_of(type_name: str, **fields: Any) -> Any:
    """A message whose fields are zero or empty where ``fields`` do not say otherwise."""
    definition = TYPES.get_msgdef(type_name)
    values = {name: fields.get(name, _zero(kind)) for name, kind in definition.fields}
    return TYPES.types[type_name](**values)


def _zero(kind: Any) -> Any:
    node, of = int(kind[0]), kind[1]
    if node == 1:
        return {"string": "", "bool": False}.get(of[0], 0.0 if of[0].startswith("float") else 0)
    if node == 2:
        return message_of(of)
    element, count = of
    if int(element[0]) == 1 and element[1][0] != "string":
        return np.zeros(count if node == 3 else 0, dtype=np.dtype(element[1][0].replace("octet", "uint8")))
    return [_zero(element) for _ in range(count)] if node == 3 else []


def cdr(type_name: str, message: Any) -> bytes:
    return bytes(TYPES.serialize_cdr(message, type_name, little_endian=True))


def odometry(x: float, y: float, *, speed: float = 0.0) -> bytes:
    message = message_of(ODOM.type_name)
    message.pose.pose.position.x, message.pose.pose.position.y = x, y
    message.twist.twist.linear.x = speed
    return cdr(ODOM.type_name, message)


def localized_mission() -> BagContent:
    """As ``small_mission``, of a robot that started at (9.6, 0) of its map and says so on /amcl_pose."""
    mission = small_mission()
    messages = []
    for i in range(8):
        pose = message_of(AMCL.type_name)
        pose.header.frame_id = "map"
        pose.pose.pose.position.x, pose.pose.pose.position.y = 9.6, i / 2
        stamp_ns = START_NS + i * 500_000_000 + 1
        messages.append(BagMessage(AMCL.name, stamp_ns, cdr(AMCL.type_name, pose)))
    ordered = sorted((*mission.messages, *messages), key=lambda message: message.stamp_ns)
    return BagContent((*mission.topics, AMCL), tuple(ordered))


def small_mission(seconds: float = 4.0) -> BagContent:
    """1 m/s along y: odometry 25 Hz; scans, images of 9 KB and a gripper at 5 Hz; a latched map name."""
    messages = [
        BagMessage(
            MAP_NAME.name, START_NS + 1, cdr(MAP_NAME.type_name, message_of(MAP_NAME.type_name, data="hall"))
        )
    ]
    messages += [
        BagMessage(ODOM.name, START_NS + i * 40_000_000, odometry(0.0, i / 25))
        for i in range(int(25 * seconds))
    ]
    for i in range(int(5 * seconds)):
        stamp_ns = START_NS + i * 200_000_000 + 7_000_000
        scan = message_of(
            SCAN.type_name, range_min=0.1, range_max=9.0, ranges=np.array([1 + i], dtype=np.float32)
        )
        image = message_of(IMAGE.type_name, data=np.full(9000, i % 256, dtype=np.uint8), height=i)
        gripper = message_of(CUSTOM_TYPE, opening=float(i), holds=True)
        messages += [
            BagMessage(SCAN.name, stamp_ns, cdr(SCAN.type_name, scan)),
            BagMessage(IMAGE.name, stamp_ns + 1, cdr(IMAGE.type_name, image)),
            BagMessage(GRIPPER.name, stamp_ns + 2, cdr(CUSTOM_TYPE, gripper)),
        ]
    messages.sort(key=lambda message: message.stamp_ns)
    return BagContent((ODOM, SCAN, IMAGE, GRIPPER, MAP_NAME), tuple(messages))


def write_bag(
    folder: Path,
    content: BagContent,
    *,
    storage: StoragePlugin = StoragePlugin.SQLITE3,
    compression: CompressionMode = CompressionMode.NONE,
    version: int = 8,
    custom_data: dict[str, str] | None = None,
) -> Path:
    """A bag of one file, by rosbags."""
    writer = Writer(folder, version=version, storage_plugin=storage)  # type: ignore[arg-type]
    writer.set_compression(compression, CompressionFormat.ZSTD)
    for key, value in (custom_data or {}).items():
        writer.set_custom_data(key, value)
    with writer:
        connections = {
            topic.name: writer.add_connection(
                topic.name, topic.type_name, typestore=TYPES, offered_qos_profiles=topic.qos
            )
            for topic in content.topics
        }
        for message in content.messages:
            writer.write(connections[message.topic], message.stamp_ns, message.payload)
    return folder


TOPICS_COUNTED = "topics_with_message_count"


def write_split_bag(folder: Path, parts: Sequence[BagContent], **options: Any) -> Path:
    """A bag of several files, as rosbag2 splits one."""
    folder.mkdir(parents=True)
    merged: dict[str, Any] = {}
    for number, part in enumerate(parts):
        piece = write_bag(folder / f"{folder.name}_{number}", part, **options)
        information = read_yaml(piece / "metadata.yaml")["rosbag2_bagfile_information"]
        for name in information["relative_file_paths"]:
            shutil.move(piece / name, folder / name)
        shutil.rmtree(piece)
        for entry in information["topics_with_message_count"] if merged else ():
            known = merged["topics_with_message_count"]
            same = [one for one in known if one["topic_metadata"] == entry["topic_metadata"]]
            if same:
                same[0]["message_count"] += entry["message_count"]
            else:
                known.append(entry)
        merged = merged or {**information, "relative_file_paths": [], "message_count": 0}
        merged["message_count"] += information["message_count"]
        merged["relative_file_paths"] += information["relative_file_paths"]
    with (folder / "metadata.yaml").open("w") as file:
        YAML(typ="safe").dump({"rosbag2_bagfile_information": merged}, file)
    return folder


def read_yaml(path: Path) -> Any:
    return YAML(typ="safe").load(path.read_text())


def write_humble_file(path: Path, content: BagContent) -> Path:
    """A .db3 file as Humble writes it: no definitions, no hashes."""
    with sqlite3.connect(path) as database:
        database.executescript(
            """
            CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
            CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL,
                metadata TEXT NOT NULL);
            CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
            CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
                timestamp INTEGER NOT NULL, data BLOB NOT NULL);
            CREATE INDEX timestamp_idx ON messages (timestamp ASC);
            INSERT INTO schema VALUES (3, 'humble');
            """
        )
        numbers = {topic.name: number for number, topic in enumerate(content.topics, start=1)}
        for topic in content.topics:
            row = (numbers[topic.name], topic.name, topic.type_name, "cdr", "")
            database.execute("INSERT INTO topics VALUES (?, ?, ?, ?, ?)", row)
        for message in content.messages:
            stored = (numbers[message.topic], message.stamp_ns, message.payload)
            database.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", stored)
    database.close()
    return path


def write_mcap_file(
    path: Path,
    content: BagContent,
    *,
    compression: CompressionType = CompressionType.ZSTD,
    chunk_size: int = 20_000,
    use_chunking: bool = True,
    index_types: IndexType = IndexType.ALL,
    repeat_channels: bool = True,
) -> Path:
    """An .mcap file by mcap's own writer; messages in the order of ``content``."""
    with path.open("wb") as file:
        writer = McapFileWriter(
            file,
            chunk_size=chunk_size,
            compression=compression,
            use_chunking=use_chunking,
            index_types=index_types,
            repeat_channels=repeat_channels,
        )
        writer.start(profile="ros2", library="test")
        channels = {}
        for topic in content.topics:
            definition, _ = TYPES.generate_msgdef(topic.type_name, ros_version=2)
            schema = writer.register_schema(topic.type_name, "ros2msg", definition.encode())
            channels[topic.name] = writer.register_channel(topic.name, "cdr", schema)
        for message in content.messages:
            writer.add_message(channels[message.topic], message.stamp_ns, message.payload, message.stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def write_pairs(path: Path, definitions: Sequence[str]) -> Path:
    """A recording in which each message of a topic comes with the next of ``definitions``, and a is 1."""
    with path.open("wb") as file:
        writer = McapFileWriter(file)
        writer.start(profile="ros2", library="test")
        for at, definition in enumerate(definitions):
            schema = writer.register_schema("my_msgs/msg/Pair", "ros2msg", definition.encode())
            channel = writer.register_channel("/pair", "cdr", schema)
            numbers = (1.0, 2.0) if definition.startswith("float64 a") else (2.0, 1.0)
            payload = b"\x00\x01\x00\x00" + struct.pack("<2d", *numbers)
            writer.add_message(channel, START_NS + at, payload, START_NS + at)
        writer.finish()  # type: ignore[no-untyped-call]
    return path

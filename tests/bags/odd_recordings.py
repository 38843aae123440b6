# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings with something odd: a layout, a name, a place, a definition, a value or a stamp."""

from __future__ import annotations

import json
import struct
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bags.bag_factory import ODOM, START_NS, TYPES, cdr, message_of
from bags.odd_definitions import DEFINITIONS, LEVEL, SEPARATOR
from bags.recorded_by_others import (
    COUNT,
    ODOMETRY,
    QOS_IN_WORDS,
    Table,
    channel,
    chunk,
    drive,
    message,
    odometry_at,
    packed,
    schema,
    stamp_of,
    write_metadata,
    write_records,
    write_tables,
)
from bags.recording_case import Case, a_drive, far

# Layouts


def in_two_places(folder: Path) -> Path:
    """Half of the messages in a chunk, the others beside it: both are promised by the summary."""
    return write_records(
        folder / "a.mcap", *chunk(*ODOMETRY, *drive(range(50)), frames=1), *drive(range(50, COUNT))
    )


def in_frames(folder: Path, *, frames: int) -> Path:
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *drive(), frames=frames))


def without_counts_of_channels(folder: Path) -> Path:
    """The summary says how many messages there are, and not of which channel, as the format allows."""
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *drive()), counts_channels=False)


def without_summary(folder: Path) -> Path:
    return write_records(folder / "a.mcap", *ODOMETRY, *drive(), is_closed=False)


def channels_first(folder: Path) -> Path:
    """Cut by a crash, in a file whose channels stand before their schemas."""
    odometry, topic = ODOMETRY
    return write_records(folder / "a.mcap", topic, odometry, *drive(), is_closed=False)


def announced_as_another_type(folder: Path) -> Path:
    described = (schema(2, "geometry_msgs/msg/PoseStamped"), channel(2, "/odom", 2), *ODOMETRY)
    return write_records(folder / "a.mcap", *chunk(*described, *drive()), described=described)


LAYOUTS = (
    a_drive("no counts by channel", without_counts_of_channels),
    a_drive("messages in and beside a chunk", in_two_places),
    a_drive("a chunk of three zstd frames", partial(in_frames, frames=3), is_readable_by_others=False),
    a_drive(
        "channels before schemas, cut",
        channels_first,
        is_quiet=False,
        is_whole=False,
        is_readable_by_others=False,
    ),
    a_drive("cut", without_summary, is_quiet=False, is_whole=False, is_readable_by_others=False),
    a_drive(
        "another type is announced",
        announced_as_another_type,
        said=[["/odom", "geometry_msgs/msg/PoseStamped"]],
        is_quiet=False,
    ),
)


# Types and definitions


def grown_between_files(folder: Path) -> Path:
    """From the second file on, the message has a field before the one that rules read."""
    for part, text in enumerate(("float64 level\n", "float64 volt\nfloat64 level\n")):
        described = (schema(1, LEVEL, text=text), channel(1, "/level", 1))
        numbers = range(part * 50, part * 50 + 50)
        messages = [
            message(number, packed("d" * (part + 1), *[12] * part, number / 10)) for number in numbers
        ]
        write_records(folder / f"a_{part}.mcap", *chunk(*described, *messages), described=described)
    return write_metadata(folder, ["a_0.mcap", "a_1.mcap"], {"/level": (LEVEL, COUNT)})


def named(folder: Path, *, type_name: str) -> Path:
    text, _ = TYPES.generate_msgdef(ODOM.type_name, ros_version=2)
    short = schema(1, type_name, text=text.replace("/msg/", "/"))
    described = (short, channel(1, "/odom", 1))
    return write_records(folder / "a.mcap", *chunk(*described, *drive()), described=described)


TYPES_OF_OTHERS = (
    a_drive("nav_msgs/Odometry", partial(named, type_name="nav_msgs/Odometry")),
    a_drive("a name of DDS", partial(named, type_name="nav_msgs::msg::dds_::Odometry_")),
    Case(
        name="a field more in the second file",
        make=grown_between_files,
        messages={"/level": COUNT},
        rates_hz={"/level": 10},
        curves={"/level": "level"},
        rules=far("/level", "msg.level"),
        passes={"/level": (53, 62)},
        is_quiet=False,
    ),
)


def encodings_mixed(folder: Path) -> Path:
    """CDR, JSON, protobuf and ROS 1 in one file."""
    fix = b'{"type": "object", "properties": {"lat": {"type": "number"}}}'.decode()
    described = (
        *ODOMETRY,
        schema(2, "fix", encoding="jsonschema", text=fix),
        channel(2, "/fix", 2, encoding="json"),
        schema(3, "foxglove.SceneUpdate", encoding="protobuf", text="\n\x10"),
        channel(3, "/scene", 3, encoding="protobuf"),
        schema(4, "std_msgs/msg/Float64", encoding="ros1msg", text="float64 data\n"),
        channel(4, "/old", 4, encoding="ros1"),
    )
    messages = [
        *drive(),
        *drive(payload=lambda number: json.dumps({"lat": number}).encode(), of=2),
        *drive(payload=lambda _: b"\x0a\x03abc", of=3),
        *drive(payload=lambda number: struct.pack("<d", number), of=4),
    ]
    return write_records(folder / "a.mcap", *chunk(*described, *messages), described=described)


EVENT = "example_interfaces/srv/AddTwoInts_Event"
SERVICE = "int64 a\nint64 b\n---\nint64 sum\n"


def event_at(number: int) -> bytes:
    """What both ends of a service tell of a call; its request is within."""
    return packed("B3xiI16B4xqI4xqqI4x", number % 4, number, 0, *[7] * 16, number, 1, 2, 3, 0)


def service_events(folder: Path) -> Path:
    """Rosbag2 stores the text of the service for its events."""
    described = (*ODOMETRY, schema(2, EVENT, text=SERVICE), channel(2, "/add/_service_event", 2))
    messages = [*drive(), *drive(payload=event_at, of=2)]
    return write_records(folder / "a.mcap", *chunk(*described, *messages), described=described)


def service_events_in_tables(folder: Path) -> Path:
    """There the text stands under the name of the service."""
    numbers = range(COUNT)
    tables = [
        Table("/odom", ODOM.type_name, [(stamp_of(number), odometry_at(number)) for number in numbers]),
        Table("/add/_service_event", EVENT, [(stamp_of(number), event_at(number)) for number in numbers]),
    ]
    service = {EVENT.removesuffix("_Event"): SERVICE}
    return write_tables(folder / "a.db3", tables, distribution="rolling", definitions=service)


def undefined(folder: Path) -> Path:
    rows = [(stamp_of(number), packed("d", number)) for number in range(COUNT)]
    return write_tables(folder / "a.db3", [Table("/own", "own_msgs/msg/Own", rows)])


def encapsulated(folder: Path, *, kind: int) -> Path:
    """Serialized otherwise than plain CDR, which the first bytes of each message say."""
    messages = drive(payload=lambda number: bytes([0, kind]) + odometry_at(number)[2:])
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *messages))


def described_without_messages(folder: Path) -> Path:
    """A topic that nobody can decode, of which no message came."""
    described = (*ODOMETRY, schema(2, "own/msg/X", encoding="jsonschema", text="{}"))
    topic = channel(2, "/own", 2, encoding="json")
    return write_records(
        folder / "a.mcap", *chunk(*described, topic, *drive()), described=(*described, topic)
    )


UNDECODABLE = (
    *(
        a_drive(
            f"encapsulation {kind}",
            partial(encapsulated, kind=kind),
            curves={},
            passes={"/odom": (COUNT, COUNT)},
            findings=frozenset({"never-a-number"}),
            also_said={
                command: [["/odom", word, f"encapsulation 00 {kind:02x}"]]
                for command in ("loss", "replay", "check")
            },
        )
        for kind, word in ((3, "parameter lists"), (7, "XCDR2"), (11, "XCDR2"), (99, "no known format"))
    ),
    a_drive(
        "an undecodable topic without messages",
        described_without_messages,
        messages={"/odom": COUNT, "/own": 0},
        is_quiet=False,
    ),
    a_drive(
        "CDR, JSON, protobuf and ROS 1",
        encodings_mixed,
        messages=dict.fromkeys(("/odom", "/fix", "/scene", "/old"), COUNT),
        rates_hz=dict.fromkeys(("/odom", "/fix", "/scene", "/old"), 10),
        left_out={"/fix": "json", "/scene": "protobuf", "/old": "ros1"},
        said=[["/fix", "json"], ["/scene", "protobuf"], ["/old", "ros1"]],
        is_quiet=False,
    ),
    *(
        a_drive(
            f"events of a service in {storage}",
            make,
            messages={"/odom": COUNT, "/add/_service_event": COUNT},
            curves={"/odom": "pose_x", "/add/_service_event": "info.event_type"},
        )
        for storage, make in (("MCAP", service_events), ("SQLite", service_events_in_tables))
    ),
    Case(
        name="a type that nobody defines",
        make=undefined,
        messages={"/own": COUNT},
        rates_hz={"/own": 10},
        left_out={"/own": "own_msgs/msg/Own"},
        rules="begin\nSetFrequency /own 1\nend\n",
        passes={"/own": (9, 12)},
        said=[["/own", "defines own_msgs/msg/Own"]],
        is_quiet=False,
    ),
)


# Places


def in_a_subfolder(folder: Path) -> Path:
    write_records(folder / "splits" / "a_0.mcap", *chunk(*ODOMETRY, *drive()))
    return write_metadata(folder, ["splits/a_0.mcap"], {"/odom": (ODOM.type_name, COUNT)})


def beside_the_folder(folder: Path) -> Path:
    for part in range(2):
        numbers = range(part * 50, part * 50 + 50)
        write_records(folder / f"of_{part}" / "a.mcap", *chunk(*ODOMETRY, *drive(numbers)))
    files = ["../of_0/a.mcap", "../of_1/a.mcap"]
    return write_metadata(folder / "both", files, {"/odom": (ODOM.type_name, COUNT)})


def unpacked_since(folder: Path) -> Path:
    """metadata.yaml names the packed file, which somebody unpacked."""
    write_records(folder / "a_0.mcap", *chunk(*ODOMETRY, *drive()))
    packing: dict[str, Any] = {"compression_format": "zstd", "compression_mode": "FILE"}
    return write_metadata(folder, ["a_0.mcap.zstd"], {"/odom": (ODOM.type_name, COUNT)}, **packing)


def without_topics(folder: Path) -> Path:
    write_records(folder / "a_0.mcap", *chunk(*ODOMETRY, *drive()))
    return write_metadata(folder, ["a_0.mcap"], {})


def only_files(folder: Path) -> Path:
    write_records(folder / "a_0.mcap", *chunk(*ODOMETRY, *drive()))
    (folder / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
        "  relative_file_paths:\n    - a_0.mcap\n"
    )
    return folder


def qos_by_hand(folder: Path) -> Path:
    """One of the texts is none of QoS."""
    described = (*ODOMETRY, schema(2, "std_msgs/msg/String"), channel(2, "/text", 2, qos=QOS_IN_WORDS))
    write_records(folder / "a_0.mcap", *chunk(*described, *drive()), described=described)
    write_metadata(
        folder, ["a_0.mcap"], {"/odom": (ODOM.type_name, COUNT), "/text": ("std_msgs/msg/String", 0)}
    )
    meta = folder / "metadata.yaml"
    none, bad = "offered_qos_profiles: ''", "offered_qos_profiles: '- history: [3'"
    meta.write_text(meta.read_text().replace(none, bad, 1))
    return folder


PLACES = (
    a_drive("files in a subfolder", in_a_subfolder),
    a_drive("files beside the folder", beside_the_folder, is_readable_by_others=False),
    a_drive("unpacked since", unpacked_since),
    a_drive(
        "QoS by hand in metadata.yaml",
        qos_by_hand,
        messages={"/odom": COUNT, "/text": 0},
        said=[["/odom", "QoS"]],
        is_quiet=False,
    ),
    a_drive("no topics in metadata.yaml", without_topics),
    a_drive("only files in metadata.yaml", only_files),
)


# Values and stamps


def with_poses(folder: Path, *, odd: tuple[float, ...]) -> Path:
    at = {20 + place: value for place, value in enumerate(odd)}
    messages = drive(payload=lambda number: odometry_at(number, x=at.get(number)))
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *messages))


def before_the_clock(folder: Path) -> Path:
    """Three messages came before /clock, and have stamp 0."""
    early = [message(0, odometry_at(0, header_ns=0), log_ns=0) for _ in range(3)]
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *early, *drive()))


def of_another_clock(folder: Path) -> Path:
    """Headers have the time since the robot was switched on."""
    messages = drive(payload=lambda number: odometry_at(number, header_ns=stamp_of(number) - START_NS))
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *messages))


def beside_a_drive(folder: Path, *, type_name: str, fields: dict[str, object]) -> Path:
    described = (*ODOMETRY, schema(2, type_name), channel(2, "/sensor", 2))
    payload = cdr(type_name, message_of(type_name, **fields))
    messages = [*drive(), *drive(payload=lambda _: payload, of=2)]
    return write_records(folder / "a.mcap", *chunk(*described, *messages), described=described)


def redefined(folder: Path, *, text: str, payload: bytes) -> Path:
    """A type of ROS 2 by its name, with other fields."""
    described = (schema(1, ODOM.type_name, text=text), channel(1, "/odom", 1))
    messages = drive(payload=lambda number: payload + struct.pack("<d", number))
    return write_records(folder / "a.mcap", *chunk(*described, *messages), described=described)


POSES = {
    "no number": (float("nan"),),
    "infinite": (float("inf"),),
    "1e200": (1e200,),
    "the largest": (1.7976931348623157e308,),
    "both ways": (1e308, -1e308),
    "the least": (5e-324,),
}
REDEFINED = {
    "no pose": ("float64 level\n", b"\0\1\0\0"),
    "a pose that is a text": ("string pose\nfloat64 level\n", b"\0\1\0\0\2\0\0\0x\0\0\0"),
    "a pose that is a number": ("int64 pose\nfloat64 level\n", b"\0\1\0\0" + b"\xff" * 7 + b"\x7f"),
    "a pose without a position": (
        f"own/P pose\nfloat64 level\n{SEPARATOR}MSG: own/P\nint64 q\n",
        b"\0\1\0\0" + bytes(7) + b"\x80",
    ),
}
NO_RANGE = np.array([np.inf, np.inf], dtype=np.float32)
SENSORS: tuple[tuple[str, str, str, dict[str, object]], ...] = (
    ("no charge", "sensor_msgs/msg/BatteryState", "level", {"percentage": float("nan")}),
    ("a charge of -1", "sensor_msgs/msg/BatteryState", "level", {"percentage": -1.0}),
    ("no greatest range", "sensor_msgs/msg/LaserScan", "distance", {"range_max": 0.0, "ranges": NO_RANGE}),
)
VALUES = (
    *(a_drive(f"a pose: {name}", partial(with_poses, odd=odd), passes={}) for name, odd in POSES.items()),
    *(
        a_drive(
            f"a sensor: {odd}",
            partial(beside_a_drive, type_name=type_name, fields=fields),
            messages={"/odom": COUNT, "/sensor": COUNT},
            rules=far("/sensor", name, limit=20),
            passes={},
            also_said={"replay": [[f"/sensor {name}", f"unknown in {COUNT} messages"]]},
        )
        for odd, type_name, name, fields in SENSORS
    ),
    *(
        Case(
            name=f"an Odometry with {name}",
            make=partial(redefined, text=text, payload=payload),
            messages={"/odom": COUNT},
            rates_hz={"/odom": 10},
            rules=far("/odom", "msg.level", 50),
            passes={"/odom": (53, 62)},
        )
        for name, (text, payload) in REDEFINED.items()
    ),
)
STAMPS = (
    a_drive(
        "before the clock",
        before_the_clock,
        said=[["3 messages", "/odom"]],
        passes={"/odom": (53, 65)},
        is_quiet=False,
        # They are left out of all numbers.
        is_readable_by_others=False,
    ),
    a_drive(
        "headers of another clock",
        of_another_clock,
        also_said={"rates": [["/odom", "clock"]]},
        is_quiet=False,
    ),
)


ODD_ONES = (*LAYOUTS, *DEFINITIONS, *TYPES_OF_OTHERS, *UNDECODABLE, *PLACES, *VALUES, *STAMPS)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings with something odd: a layout, a name, a place, a definition, a value or a stamp."""

from __future__ import annotations

import struct
from functools import partial
from pathlib import Path
from typing import Any

from bags.bag_factory import cdr, message_of
from bags.recorded_by_others import (
    COUNT,
    ODOMETRY,
    Table,
    channel,
    chunk,
    drive,
    odometry_at,
    packed,
    schema,
    stamp_of,
    write_metadata,
    write_records,
    write_tables,
)
from bags.recording_case import Case, a_drive, far

LEVEL = "demo/msg/Level"


# Layouts


def without_counts_of_channels(folder: Path) -> Path:
    """The summary says how many messages there are, and not of which channel, as the format allows."""
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *drive()), counts_channels=False)


def without_summary(folder: Path) -> Path:
    return write_records(folder / "a.mcap", *ODOMETRY, *drive(), is_closed=False)


LAYOUTS = (
    a_drive("no counts by channel", without_counts_of_channels),
    a_drive("cut", without_summary, is_quiet=False, is_whole=False, is_readable_by_others=False),
)


# Types and definitions


def defined(folder: Path, *, text: str, encoding: str = "ros2msg", before: bytes = b"") -> Path:
    """A level behind the bytes ``before``, which are aligned to its eight."""
    described = (schema(1, LEVEL, encoding=encoding, text=text), channel(1, "/level", 1))
    messages = drive(payload=lambda number: b"\0\1\0\0" + before + struct.pack("<d", number / 10))
    return write_records(folder / "a.mcap", *chunk(*described, *messages), described=described)


def level(name: str, text: str, **more: Any) -> Case:
    return Case(
        name=f"definition: {name}",
        make=partial(defined, text=text, **more),
        messages={"/level": COUNT},
        curves={"/level": "level"},
        rules=far("/level", "msg.level"),
        passes={"/level": (53, 62)},
    )


SEPARATOR = "=" * 80 + "\n"
IDL = "#include <x.idl>\nmodule demo { module msg { struct Level { double level; }; }; };\n"
SHORT_TEXT = b"\2\0\0\0x\0\0\0"

DEFINITIONS = (
    level("as ROS 2 writes it", "float64 level\n"),
    level("an include", '#include "demo/Other.msg"\nfloat64 level\n'),
    level("a default without quotes", "string name unknown robot\nfloat64 level\n", before=SHORT_TEXT),
    level("a wide text", "wstring name\nfloat64 level\n", before=b"\2\0\0\0a\0b\0"),
    level("IDL of rosbag2", f"{SEPARATOR}IDL: {LEVEL}\n{IDL}", encoding="ros2idl"),
    level(
        "a part by its short name",
        f"Other other\nfloat64 level\n{SEPARATOR}MSG: demo/Other\nint8 x",
        before=b"\1" + bytes(7),
    ),
)


def service_events(folder: Path) -> Path:
    """Rosbag2 stores the text of the service; the message has what is within its event before that."""
    event = "example_interfaces/srv/AddTwoInts_Event"
    text = "int64 a\nint64 b\n---\nint64 sum\n"
    described = (*ODOMETRY, schema(2, event, text=text), channel(2, "/add/_service_event", 2))
    layout = "B3xiI16B4xqI4xqqI4x"
    numbers = [
        packed(layout, number % 4, number, 0, *[7] * 16, number, 1, 2, 3, 0) for number in range(COUNT)
    ]
    messages = [*drive(), *drive(payload=numbers.__getitem__, of=2)]
    return write_records(folder / "a.mcap", *chunk(*described, *messages), described=described)


def undefined(folder: Path) -> Path:
    rows = [(stamp_of(number), packed("d", number)) for number in range(COUNT)]
    return write_tables(folder / "a.db3", [Table("/own", "own_msgs/msg/Own", rows)])


UNDECODABLE = (
    a_drive(
        "events of a service",
        service_events,
        messages={"/odom": COUNT, "/add/_service_event": COUNT},
        is_quiet=False,
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


def without_topics(folder: Path) -> Path:
    write_records(folder / "a_0.mcap", *chunk(*ODOMETRY, *drive()))
    return write_metadata(folder, ["a_0.mcap"], {})


PLACES = (a_drive("no topics in metadata.yaml", without_topics),)


# Values and stamps


def with_poses(folder: Path, *, odd: tuple[float, ...]) -> Path:
    at = {20 + place: value for place, value in enumerate(odd)}
    messages = drive(payload=lambda number: odometry_at(number, x=at.get(number)))
    return write_records(folder / "a.mcap", *chunk(*ODOMETRY, *messages))


def beside_a_drive(folder: Path, *, type_name: str, fields: dict[str, object]) -> Path:
    described = (*ODOMETRY, schema(2, type_name), channel(2, "/sensor", 2))
    payload = cdr(type_name, message_of(type_name, **fields))
    messages = [*drive(), *drive(payload=lambda _: payload, of=2)]
    return write_records(folder / "a.mcap", *chunk(*described, *messages), described=described)


POSES = {
    "no number": (float("nan"),),
    "infinite": (float("inf"),),
    "the least": (5e-324,),
}
SENSORS: tuple[tuple[str, str, str, dict[str, object]], ...] = (
    ("no charge", "sensor_msgs/msg/BatteryState", "level", {"percentage": float("nan")}),
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
)


ODD_ONES = (*LAYOUTS, *DEFINITIONS, *UNDECODABLE, *PLACES, *VALUES)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings whose type is defined as tools and people write it."""

from __future__ import annotations

import struct
from functools import partial
from pathlib import Path
from typing import Any

from bags.recorded_by_others import COUNT, channel, chunk, drive, schema, write_records
from bags.recording_case import Case, far

LEVEL = "demo/msg/Level"


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
ENUM_IDL = "module demo {{ module msg {{ {enum}\n struct Level {{ {type} mode; double level; }}; }}; }};\n"
ENUM = "enum Mode { OFF, @value(3) ON };"
MODE_IDL = f"{SEPARATOR}IDL: demo/msg/Mode\nmodule demo {{{{ module msg {{{{ {{}} }}}}; }}}};\n".format(ENUM)
MODE = b"\3\0\0\0" + bytes(4)
SHORT_TEXT = b"\2\0\0\0x\0\0\0"

DEFINITIONS = (
    level("as ROS 2 writes it", "float64 level\n"),
    level("of Windows, with a mark", "\ufeff# made there\r\nfloat64 level\r\n"),
    level("constants and defaults", 'string EMPTY=\nstring NAME = "a # b"\nfloat64 level 1.5\n'),
    level("an include", '#include "demo/Other.msg"\nfloat64 level\n'),
    level("a default without quotes", "string name unknown robot\nfloat64 level\n", before=SHORT_TEXT),
    level("a wide text", "wstring name\nfloat64 level\n", before=b"\2\0\0\0a\0b\0"),
    level("IDL of rosbag2", f"{SEPARATOR}IDL: {LEVEL}\n{IDL}", encoding="ros2idl"),
    *(
        level(
            f"IDL with an enum {place}",
            f"{SEPARATOR}IDL: {LEVEL}\n{ENUM_IDL.format(enum=enum, type=of)}{more}",
            encoding="ros2idl",
            before=before,
        )
        for place, enum, of, more, before in (
            ("beside it", ENUM, "Mode", "", MODE),
            ("by its full name", ENUM, "demo::msg::Mode", "", MODE),
            ("of a byte", f"@bit_bound(8) {ENUM}", "Mode", "", b"\3" + bytes(7)),
            ("in a sequence", ENUM, "sequence<Mode>", "", b"\1\0\0\0\3\0\0\0"),
            ("in an array", f"{ENUM} typedef Mode Two[2];", "Two", "", MODE),
            ("in a text of its own", "", "demo::msg::Mode", MODE_IDL, MODE),
        )
    ),
    level(
        "a part by its short name",
        f"Other other\nfloat64 level\n{SEPARATOR}MSG: demo/Other\nint8 x",
        before=b"\1" + bytes(7),
    ),
)

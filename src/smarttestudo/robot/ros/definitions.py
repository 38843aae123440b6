# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Message definitions of installed types, for those who have no ROS."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.names import short_type_name
from smarttestudo.robot.ros.message_types import message_type, nested_types

_SEPARATOR = "=" * 80
_SEQUENCE = re.compile(r"sequence<(.+?)(?:, (\d+))?>\Z")
_ARRAY = re.compile(r"(.+)\[(\d+)\]\Z")
_BOUNDED_STRING = re.compile(r"(w?string)<(\d+)>\Z")
_MSG_NAMES = {"boolean": "bool", "double": "float64", "float": "float32", "octet": "byte"}


def message_definition(type_name: str) -> str:
    """The definition of ``type_name`` and of all types within it, as rosbag2 stores it in mcap.

    Texts are those of the installed .msg files. Where there is none, as in ROS 2 from PyPI, the fields are
    told without comments, defaults and constants. Empty where one of the types is not installed.
    """
    try:
        texts = dict(_texts(type_name))
    except RosError:
        return ""
    main = texts.pop(type_name)
    parts = [f"{_SEPARATOR}\nMSG: {short_type_name(name)}\n{text}" for name, text in texts.items()]
    return "\n".join([main, *parts])


def _texts(type_name: str) -> Iterator[tuple[str, str]]:
    """By name, each type once, a type before those within it."""
    met = {type_name: None}
    waiting = [type_name]
    while waiting:
        name = waiting.pop(0)
        kind = message_type(name, type_name)
        yield name, _file_text(name) or _generated_text(kind)
        within = dict.fromkeys(nested_types(kind))
        waiting += [one for one in within if one not in met]
        met |= within


def _file_text(type_name: str) -> str | None:
    prefixes = filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep))
    paths = (Path(prefix, "share", f"{type_name}.msg") for prefix in prefixes)
    path = next(filter(Path.is_file, paths), None)
    if path is None:
        return None
    try:
        return path.read_text("utf-8")
    except (OSError, UnicodeDecodeError):
        return None


def _generated_text(kind: Any) -> str:
    fields = kind.get_fields_and_field_types()
    return "".join(f"{_msg_type(field_type)} {name}\n" for name, field_type in fields.items())


def _msg_type(field_type: str) -> str:
    """``double[36]`` of rclpy as ``float64[36]`` of a .msg file."""
    if match := _SEQUENCE.match(field_type):
        bound = "" if match[2] is None else f"<={match[2]}"
        return f"{_msg_type(match[1])}[{bound}]"
    if match := _ARRAY.match(field_type):
        return f"{_msg_type(match[1])}[{match[2]}]"
    if match := _BOUNDED_STRING.match(field_type):
        return f"{match[1]}<={match[2]}"
    return _MSG_NAMES.get(field_type, field_type)

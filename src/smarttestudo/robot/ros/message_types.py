# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Message types by name, and their definitions, for those who have no ROS."""

from __future__ import annotations

import importlib
import importlib.util
import os
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from rclpy.serialization import deserialize_message
from rclpy.type_support import check_for_type_support

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.names import TypeName, short_type_name
from smarttestudo.domain.robot import Payload
from smarttestudo.domain.signal import Value
from smarttestudo.domain.type_definition import FieldType, TypeDefinition
from smarttestudo.robot.ros.message_view import UnknownLayoutError, message_view
from smarttestudo.robot.ros.ros_errors import ros_errors

_CLASSES_KEPT = 1024
_SEPARATOR = "=" * 80
_SEQUENCE = re.compile(r"sequence<(.+?)(?:, (\d+))?>\Z")
_ARRAY = re.compile(r"(.+)\[(\d+)\]\Z")
_BOUNDED_STRING = re.compile(r"(w?string)<(\d+)>\Z")
_DEFAULT = "__DEFAULT"
_MSG_NAMES = {"boolean": "bool", "double": "float64", "float": "float32", "octet": "byte"}


def message_type(type_name: str, topic: str) -> Any:
    """The class of ``type_name``, as in ``nav_msgs/msg/Odometry``, for use with ``topic``.

    Raises ``RosError`` where it is not installed, or cannot be used.
    """
    name = TypeName.read(type_name)
    if name is None:
        raise RosError(f"{type_name[:200]!r} is not the name of a message type", place=topic)
    try:
        kind = _generated_class(name)
    except ImportError as error:
        raise RosError(
            f"the message type {type_name} is not installed",
            place=topic,
            remedy=f"install the ROS package {name.package}, or source the workspace that holds it",
        ) from error
    try:
        check_for_type_support(kind)
    except Exception as error:  # rclpy documents none of those that it raises
        raise RosError(
            f"the message type {type_name} cannot be used: {error}",
            place=topic,
            remedy=f"build the ROS package {name.package} with the Python that runs SmartTestudo",
        ) from error
    return kind


@lru_cache(maxsize=_CLASSES_KEPT)
def _generated_class(name: TypeName) -> Any:
    """The class that rosidl made. Raises ``ImportError``."""
    # Names come from the network: only what rosidl made may be imported, for that runs the whole package.
    module = f"_{_in_snake_case(name.defined_in)}"
    if not _is_generated(name.package, name.kind, module):
        raise ImportError(name.package)
    kind = getattr(importlib.import_module(f"{name.package}.{name.kind}.{module}"), name.name, None)
    if not (isinstance(kind, type) and hasattr(kind, "get_fields_and_field_types")):
        raise ImportError(name.name)
    return kind


def _is_generated(package: str, kind: str, module: str) -> bool:
    """Whether files show that ``package`` is one of messages with this ``module``; nothing is imported."""
    try:
        spec = importlib.util.find_spec(package)
    except (ImportError, ValueError):
        return False
    folders = [] if spec is None else [Path(one) for one in spec.submodule_search_locations or ()]
    if len(folders) != 1:
        return False
    files = (Path(kind, "__init__.py"), Path(kind, f"{module}.py"))
    return all((folders[0] / file).is_file() for file in files) and any(
        folders[0].glob(f"{package}_s__rosidl_typesupport_*")
    )


def _in_snake_case(name: str) -> str:
    """As rosidl names modules."""
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def is_installed(type_name: str) -> bool:
    """Whether ``type_name`` is a message type that can be used here."""
    try:
        message_type(type_name, type_name)
    except RosError:
        return False
    return True


def decoded(topic: str, type_name: str, payload: Payload) -> object:
    """The message of a payload of ``topic``; its fields are read when asked for. Raises ``RosError``."""
    try:
        kind = _decodable(type_name)
    except RosError as error:
        raise RosError(error.cause, place=topic, remedy=error.remedy) from error
    data = payload[:]
    try:
        return message_view(kind, data, _class_of)
    except UnknownLayoutError:
        with ros_errors(topic):
            message: object = deserialize_message(data, kind)
        return message
    except ValueError as error:
        raise RosError(f"a message is no {type_name}: {error}", place=topic) from error


@lru_cache(maxsize=_CLASSES_KEPT)
def _decodable(type_name: str) -> Any:
    """The class of messages that can be decoded; looking for it takes as long as decoding one."""
    kind = message_type(type_name, type_name)
    if not is_readable(kind):
        raise RosError(f"{type_name} holds a long double or a wchar, which Python cannot read")
    return kind


def _class_of(type_name: str) -> Any:
    return message_type(type_name, type_name)


@lru_cache(maxsize=_CLASSES_KEPT)
def is_readable(kind: Any) -> bool:
    """Whether messages of the class can be decoded; relayed they are all the same."""
    # What rosidl makes for Python would end the process at such a field.
    within = [getattr(field, "value_type", field) for field in kind.SLOT_TYPES]
    return not any(getattr(one, "typename", "") in {"long double", "wchar"} for one in within) and all(
        is_readable(message_type(one, one)) for one in nested_types(kind)
    )


def begins_with_header(type_name: str) -> bool:
    """Whether messages of ``type_name`` begin with a std_msgs/Header; not where it is not installed."""
    try:
        fields = message_type(type_name, "").get_fields_and_field_types()
    except RosError:
        return False
    return next(iter(fields.items()), None) == ("header", "std_msgs/Header")


def type_definition(type_name: str) -> TypeDefinition | None:
    """The fields and constants of ``type_name``; ``None`` where it is not installed."""
    try:
        kind = message_type(type_name, "")
    except RosError:
        return None
    fields = {
        name: _field_type(slot)
        for name, slot in zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True)
    }
    # Beside constants, rosidl's metaclass has the defaults of fields there.
    given: Mapping[str, Any] = type(kind).__prepare__(kind.__name__, ())
    constants = {name: _constant(value) for name, value in given.items() if not name.endswith(_DEFAULT)}
    return TypeDefinition(fields=fields, constants=constants)


def _field_type(slot: Any) -> FieldType:
    inner = getattr(slot, "value_type", slot)
    if hasattr(inner, "namespaces"):
        name = "/".join((*inner.namespaces, inner.name))
    elif hasattr(inner, "typename"):
        name = _MSG_NAMES.get(inner.typename, inner.typename)
    else:
        name = "wstring" if "WString" in type(inner).__name__ else "string"
    return FieldType(name=name, is_array=inner is not slot)


def _constant(value: str | bytes | float) -> Value:
    if isinstance(value, bytes):
        return float(value[0])
    return value if isinstance(value, str) else float(value)


def has_byte_sequence(type_name: str) -> bool:
    """Whether messages of ``type_name`` hold a ``uint8[]``, however deep; not where it is not installed."""
    try:
        kind = message_type(type_name, "")
    except RosError:
        return False
    fields = kind.get_fields_and_field_types().values()
    return any(one.startswith("sequence<uint8") for one in fields) or any(
        map(has_byte_sequence, nested_types(kind))
    )


def nested_types(kind: Any) -> Iterator[str]:
    """The message types of the fields of a class, those of sequences and arrays too."""
    for field in kind.SLOT_TYPES:
        within = getattr(field, "value_type", field)
        if hasattr(within, "namespaces"):
            yield "/".join((*within.namespaces, within.name))


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

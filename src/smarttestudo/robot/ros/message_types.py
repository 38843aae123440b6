# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Message types by name."""

from __future__ import annotations

import importlib
import importlib.util
import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

from rclpy.serialization import deserialize_message
from rclpy.type_support import check_for_type_support

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.names import TypeName
from smarttestudo.domain.robot import Payload
from smarttestudo.robot.ros.message_view import UnknownLayoutError, message_view
from smarttestudo.robot.ros.ros_errors import ros_errors

_CLASSES_KEPT = 1024


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
    kind = message_type(type_name, topic)
    if not is_readable(kind):
        raise RosError(f"{type_name} holds a long double or a wchar, which Python cannot read", place=topic)
    data = payload[:]
    try:
        return message_view(kind, data, _class_of)
    except UnknownLayoutError:
        with ros_errors(topic):
            message: object = deserialize_message(data, kind)
        return message
    except ValueError as error:
        raise RosError(f"a message is no {type_name}: {error}", place=topic) from error


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

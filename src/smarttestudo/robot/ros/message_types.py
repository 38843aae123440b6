# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Message types by name."""

from __future__ import annotations

import importlib
import re
from typing import Any

from rclpy.serialization import deserialize_message
from rclpy.type_support import check_for_type_support

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.payload import Payload
from smarttestudo.robot.ros.ros_errors import ros_errors

_TYPE_NAME = re.compile(r"([a-z][a-z0-9_]*)/msg/([A-Z][A-Za-z0-9]*)\Z")

# A message within another, a sequence or an array of them.
_NESTED_TYPE = re.compile(r"(?:sequence<)?([a-z][a-z0-9_]*)/([A-Z][A-Za-z0-9]*)")


def message_type(type_name: str, topic: str) -> Any:
    """The class of ``type_name``, as in ``nav_msgs/msg/Odometry``, for use with ``topic``.

    Raises ``RosError`` where it is not installed, or cannot be used.
    """
    # Names come from the network: what is imported must be the messages of a package.
    match = _TYPE_NAME.match(type_name)
    if match is None:
        raise RosError(f"{type_name!r} is not the name of a message type", place=topic)
    package, name = match.groups()
    try:
        kind = getattr(importlib.import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError) as error:
        raise RosError(
            f"the message type {type_name} is not installed",
            place=topic,
            remedy=f"install the ROS package {package}, or source the workspace that holds it",
        ) from error
    try:
        check_for_type_support(kind)
    except Exception as error:  # rclpy documents none of those that it raises
        raise RosError(
            f"the message type {type_name} cannot be used: {error}",
            place=topic,
            remedy=f"build the ROS package {package} with the Python that runs SmartTestudo",
        ) from error
    return kind


def is_installed(type_name: str) -> bool:
    """Whether ``type_name`` is a message type that can be used here."""
    try:
        message_type(type_name, type_name)
    except RosError:
        return False
    return True


def decoded(topic: str, type_name: str, payload: Payload) -> object:
    """The message of a payload that came on ``topic``. Raises ``RosError``."""
    with ros_errors(topic):
        message: object = deserialize_message(payload[:], message_type(type_name, topic))
    return message


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
        fields = message_type(type_name, "").get_fields_and_field_types()
    except RosError:
        return False
    return any(_is_byte_sequence(one) for one in fields.values())


def nested_types(field_type: str) -> tuple[str, ...]:
    """The message type in a field of ``field_type``, as rclpy tells it; none for a number or a text."""
    match = _NESTED_TYPE.match(field_type)
    return () if match is None else (f"{match[1]}/msg/{match[2]}",)


def _is_byte_sequence(field_type: str) -> bool:
    return field_type.startswith("sequence<uint8") or any(map(has_byte_sequence, nested_types(field_type)))

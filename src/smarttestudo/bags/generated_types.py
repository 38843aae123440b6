# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that rosidl makes of services and actions, of which rosbag2 records the files."""

from __future__ import annotations

import re
from collections.abc import Iterator

from smarttestudo.domain.type_names import TypeName, short_type_name

_PARTS = re.compile(r"^---[ \t]*$", re.MULTILINE)
_SECTION = re.compile(r"^={80}\n(?:MSG|SRV|ACTION): *(\S+)[ \t]*\n", re.MULTILINE)
_NAMES = {2: ("Request", "Response"), 3: ("Goal", "Result", "Feedback")}
_UUID = "unique_identifier_msgs/UUID"
_KNOWN = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    _UUID: "uint8[16] uuid\n",
    "service_msgs/ServiceEventInfo": "uint8 REQUEST_SENT = 0\nuint8 REQUEST_RECEIVED = 1\n"
    "uint8 RESPONSE_SENT = 2\nuint8 RESPONSE_RECEIVED = 3\nuint8 event_type\n"
    "builtin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number\n",
}


def texts_within(definition: str, name: TypeName) -> dict[str, str]:
    """The text of each message type of ``definition``, by its name of two parts.

    The first text, which has no name there, is that of ``name`` or of the file that defines it.
    """
    main, *others = _SECTION.split(definition)
    sections = [*zip(others[::2], others[1::2], strict=True)]
    if main.strip() or not sections:
        sections.insert(0, (f"{name.package}/{name.name}", main))
    return dict(text for section in sections for text in _messages(*section, name))


def generated_texts(name: TypeName) -> dict[str, str]:
    """Texts of what rosidl adds to the parts of the service or action of ``name``, and of the types in it."""
    of = f"{name.package}/{name.defined_in}"
    return {**_KNOWN, **(_of_service(of) if name.kind == "srv" else _of_action(of))}


def _messages(section: str, text: str, name: TypeName) -> Iterator[tuple[str, str]]:
    parts = _PARTS.split(text)
    if len(parts) in _NAMES:
        for part, one in zip(_NAMES[len(parts)], parts, strict=True):
            yield f"{name.package}/{name.defined_in}_{part}", one
    else:
        yield short_type_name(section), text


def _of_service(of: str) -> dict[str, str]:
    event = f"service_msgs/ServiceEventInfo info\n{of}_Request[<=1] request\n{of}_Response[<=1] response\n"
    return {f"{of}_Event": event}


def _of_action(of: str) -> dict[str, str]:
    return {
        f"{of}_FeedbackMessage": f"{_UUID} goal_id\n{of}_Feedback feedback\n",
        f"{of}_SendGoal_Request": f"{_UUID} goal_id\n{of}_Goal goal\n",
        f"{of}_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp\n",
        f"{of}_GetResult_Request": f"{_UUID} goal_id\n",
        f"{of}_GetResult_Response": f"int8 status\n{of}_Result result\n",
        **_of_service(f"{of}_SendGoal"),
        **_of_service(f"{of}_GetResult"),
    }

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that rosidl makes of services and actions, of which rosbag2 records the files."""

from __future__ import annotations

import re
from collections.abc import Iterator

from smarttestudo.bags.definition_text import Section
from smarttestudo.domain.names import TypeName

_PARTS = re.compile(r"^---[ \t]*$", re.MULTILINE)
_NAMES = {2: ("Request", "Response"), 3: ("Goal", "Result", "Feedback")}
_UUID = "unique_identifier_msgs/UUID"
_KNOWN = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    _UUID: "uint8[16] uuid\n",
    "service_msgs/ServiceEventInfo": "uint8 REQUEST_SENT = 0\nuint8 REQUEST_RECEIVED = 1\n"
    "uint8 RESPONSE_SENT = 2\nuint8 RESPONSE_RECEIVED = 3\nuint8 event_type\n"
    "builtin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number\n",
}


def messages_within(section: Section, name: TypeName) -> Iterator[Section]:
    """The parts of a section that is the file of a service or action, that of ``name``; else the section."""
    parts = _PARTS.split(section.text)
    if len(parts) not in _NAMES:
        yield section
        return
    line = section.line
    for part, text in zip(_NAMES[len(parts)], parts, strict=True):
        yield Section(name=f"{name.package}/{name.defined_in}_{part}", text=text, line=line, is_idl=False)
        line += text.count("\n")


def generated_sections(name: TypeName) -> list[Section]:
    """Texts of what rosidl adds to the parts of the service or action of ``name``, and of the types in it.

    There are none for a message.
    """
    of = f"{name.package}/{name.defined_in}"
    texts = {"msg": {}, "srv": _of_service(of), "action": _of_action(of)}[name.kind]
    texts = {**_KNOWN, **texts} if texts else {}
    return [Section(name=one, text=text, line=1, is_idl=False) for one, text in texts.items()]


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

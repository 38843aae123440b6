# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The fields in the text of a .msg file, whatever else stands in it.

rosbags reads constants and default values, too, which messages do not hold: what is odd in one would cost the
type. It knows no wstring, and takes seconds for thousands of fields.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, cast

from rosbags.interfaces import Nodetype

from smarttestudo.bags.definition_text import Section
from smarttestudo.domain.names import full_type_name

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Fielddefs, FieldDesc

_NAME = r"[A-Za-z]\w*"
_FIELD = re.compile(
    rf"(?:@\w+[ \t]+)*(?P<type>{_NAME}(?:/{_NAME}){{0,2}})(?:<=(?P<characters>\d+))?"
    rf"(?:\[[ \t]*(?P<bounded><=)?[ \t]*(?P<length>\d*)[ \t]*\])?[ \t]+(?P<field>{_NAME})"
    r"(?:[ \t]*(?P<constant>=)|[ \t#]|\Z)",
    re.ASCII,
)
_NOTHING = re.compile(r"(?:#.*|@\w+|=*)\Z")
_TEXTS = frozenset({"string", "wstring"})
_BASE_TYPES = _TEXTS.union(
    ("bool", "byte", "char", "float32", "float64"),
    (f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)),
)
_ALIASES = {
    "Header": "std_msgs/msg/Header",
    "time": "builtin_interfaces/msg/Time",
    "duration": "builtin_interfaces/msg/Duration",
}
_SHOWN = 40


class DefinitionError(ValueError):
    """Text that defines no type; its message says where."""


def msg_fields(section: Section, package: str, kind: str) -> Fielddefs:
    """The fields in ``section``, in which types without one are those of ``package``.

    Types of that ``kind``, such as srv, are among those that it names. Raises ``DefinitionError`` for a line
    that is none.
    """
    fields: dict[str, FieldDesc] = {}
    for number, line in enumerate(section.text.split("\n"), section.line):
        text = line.strip()
        if _NOTHING.match(text):
            continue
        match = _FIELD.match(text)
        if match is None or (match["characters"] and match["type"] not in _TEXTS):
            shown = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"
            raise DefinitionError(f"line {number}: {shown!r} is no field")
        name = match["field"]
        if name in fields:
            raise DefinitionError(f"line {number}: a second field {name}")
        if match["constant"] is None:
            fields[name] = _desc(match, package, kind)
    return [*fields.items()]


def _desc(match: re.Match[str], package: str, kind: str) -> FieldDesc:
    name = match["type"]
    inner: FieldDesc = (Nodetype.NAME, _ALIASES.get(name) or full_type_name(name, package, kind))
    if name in _BASE_TYPES:
        inner = cast("FieldDesc", (Nodetype.BASE, (name, int(match["characters"] or 0))))
    if match["length"] is None:
        return inner
    is_array = match["length"] and not match["bounded"]
    node = Nodetype.ARRAY if is_array else Nodetype.SEQUENCE
    return cast("FieldDesc", (node, (inner, int(match["length"] or 0))))

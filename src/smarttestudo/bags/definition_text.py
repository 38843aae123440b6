# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The texts of type definitions in recordings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from smarttestudo.domain.recording import ForeignSchema

SEPARATOR = "=" * 80 + "\n"
_IDL, _MSG = "IDL", "MSG"
_IDL_HEADER = f"{SEPARATOR}{_IDL}: "
_RULER = r"^[ \t]*={3,}[ \t]*\n"
_HEADER = re.compile(
    rf"(?:{_RULER})+[ \t]*({_MSG}|SRV|ACTION|{_IDL})[ \t]*:[ \t]*(\S+)[ \t]*(?:\n|\Z)", re.MULTILINE
)
_MODULE = re.compile(r"^[ \t]*module\s+\w+\s*\{", re.MULTILINE)


_IDL_ENCODINGS = frozenset({"ros2idl", "omgidl"})
# Where rosbag2 found no definition, it says "" or "unknown".
_ENCODINGS = frozenset({"ros2msg", "", "unknown"}) | _IDL_ENCODINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """The text of one type, whose first line is the ``line``-th of the definition; ``name`` may be short."""

    name: str
    text: str
    line: int
    is_idl: bool


def stored_definition(type_name: str, encoding: str, data: bytes) -> tuple[str | None, ForeignSchema | None]:
    """A type's definition as rosbag2 writes it, where IDL starts with a header line, and else its schema.

    There is none where nothing but blanks was stored.
    """
    if encoding not in _ENCODINGS:
        return None, ForeignSchema(encoding=encoding, data=data)
    text = _normal(data.decode("utf-8", "replace"))
    if not text.strip():
        return None, None
    is_idl = encoding in _IDL_ENCODINGS or _MODULE.search(text) is not None
    if is_idl and _HEADER.search(text) is None:
        text = f"{_IDL_HEADER}{type_name}\n{text}"
    return text, None


def _normal(text: str) -> str:
    """Without what editors and other tools leave: marks of the byte order, Windows' line ends, zeros."""
    return text.replace("\ufeff", "").replace("\r\n", "\n").replace("\r", "\n").rstrip("\0")


def is_idl_definition(definition: str) -> bool:
    """Whether ``definition``, as rosbag2 writes it, is of IDL rather than of .msg files."""
    return definition.startswith(_IDL_HEADER)


def sections(definition: str, type_name: str) -> list[Section]:
    """The texts in ``definition``: first that of ``type_name``, unless it has a name there, too."""
    found = [*_sections(_normal(definition), type_name)]
    return found if found[0].text.strip() or len(found) == 1 else found[1:]


def _sections(definition: str, type_name: str) -> Iterator[Section]:
    name, kind, start = type_name, _MSG, 0
    for header in _HEADER.finditer(definition):
        yield _section(definition, name, kind, start, header.start())
        kind, name, start = header[1], header[2], header.end()
    yield _section(definition, name, kind, start, len(definition))


def _section(definition: str, name: str, kind: str, start: int, end: int) -> Section:
    text = definition[start:end]
    is_idl = kind == _IDL or _MODULE.search(text) is not None
    return Section(name=name, text=text, line=definition.count("\n", 0, start) + 1, is_idl=is_idl)

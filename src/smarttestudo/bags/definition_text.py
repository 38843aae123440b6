# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The texts of type definitions in recordings."""

from __future__ import annotations

SEPARATOR = "=" * 80 + "\n"
_IDL_HEADER = f"{SEPARATOR}IDL: "


def normal_definition(text: str, *, type_name: str, is_idl: bool) -> str | None:
    """``text`` as rosbag2 writes it, where IDL starts with a header line; ``None`` for an empty one."""
    if not text:
        return None
    if is_idl and not is_idl_definition(text):
        return f"{_IDL_HEADER}{type_name}\n{text}"
    return text


def is_idl_definition(definition: str) -> bool:
    """Whether ``definition``, as rosbag2 writes it, is of IDL rather than of .msg files."""
    return definition.startswith(_IDL_HEADER)

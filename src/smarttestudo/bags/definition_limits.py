# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How large a type definition may be: rosbags writes code for each value of a type, arrays one by one."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from rosbags.interfaces import Nodetype

from smarttestudo.bags.readable_types import inner_of
from smarttestudo.domain.units import grouped

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict

MAX_STATEMENTS = 5000
MAX_VALUES = 5000
_MSG_STATEMENT = re.compile(r"^[ \t]*[^\s#]", re.MULTILINE)
_IDL_STATEMENT = re.compile("[;@]")
_IDL_TEXT = re.compile(r'"(?:[^"\\\n]|\\.)*"')
# rosbags tries each way to read what is nested, time and again.
_IDL_NESTED = re.compile(r"\([^()]*\(|(?:sequence\s*<\s*){5}")


def require_few_statements(definition: str, *, is_idl: bool) -> None:
    """Raise ``ValueError`` for a definition whose text takes seconds to read."""
    code = _IDL_TEXT.sub("", definition) if is_idl else definition
    statements = (_IDL_STATEMENT if is_idl else _MSG_STATEMENT).finditer(code)
    if sum(1 for _ in statements) > MAX_STATEMENTS:
        raise ValueError(f"the definition has more than {grouped(MAX_STATEMENTS)} statements")
    if is_idl and _IDL_NESTED.search(code):
        raise ValueError("the definition nests parentheses or sequences too deep")


def require_few_values(types: Typesdict, name: str) -> None:
    """Raise ``ValueError`` where a message has too many values beside its sequences and arrays of numbers.

    Raises ``RecursionError`` for a type that contains itself.
    """
    counts: dict[str, int] = {}

    def count(one: str) -> int:
        if one not in counts:
            counts[one] = sum(of_field(desc) for _, desc in types[one][1])
        return counts[one]

    def of_field(desc: Any) -> int:
        inner: Any = inner_of(desc)
        is_number = inner[0] == Nodetype.BASE and inner[1][0] != "string"
        length: int = desc[1][1] if desc[0] == Nodetype.ARRAY and not is_number else 1
        return length * (count(inner[1]) if inner[0] == Nodetype.NAME else 1)

    if count(name) > MAX_VALUES:
        raise ValueError(f"a message has more than {grouped(MAX_VALUES)} values")

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Answers as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import msgspec
from msgspec import Struct

from smarttestudo.domain.record import to_json
from smarttestudo.editing import MadeLater

_T = TypeVar("_T")


def answer_json(answer: object) -> bytes:
    """Encode ``answer``: a struct as msgspec does, a record as it stands in a status or ``--json``.

    A struct holds no record whose JSON is other than its fields; the generator of the page's types refuses
    one that does.
    """
    return msgspec.json.encode(answer if isinstance(answer, Struct) else to_json(answer), enc_hook=_list_json)


class JsonList(MadeLater[_T]):
    """The ``structs`` of an answer, which stand in it as their ``texts``."""

    def __init__(self, texts: Sequence[str], structs: Sequence[_T]) -> None:
        super().__init__(len(texts), lambda: structs)
        self._texts = texts

    def json(self) -> msgspec.Raw:
        """The list as it stands in an answer."""
        return msgspec.Raw(f"[{','.join(self._texts)}]".encode())


def _list_json(value: object) -> msgspec.Raw:
    if isinstance(value, JsonList):
        return value.json()
    raise NotImplementedError(f"a {type(value).__name__} has no JSON")

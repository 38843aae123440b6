# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lists of an answer whose JSON is put together of texts that are known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import msgspec

from smarttestudo.editing import MadeLater

_T = TypeVar("_T")


class JsonList(MadeLater[_T]):
    """The ``structs`` of an answer, which stand in it as their ``texts``."""

    def __init__(self, texts: Sequence[str], structs: Sequence[_T]) -> None:
        super().__init__(len(texts), lambda: structs)
        self._texts = texts

    def json(self) -> msgspec.Raw:
        """The list as it stands in an answer."""
        return msgspec.Raw(f"[{','.join(self._texts)}]".encode())

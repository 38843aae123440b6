# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reading the objects of a stranger's JSON."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

_Read = TypeVar("_Read")


class JsonRecord:
    """An object of a stranger's JSON; ``TypeError`` where it or an entry is not what was asked for."""

    def __init__(self, record: object) -> None:
        if not isinstance(record, dict):
            raise TypeError("not an object")
        self.entries: Mapping[str, object] = record

    def optional(self, read: Callable[[str], _Read], name: str) -> _Read | None:
        """What ``read`` gives for the entry, ``None`` where it is absent or null."""
        return None if self.entries.get(name) is None else read(name)

    def number(self, name: str) -> float:
        """A number of the entry."""
        return self.integer(name) if isinstance(self.entries.get(name), int) else self._entry(name, float)

    def integer(self, name: str) -> int:
        """A whole number."""
        return self._entry(name, int)

    def text(self, name: str) -> str:
        """A text."""
        return self._entry(name, str)

    def flag(self, name: str) -> bool:
        """True or false."""
        return self._entry(name, bool)

    def texts(self, name: str) -> tuple[str, ...]:
        """A list, its entries as texts."""
        return tuple(str(entry) for entry in self._entry(name, list))

    def record(self, name: str) -> JsonRecord:
        """An object."""
        return JsonRecord(self.entries.get(name))

    def _entry(self, name: str, kind: type[_Read]) -> _Read:
        entry = self.entries.get(name)
        # True and False are integers to Python.
        if not isinstance(entry, kind) or (isinstance(entry, bool) and kind is not bool):
            raise TypeError(f"{name} has an unexpected type or value")
        return entry

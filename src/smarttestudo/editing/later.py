# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lists of things that few look at."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from typing import TypeVar, overload

_T = TypeVar("_T")


class MadeLater(Sequence[_T]):
    """So many things, which ``make`` gives all at once when somebody looks at one."""

    @staticmethod
    def part_of(things: Sequence[_T], start: int, end: int) -> MadeLater[_T]:
        """Things from number ``start`` to before ``end``."""
        return MadeLater(end - start, lambda: things[start:end])

    def __init__(self, length: int, make: Callable[[], Iterable[_T]]) -> None:
        self._length = length
        self._make = make

    @cached_property
    def _things(self) -> Sequence[_T]:
        return tuple(self._make())

    def __iter__(self) -> Iterator[_T]:
        return iter(self._things)

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, at: int) -> _T: ...

    @overload
    def __getitem__(self, at: slice) -> Sequence[_T]: ...

    def __getitem__(self, at: int | slice) -> _T | Sequence[_T]:
        return self._things[at]

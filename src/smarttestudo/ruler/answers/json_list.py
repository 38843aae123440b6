# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lists of an answer whose JSON is put together of texts that are known."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import TypeVar, overload

import msgspec

_T = TypeVar("_T")


class JsonList(Sequence[_T]):
    """Structs that stand in an answer as their ``texts``; ``make`` gives them to who looks at one."""

    def __init__(self, texts: Sequence[str], make: Callable[[], Iterable[_T]]) -> None:
        self._texts = texts
        self._make = make

    @cached_property
    def _structs(self) -> Sequence[_T]:
        return tuple(self._make())

    def __len__(self) -> int:
        return len(self._texts)

    @overload
    def __getitem__(self, at: int) -> _T: ...

    @overload
    def __getitem__(self, at: slice) -> Sequence[_T]: ...

    def __getitem__(self, at: int | slice) -> _T | Sequence[_T]:
        return self._structs[at]

    def json(self) -> msgspec.Raw:
        """The list as it stands in an answer."""
        return msgspec.Raw(f"[{','.join(self._texts)}]".encode())

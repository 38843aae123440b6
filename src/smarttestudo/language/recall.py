# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Memory of values that were made of the same things before."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Any, TypeVar

_T = TypeVar("_T")
_S = TypeVar("_S")

_RUN = 64
_SHORTEST_RUN = 32
_LONGEST_RUN = 128


class Recall:
    """Values that are made once of the same things, as long as each text has them in common with the last.

    Things are the same if they are one object: an edited text keeps the trees of all statements that the edit
    left in their places. Numbers are the same if they are equal. Whoever makes a value takes all else that it
    depends on from its name. No value is ``None``.
    """

    def __init__(self, before: Recall | None = None) -> None:
        self._before: Mapping[Hashable, Any] = {} if before is None else before.kept
        self.kept: dict[Hashable, Any] = {}

    def before(self, name: Hashable) -> Any:
        """The value that was kept as ``name`` of the text before, if any."""
        return self._before.get(name)

    def keep(self, name: Hashable, value: _T) -> _T:
        """Keep ``value`` as ``name`` for the next text."""
        self.kept[name] = value
        return value

    def each(self, name: Hashable, make: Callable[..., _T], *columns: Sequence[Any]) -> Sequence[_T]:
        """The value called ``name`` of the things in each row of ``columns``."""
        values, others = self.known(name, *columns)
        for at in others:
            values[at] = make(*(column[at] for column in columns))
        return values

    def known(self, name: Hashable, *columns: Sequence[Any]) -> tuple[list[Any], Sequence[int]]:
        """The values of ``each``, and the numbers of the rows that need one, which the caller fills in."""
        ids = [_ids(column) for column in columns]
        old_ids, old_values, _ = self._before.get(name, ([[] for _ in ids], [], None))
        head, tail = _common_ends(old_ids, ids)
        old_end, end = len(old_values) - tail, len(ids[0]) - tail
        old_rows = zip(*(column[head:old_end] for column in old_ids), strict=True)
        by_things = dict(zip(old_rows, old_values[head:old_end], strict=True))
        between = list(map(by_things.get, zip(*(column[head:end] for column in ids), strict=True)))
        values = [*old_values[:head], *between, *old_values[old_end:]]
        self.keep(name, (ids, values, columns))
        return values, [at for at, value in enumerate(between, head) if value is None]

    def runs(self, name: Hashable, make: Callable[[Sequence[_S]], _T], things: Sequence[_S]) -> Sequence[_T]:
        """The value called ``name`` of each run of ``things``, made again where one of them is new."""
        ids = _ids(things)
        old_ids, old_ends, old_values, _ = self._before.get(name, ([], [], [], None))
        head, tail = _common_ends([old_ids], [ids])
        by = len(ids) - len(old_ids)
        first = bisect_right(old_ends, head)
        behind = bisect_left(old_ends, len(old_ids) - tail) + 1
        end = old_ends[behind - 1] + by if behind <= len(old_ends) else len(ids)
        if first and 0 < end - old_ends[first - 1] < _SHORTEST_RUN:
            first -= 1
        start = old_ends[first - 1] if first else 0
        ends = _ends_of_runs(start, end)
        made = [make(things[one:another]) for one, another in zip([start, *ends], ends, strict=False)]
        values = [*old_values[:first], *made, *old_values[behind:]]
        ends = [*old_ends[:first], *ends, *(one + by for one in old_ends[behind:])]
        self.keep(name, (ids, ends, values, things))
        return values

    def forget_before(self) -> None:
        """All was asked: what was not asked for again is gone."""
        self._before = {}


def _ids(things: Sequence[Any]) -> list[int]:
    return list(things if things and isinstance(things[0], int) else map(id, things))


def _common_ends(old: Sequence[Sequence[int]], new: Sequence[Sequence[int]]) -> tuple[int, int]:
    """How many rows of columns are alike at the start, and how many of the others at the end."""
    head = min(map(_common_start, old, new))
    rest = ((one[head:][::-1], other[head:][::-1]) for one, other in zip(old, new, strict=True))
    return head, min(_common_start(*pair) for pair in rest)


def _common_start(old: Sequence[int], new: Sequence[int]) -> int:
    """How many numbers at the start of both are alike."""
    shorter = min(len(old), len(new))
    runs = range(0, shorter, _RUN)
    start = next((at for at in runs if old[at : at + _RUN] != new[at : at + _RUN]), shorter)
    return next((at for at in range(start, shorter) if old[at] != new[at]), shorter)


def _ends_of_runs(start: int, end: int) -> Sequence[int]:
    """Where runs of about as many things end between ``start`` and ``end``."""
    count = -(-(end - start) // _LONGEST_RUN)
    return [start + (end - start) * number // count for number in range(1, count + 1)]

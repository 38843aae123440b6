# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Memory of values that were made of the same things before."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from itertools import compress, count
from operator import is_not, ne
from typing import Any, TypeVar

_T = TypeVar("_T")
_S = TypeVar("_S")

_SHORTEST_RUN = 16
_LONGEST_RUN = 64


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
        old_columns, old_values = self._before.get(name, ([() for _ in columns], []))
        head, tail = _common_ends(old_columns, columns)
        old_end, end = len(old_values) - tail, len(columns[0]) - tail
        old_rows = zip(*(_ids(column[head:old_end]) for column in old_columns), strict=True)
        by_things = dict(zip(old_rows, old_values[head:old_end], strict=True))
        rows = zip(*(_ids(column[head:end]) for column in columns), strict=True)
        between = list(map(by_things.get, rows))
        values = [*old_values[:head], *between, *old_values[old_end:]]
        self.keep(name, (columns, values))
        return values, [at for at, value in enumerate(between, head) if value is None]

    def behind_change(self, name: Hashable, make: Callable[..., _T], *columns: Sequence[Any]) -> Sequence[_T]:
        """The value called ``name`` of each row; all from the first other row on are made again."""
        old_columns, old_values = self._before.get(name, ([() for _ in columns], []))
        head, _ = _common_ends(old_columns, columns)
        values = [*old_values[:head], *map(make, *(column[head:] for column in columns))]
        self.keep(name, (columns, values))
        return values

    def runs(self, name: Hashable, make: Callable[[Sequence[_S]], _T], things: Sequence[_S]) -> Sequence[_T]:
        """The value called ``name`` of each run of ``things``, made again where one of them is new."""
        old_things, old_ends, old_values = self._before.get(name, ([], [], []))
        head, tail = _common_ends([old_things], [things])
        by = len(things) - len(old_things)
        first = bisect_right(old_ends, head)
        behind = bisect_left(old_ends, len(old_things) - tail) + 1
        end = old_ends[behind - 1] + by if behind <= len(old_ends) else len(things)
        if first and 0 < end - old_ends[first - 1] < _SHORTEST_RUN:
            first -= 1
        start = old_ends[first - 1] if first else 0
        ends = _ends_of_runs(start, end)
        made = [make(things[one:another]) for one, another in zip([start, *ends], ends, strict=False)]
        values = [*old_values[:first], *made, *old_values[behind:]]
        ends = [*old_ends[:first], *ends, *(one + by for one in old_ends[behind:])]
        self.keep(name, (things, ends, values))
        return values

    def forget_before(self) -> None:
        """All was asked: what was not asked for again is gone."""
        self._before = {}


def _ids(things: Sequence[Any]) -> Iterable[int]:
    return things if _are_numbers(things) else map(id, things)


def _are_numbers(things: Sequence[Any]) -> bool:
    return bool(things) and isinstance(things[0], int)


def _common_ends(old: Sequence[Sequence[Any]], new: Sequence[Sequence[Any]]) -> tuple[int, int]:
    """How many rows of columns are alike at the start, and how many of the others at the end."""
    shorter = min(len(old[0]), len(new[0]))
    ends = [
        _common_start(*pair, ne if _are_numbers(pair[0]) else is_not, shorter)
        for one, other in zip(old, new, strict=True)
        for pair in ((one, other), (one[::-1], other[::-1]))
    ]
    head = min(ends[::2])
    return head, min(shorter - head, *ends[1::2])


def _common_start(
    old: Sequence[Any], new: Sequence[Any], are_other: Callable[[Any, Any], bool], most: int
) -> int:
    return next(compress(count(), map(are_other, old, new)), most)


def _ends_of_runs(start: int, end: int) -> Sequence[int]:
    """Where runs of about as many things end between ``start`` and ``end``."""
    count = -(-(end - start) // _LONGEST_RUN)
    return [start + (end - start) * number // count for number in range(1, count + 1)]

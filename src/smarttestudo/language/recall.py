# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Memory of values that were made of the same things before."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from operator import ne
from typing import Any, TypeVar

_T = TypeVar("_T")
_S = TypeVar("_S")

_RUN = 64
_FEW = 16


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
        values = old_values.copy()
        others = sorted({at for pair in zip(old_ids, ids, strict=True) for at in _differing(*pair)})
        if len(values) != len(ids[0]) or len(others) > _FEW:
            by_things = dict(zip(zip(*old_ids, strict=True), old_values, strict=True))
            values = list(map(by_things.get, zip(*ids, strict=True)))
            others = [at for at, value in enumerate(values) if value is None]
        self.keep(name, (ids, values, columns))
        return values, others

    def runs(self, name: Hashable, make: Callable[[Sequence[_S]], _T], things: Sequence[_S]) -> Sequence[_T]:
        """The value called ``name`` of each run of ``things``, made again where one of them is new."""
        ids = _ids(things)
        old_ids, old_values, _ = self._before.get(name, ([], [], None))
        changed = {at // _RUN for at in _differing(old_ids, ids)}
        if len(old_ids) != len(ids):
            changed.add(min(len(old_ids), len(ids)) // _RUN)
        values = [
            old_values[run]
            if run < len(old_values) and run not in changed
            else make(things[run * _RUN : (run + 1) * _RUN])
            for run in range(-(-len(ids) // _RUN))
        ]
        self.keep(name, (ids, values, things))
        return values

    def forget_before(self) -> None:
        """All was asked: what was not asked for again is gone."""
        self._before = {}


def _ids(things: Sequence[Any]) -> list[int]:
    return list(things if things and isinstance(things[0], int) else map(id, things))


def _differing(old: Sequence[int], new: Sequence[int]) -> Sequence[int]:
    """Where ``old`` and ``new`` differ, as far as both go."""
    return [
        at
        for start in range(0, min(len(old), len(new)), _RUN)
        if old[start : start + _RUN] != new[start : start + _RUN]
        for at, is_other in enumerate(map(ne, old[start : start + _RUN], new[start : start + _RUN]), start)
        if is_other
    ]

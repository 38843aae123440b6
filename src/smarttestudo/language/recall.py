# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Memory of values that were made of the same things before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

_T = TypeVar("_T")
_Kept = tuple[tuple[object, ...], Any]
"""A value behind the things that it was made of, so that these live as long as it."""


class Recall:
    """Values that are made once of the same things, as long as each text has them in common with the last.

    Things are the same if they are one object: an edited text keeps the trees of all statements that the edit
    left in their places. Whoever makes a value takes all else that it depends on from the key, or gives a
    ``before`` only where that is as it was.
    """

    def __init__(self, before: Recall | None = None) -> None:
        self._before: dict[object, _Kept] = {} if before is None else before.kept
        self.kept: dict[object, _Kept] = {}

    def value(self, name: str, make: Callable[[], _T], *things: object, key: object = None) -> _T:
        """The value called ``name`` of ``things``, made if it was not before.

        It depends on nothing else but ``key``.
        """
        place = name, key, tuple(map(id, things))
        known = self._before.get(place)
        if known is None:
            known = things, make()
        self.kept[place] = known
        value: _T = known[1]
        return value

    def get(self, name: str, *things: object, key: object = None) -> Any:
        """The value of that name that was kept of ``things``, if any."""
        known = self._before.get((name, key, tuple(map(id, things))))
        return None if known is None else known[1]

    def keep(self, value: object, name: str, *things: object, key: object = None) -> None:
        """Keep a value of ``things`` for the next text."""
        self.kept[name, key, tuple(map(id, things))] = things, value

    def forget_before(self) -> None:
        """All was asked: what was not asked for again is gone."""
        self._before = {}

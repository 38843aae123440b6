# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of an MCAP file in the order of time, of which chunks may overlap."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator
from operator import itemgetter
from typing import Any, TypeVar

_Place = TypeVar("_Place")
_Message = TypeVar("_Message", bound=tuple[Any, ...])


def in_time_order(
    places: Iterable[tuple[int, _Place]], read: Callable[[_Place], Iterable[_Message]]
) -> Iterator[_Message]:
    """Messages that ``read`` gives at each place, by stamp in ns, which they begin with.

    Places come by the stamp of their first message, which each begins with; messages of one stamp come as
    they are read. Those of one place are in memory at once, and what it overlaps.
    """
    stamp_of = itemgetter(0)
    pending: list[_Message] = []
    for first_ns, place in places:
        due = bisect_left(pending, first_ns, key=stamp_of)
        yield from pending[:due]
        pending = [*pending[due:], *read(place)]
        pending.sort(key=stamp_of)
    yield from pending

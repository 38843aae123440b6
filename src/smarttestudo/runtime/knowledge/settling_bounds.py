# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of the receiver's picture that get tighter at once, and wider when that has settled."""

from __future__ import annotations

import math
from collections.abc import Mapping

Bounds = Mapping[str, float]
"""By property; one that is missing is not bound."""


class SettlingBounds:
    """The effective bounds of a topic: of each property the tightest that was requested in ``settle_ns``.

    A request that another one replaces keeps counting for so long, unless the other is nowhere wider.
    """

    __slots__ = ("_replaced", "_request", "_settle_ns")

    def __init__(self, request: Bounds, settle_ns: int) -> None:
        self._request = request
        self._settle_ns = settle_ns
        self._replaced: list[tuple[int, Bounds]] = []

    def take(self, request: Bounds, now_ns: int) -> None:
        """The rules now request ``request``."""
        if request == self._request:
            return
        replaced = [*self._replaced, (now_ns + self._settle_ns, self._request)]
        self._request = request
        self._replaced = [one for one in replaced if not _is_within(request, one[1])]

    def effective(self, now_ns: int) -> Bounds:
        """The bounds that count at ``now_ns``, which never goes back."""
        if not self._replaced:
            return self._request
        self._replaced = [one for one in self._replaced if one[0] > now_ns]
        bounds = dict(self._request)
        for _, replaced in self._replaced:
            for name, bound in replaced.items():
                bounds[name] = min(bound, bounds.get(name, math.inf))
        return bounds

    @property
    def next_change_ns(self) -> int | None:
        """When the effective bounds may get wider by themselves."""
        return self._replaced[0][0] if self._replaced else None


def _is_within(request: Bounds, other: Bounds) -> bool:
    """Whether ``request`` is nowhere wider than ``other``."""
    return all(request.get(name, math.inf) <= bound for name, bound in other.items())

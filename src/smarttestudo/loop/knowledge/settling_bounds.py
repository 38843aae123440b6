# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of the receiver's picture that let more pass at once, and less when that has settled."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from smarttestudo.domain.decision import BoundReason, PlannedRate


class SettlingBounds:
    """The effective bounds of a topic: those that let pass all that was requested in ``settle_ns``.

    A request that another one replaces keeps counting for so long, unless the other lets as much pass. Of
    requests that count, one without any bound stands above all; else of each property the tightest.
    """

    __slots__ = ("_replaced", "_request", "_settle_ns")

    def __init__(self, request: PlannedRate, settle_ns: int) -> None:
        self._request = request
        self._settle_ns = settle_ns
        self._replaced: list[tuple[int, PlannedRate]] = []

    def on_request(self, request: PlannedRate, now_ns: int) -> None:
        """The rules now request the bounds of ``request``."""
        if request.within == self._request.within:
            self._request = request
            return
        replaced = [*self._replaced, (now_ns + self._settle_ns, self._request)]
        self._request = request
        self._replaced = [one for one in replaced if not _covers(request.within, one[1].within)]

    def effective(self, planned: PlannedRate, now_ns: int) -> PlannedRate:
        """``planned`` with the bounds that count at ``now_ns``, which never goes back."""
        self._replaced = [one for one in self._replaced if one[0] > now_ns]
        counting = [self._request, *(request for _, request in self._replaced)]
        unbound = next((one for one in counting if not one.within), None)
        within, reasons = _tightest(counting) if unbound is None else ({}, unbound.bound_reasons)
        if (planned.within, planned.bound_reasons) == (within, reasons):
            return planned
        return replace(planned, within=within, bound_reasons=reasons)

    def carried_on(self, rename: Callable[[PlannedRate], PlannedRate], settle_ns: int) -> SettlingBounds:
        """The same requests by other names, where what lets less pass waits for ``settle_ns`` from now on."""
        settling = SettlingBounds(rename(self._request), settle_ns)
        settling._replaced = [(end_ns, rename(request)) for end_ns, request in self._replaced]
        return settling

    @property
    def next_change_ns(self) -> int | None:
        """When the effective bounds may let less pass by themselves."""
        return min((end_ns for end_ns, _ in self._replaced), default=None)


def _tightest(requests: Sequence[PlannedRate]) -> tuple[dict[str, float], dict[str, BoundReason]]:
    """Of each property the tightest bound, of equals the first, with its reason."""
    within: dict[str, float] = {}
    reasons: dict[str, BoundReason] = {}
    for request in requests:
        for name, bound in request.within.items():
            if bound < within.get(name, math.inf):
                within[name] = bound
                reasons[name] = request.bound_reasons[name]
    return within, reasons


def _covers(request: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether bounds of ``request`` let pass all that those of ``other`` do; none let everything pass."""
    if not request or not other:
        return not request
    return all(request.get(name, math.inf) <= bound for name, bound in other.items())

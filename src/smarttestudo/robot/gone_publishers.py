# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Publishers of a topic that are gone, though the graph never showed them."""

from __future__ import annotations

from collections.abc import Hashable, Sequence, Set

from smarttestudo.domain.units import NS_PER_S

FOUND_WITHIN_NS = 2 * NS_PER_S
"""How long the graph may lack a publisher: its message may be received before it is discovered."""


class GonePublishers:
    """Which publishers of one topic are gone, those included that came and went between two polls."""

    __slots__ = ("_lacking",)

    def __init__(self) -> None:
        self._lacking: dict[Hashable, int] = {}

    def among(
        self, received: Sequence[Hashable], known: Set[Hashable], now_ns: int, *, is_somebody_there: bool
    ) -> list[Hashable]:
        """Publishers of ``received`` messages that the graph has lacked for long enough, at a steady time.

        It shows those that are ``known``. Where nobody is there any more, the last of ``received`` stays: it
        has the last word. So does ``None``, who stands for publishers that cannot be told apart.
        """
        lacking = (one for one in received if one is not None and one not in known)
        self._lacking = {one: self._lacking.get(one, now_ns) for one in lacking}
        staying = () if is_somebody_there else received[-1:]
        return [
            one
            for one, since_ns in self._lacking.items()
            if one not in staying and now_ns - since_ns >= FOUND_WITHIN_NS
        ]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Raise at once, lower when settled."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from smarttestudo.adirf.evaluator import Wish


class Settling:
    """The effective wish of a topic: the one with the greatest rate of the last ``settle_ns``.

    A wish that another one replaces keeps counting for ``settle_ns``, and so a lower rate takes effect when
    nothing higher was wished for so long. Among equal rates the latest wish counts, with its reason. It is a
    sliding-window maximum by a monotonic queue: rates fall from the front, the effective wish, to the back,
    the current one.
    """

    __slots__ = ("_replaced", "_settle_ns", "_wish")

    def __init__(self, wish: Wish, settle_ns: int) -> None:
        self._settle_ns = settle_ns
        self._wish = wish
        self._replaced: deque[tuple[int, Wish]] = deque()

    def take(self, wish: Wish, now_ns: int) -> None:
        """The rules now ask for ``wish``."""
        self._replaced.append((now_ns + self._settle_ns, self._wish))
        self._wish = wish
        while self._replaced and self._replaced[-1][1].planned.rate <= wish.planned.rate:
            self._replaced.pop()

    def effective(self, now_ns: int) -> Wish:
        """The wish that counts at ``now_ns``, which never goes back."""
        while self._replaced and self._replaced[0][0] <= now_ns:
            self._replaced.popleft()
        return self._replaced[0][1] if self._replaced else self._wish

    def carried_on(self, rename: Callable[[Wish], Wish], settle_ns: int) -> Settling:
        """The same wishes by other names, where lower rates wait for ``settle_ns`` from now on."""
        settling = Settling(rename(self._wish), settle_ns)
        settling._replaced.extend((end_ns, rename(wish)) for end_ns, wish in self._replaced)
        return settling

    @property
    def next_change_ns(self) -> int | None:
        """When the effective wish ends by itself; ``None`` if it is the current one."""
        return self._replaced[0][0] if self._replaced else None

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines of a log that are worth no second one."""

from __future__ import annotations

from collections.abc import Callable


class SayOnce:
    """Says each line once by ``say``; of lines that others make up, ``most`` are said."""

    __slots__ = ("_most", "_said", "_say")

    def __init__(self, say: Callable[[str], None], *, most: int | None = None) -> None:
        self._say = say
        self._most = most
        self._said: set[str] = set()

    def __call__(self, line: str) -> None:
        """Say it, unless it was said."""
        if line not in self._said and (self._most is None or len(self._said) < self._most):
            self._said.add(line)
            self._say(line)

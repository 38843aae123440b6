# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The bound on an analysis."""

from __future__ import annotations


class TooComplexError(Exception):
    """A question that was given up because its effort was spent."""


class Effort:
    """What may still be spent, in looks at one region (about a microsecond each).

    Spending goes to ``parent`` as well, so that many questions share a common bound.
    """

    __slots__ = ("_left", "_parent")

    def __init__(self, looks: int, parent: Effort | None = None) -> None:
        self._left = looks
        self._parent = parent

    def spend(self, looks: int) -> None:
        """Count ``looks``; raises ``TooComplexError`` when there were not as many left."""
        effort: Effort | None = self
        while effort is not None:
            effort._left -= looks  # noqa: SLF001 - of the same class
            if effort._left < 0:  # noqa: SLF001
                raise TooComplexError
            effort = effort._parent  # noqa: SLF001

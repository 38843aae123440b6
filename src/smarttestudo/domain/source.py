# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Places in a text file."""

from __future__ import annotations

from typing import NamedTuple


class Span(NamedTuple):
    """A stretch of text; lines and columns count from 1, the end column is one past the last character.

    A tuple, because reading a file makes one for each of its words.
    """

    line: int
    column: int
    end_line: int
    end_column: int

    def to(self, last: Span) -> Span:
        """The stretch from the start of this span to the end of ``last``."""
        return Span(self.line, self.column, last.end_line, last.end_column)

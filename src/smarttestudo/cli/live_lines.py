# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines at the bottom of a terminal that are written anew again and again, and stay at the end."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from typing import TextIO

from smarttestudo.cli.tables import write_text

_ERASE_TO_END_OF_LINE = "\x1b[K"
_ERASE_BELOW = "\x1b[J"


def live_lines(stream: TextIO) -> Callable[[Sequence[str]], None]:
    """What writes lines to the terminal ``stream`` in place of those of the last call."""
    shown = 0

    def show(lines: Sequence[str]) -> None:
        nonlocal shown
        fitting = cropped(lines, *shutil.get_terminal_size())
        if shown:
            stream.write(f"\x1b[{shown}A\r")
        for line in fitting:
            stream.write(_ERASE_TO_END_OF_LINE)
            write_text(line, stream)
        stream.write(_ERASE_BELOW)
        stream.flush()
        shown = len(fitting)

    return show


def cropped(lines: Sequence[str], columns: int, height: int) -> list[str]:
    """As many ``lines`` as fit above the cursor, none too long; the last says how many are missing."""
    rows = max(height - 1, 1)
    if len(lines) > rows:
        lines = [*lines[: rows - 1], f"… {len(lines) - rows + 1} more lines: a taller window, or --fields"]
    return [line if len(line) < columns else line[: max(columns - 2, 0)] + "…" for line in lines]

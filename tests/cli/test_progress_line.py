# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A line that changes stays one line of a terminal, whatever its width."""

from __future__ import annotations

import fcntl
import os
import pty
import struct
import termios
from collections.abc import Callable
from contextlib import suppress
from typing import TextIO

import pytest

from smarttestudo.cli.incidents import progress_line
from smarttestudo.cli.output import written_over
from smarttestudo.domain.incident import FetchProgress

FETCH = FetchProgress(
    got_bytes=12_000_000,
    total_bytes=1_234_560_000,
    waits_for="a part of the link that topics leave unused",
)


def rows_shown(columns: int, show: Callable[[TextIO], None]) -> list[str]:
    """What ``show`` wrote, one text for each time that the row was erased."""
    controller, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    with os.fdopen(terminal, "w", encoding="utf-8") as stream:
        show(stream)
    shown = bytearray()
    with os.fdopen(controller, "rb", buffering=0) as screen, suppress(OSError):
        # The end of what a terminal shows is an error on Linux.
        while more := screen.read(4096):
            shown += more
    return shown.decode("utf-8").split("\r\x1b[K")[1:]


def fetch(stream: TextIO) -> None:
    with progress_line(stream) as show:
        show(FETCH)


def test_a_fetch_is_shown_whole_where_a_terminal_has_80_columns() -> None:
    line = "1 % of 1234.56 MB, waits for a part of the link that topics leave unused"
    assert rows_shown(80, fetch) == [line, ""]


@pytest.mark.parametrize("columns", [1, 2, 20, 40])
def test_where_it_has_fewer_the_line_is_cut_and_never_goes_on_in_another_row(columns: int) -> None:
    line, end = rows_shown(columns, fetch)
    assert line == "1 % of 1234.56 MB, waits for a part of the link"[: max(columns - 2, 0)] + "…"
    assert end == ""


def test_where_nobody_knows_its_width_it_is_taken_to_have_80_columns() -> None:
    assert rows_shown(0, lambda stream: written_over(stream)("x" * 100)) == ["x" * 78 + "…"]

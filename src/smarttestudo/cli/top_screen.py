# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines that are shown anew again and again: in place with rich, one after the other everywhere else."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from smarttestudo.cli.tables import is_unicode, write_text
from smarttestudo.cli.top_table import Line, Look

Show = Callable[[Sequence[Line]], None]

_STYLES = {
    Look.HEADING: "bold",
    Look.PLAIN: "",
    Look.QUIET: "dim",
    Look.WARN: "yellow",
    Look.ERROR: "bold red",
    Look.STALE: "magenta",
}


@contextmanager
def open_screen() -> Iterator[Show]:
    """What shows lines on standard output; a terminal's own content is back at the end."""
    if sys.stdout.isatty() and is_unicode(sys.stdout):
        try:
            import rich.live  # noqa: F401, PLC0415  a robot has no rich
        except ModuleNotFoundError:
            pass
        else:
            with _rich_screen() as show:
                yield show
            return
    yield print_lines


def print_lines(lines: Sequence[Line]) -> None:
    """Write ``lines`` and an empty one to standard output."""
    write_text("".join(f"{line.text}\n" for line in lines), sys.stdout)
    sys.stdout.flush()


@contextmanager
def _rich_screen() -> Iterator[Show]:
    from rich.console import Console  # noqa: PLC0415
    from rich.live import Live  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    console = Console(highlight=False, markup=False, emoji=False)
    with Live(console=console, screen=True, auto_refresh=False) as live:

        def show(lines: Sequence[Line]) -> None:
            text = Text(no_wrap=True, overflow="ellipsis")
            for line in cropped(lines, console.height):
                text.append(f"{line.text}\n", style=_STYLES[line.look])
            text.right_crop(1)
            live.update(text, refresh=True)

        yield show


def cropped(lines: Sequence[Line], height: int) -> Sequence[Line]:
    """``lines``, as many as fit; the last one says how many are missing."""
    if len(lines) <= height:
        return lines
    hidden = len(lines) - height + 1
    return [*lines[: height - 1], Line(f"… {hidden} more lines: a taller window, or --sort", Look.QUIET)]

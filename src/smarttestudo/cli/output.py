# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How commands write: all text for people leaves here, and none of it commands the terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TextIO

from smarttestudo.cli.terminal import is_unicode
from smarttestudo.domain.texts import visible

_ASCII = str.maketrans({"–": "-", "−": "-", "─": "-", "…": "~"})


def write_line(text: str = "", stream: TextIO | None = None) -> None:
    """Write ``text`` as one line to ``stream`` (default: standard output), whatever is in it."""
    write_styled(f"{visible(text)}\n", stream)


def write_lines(lines: Iterable[str], stream: TextIO | None = None) -> None:
    write_styled("".join(f"{visible(line)}\n" for line in lines), stream)


def write_file_text(text: str, stream: TextIO | None = None) -> None:
    """Write what a file could hold: as it is into a file or a pipe, and as lines for people on a terminal."""
    stream = stream or sys.stdout
    if stream.isatty():
        text = "\n".join("\t".join(map(visible, line.split("\t"))) for line in text.split("\n"))
    write_styled(text, stream)


def write_styled(text: str, stream: TextIO | None = None) -> None:
    """Write ``text`` with control characters of our own; all others in it are ``visible`` already.

    Characters that the stream's encoding lacks are replaced.
    """
    stream = stream or sys.stdout
    if not is_unicode(stream):
        text = text.translate(_ASCII).encode(stream.encoding, "replace").decode(stream.encoding)
    stream.write(text)


Report = Callable[[float], None]
"""Takes the share of the work done, 0 … 1."""

Progress = Callable[[str], AbstractContextManager[Report]]
"""Shows how far the work of that name is."""

_ERASE_LINE = "\r\x1b[K"
_USUAL_COLUMNS = 80


def written_over(stream: TextIO) -> Callable[[str], None]:
    """Function that writes a text to the terminal ``stream`` in place of the last one, cut to one row."""

    def write(text: str) -> None:
        # What goes on in the next row is not erased.
        text, most = visible(text), max(_columns(stream) - 1, 1)
        if len(text) > most:
            text = text[: most - 1] + ("…" if is_unicode(stream) else "~")
        write_styled(f"{_ERASE_LINE}{text}", stream)
        stream.flush()

    return write


def _columns(stream: TextIO) -> int:
    try:
        return os.get_terminal_size(stream.fileno()).columns or _USUAL_COLUMNS
    except OSError:
        return _USUAL_COLUMNS


@contextmanager
def progress(label: str, stream: TextIO | None = None) -> Iterator[Report]:
    """Show on ``stream`` (default: standard error) how far the work ``label`` is; erased at the end."""
    stream = stream or sys.stderr
    if not stream.isatty():
        with silent(label) as report:
            yield report
        return
    try:
        from rich.progress import Progress  # noqa: F401, PLC0415  a robot has no rich
    except ModuleNotFoundError:
        shown = _plain(label, stream)
    else:
        shown = _rich(label, stream)
    with shown as report:
        yield report


@contextmanager
def silent(_label: str) -> Iterator[Report]:
    """Show nothing: nobody watches."""
    yield lambda _share: None


@contextmanager
def _plain(label: str, stream: TextIO) -> Iterator[Report]:
    shown = -1
    write = written_over(stream)

    def report(share: float) -> None:
        nonlocal shown
        percent = int(100 * share)
        if percent != shown:
            shown = percent
            write(f"{label} {percent} %")

    try:
        yield report
    finally:
        write("")


@contextmanager
def _rich(label: str, stream: TextIO) -> Iterator[Report]:
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn  # noqa: PLC0415

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(file=stream), transient=True) as bars:
        bar = bars.add_task(visible(label), total=1.0)
        yield lambda share: bars.update(bar, completed=share)

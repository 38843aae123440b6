# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How commands write: all text for people leaves here, and none of it commands the terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable
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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How the pages of a SQLite file begin: enough to tell leaves from the rest, and to follow long rows."""

from __future__ import annotations

import sys
from array import array
from typing import Protocol

_READ_BYTES = 1 << 20
_WORD_BYTES = 4


class PageFile(Protocol):
    """What pages are read from."""

    def seek(self, offset: int, whence: int = ..., /) -> int:
        """Go to ``offset``; tell where that is."""

    def read(self, size_bytes: int, /) -> bytes:
        """The next ``size_bytes``, fewer where there are no more."""


def page_heads(file: PageFile, *, file_bytes: int, page_bytes: int) -> array[int]:
    """The first four bytes of every page as a big-endian number; 0 for a page that is missing.

    The file is read once in large pieces, and four bytes of memory are kept for each page: a row of
    megabytes is a chain of pages, and asking for each of its links takes longer than reading it all.
    """
    heads = array("I")
    start = 0
    while start < file_bytes:
        file.seek(start)
        data = file.read(max(_READ_BYTES, page_bytes))
        words = array("I", data[: len(data) // _WORD_BYTES * _WORD_BYTES])
        heads.extend(words[:: page_bytes // _WORD_BYTES] or array("I", [0]))
        start = len(heads) * page_bytes
    if sys.byteorder == "little":
        heads.byteswap()
    return heads

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How the pages of a SQLite file begin: enough to tell leaves from the rest, and to follow long rows."""

from __future__ import annotations

from array import array
from typing import Protocol

import numpy as np

_READ_BYTES = 1 << 20
_HEAD = np.dtype(">u4")


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
        links = np.frombuffer(data, _HEAD, count=len(data) // _HEAD.itemsize)[:: page_bytes // _HEAD.itemsize]
        heads.extend(links.tolist() or [0])
        start = len(heads) * page_bytes
    return heads

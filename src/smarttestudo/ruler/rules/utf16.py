# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Offsets as JavaScript counts them."""

from __future__ import annotations

from bisect import bisect_left

_LAST_SINGLE = "\uffff"


class Utf16:
    """Turns offsets into ``text`` from characters to UTF-16 code units, and back."""

    def __init__(self, text: str) -> None:
        is_wide = not text.isascii() and max(text) > _LAST_SINGLE
        self._pairs = [at for at, character in enumerate(text) if character > _LAST_SINGLE] if is_wide else []

    def offset(self, characters: int) -> int:
        """The code units before the character number ``characters``."""
        return characters + bisect_left(self._pairs, characters)

    def characters(self, offset: int) -> int:
        """The characters before the code unit number ``offset``; within a pair, those before the pair."""
        ends = (at + number + 1 for number, at in enumerate(self._pairs))
        return offset - sum(end <= offset for end in ends)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Texts that come and leave in UTF-8."""

from __future__ import annotations

BYTE_ORDER_MARK = "\ufeff"


def without_mark(text: str) -> tuple[str, str]:
    """The byte order mark in front of ``text``, "" where there is none, and the rest."""
    rest = text.removeprefix(BYTE_ORDER_MARK)
    return text[: len(text) - len(rest)], rest


def in_utf_8(text: str) -> str:
    """``text`` with a ``?`` for each thing that UTF-8 cannot say, such as a byte of a strange file name."""
    return text if text.isascii() else text.encode("utf-8", "replace").decode()

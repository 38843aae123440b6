# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Texts that leave this program in UTF-8."""

from __future__ import annotations


def in_utf_8(text: str) -> str:
    """``text`` with a ``?`` for each thing that UTF-8 cannot say, such as a byte of a strange file name."""
    return text if text.isascii() else text.encode("utf-8", "replace").decode()

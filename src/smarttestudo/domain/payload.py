# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Serialized messages, wherever they are kept."""

from __future__ import annotations

from typing import Protocol


class Payload(Protocol):
    """The bytes of a serialized message: ``bytes`` itself, or a buffer of the middleware.

    Its content never changes while somebody holds it. ``payload[a:b]`` copies a part, and ``payload[:]``,
    unless it is ``bytes``, all of it: a large message is copied only where somebody looks.
    """

    def __len__(self) -> int:
        """How many bytes it has."""

    def __getitem__(self, part: slice, /) -> bytes:
        """The bytes of ``part``."""

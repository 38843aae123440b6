# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Units used everywhere: nanoseconds for stamps, hertz for rates, KB of 1000 bytes for sizes."""

from __future__ import annotations

NS_PER_S = 1_000_000_000
BYTES_PER_KB = 1000


def ns_from_s(seconds: float) -> int:
    """Nanoseconds nearest to ``seconds``."""
    return round(seconds * NS_PER_S)

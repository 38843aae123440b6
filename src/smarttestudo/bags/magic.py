# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What storage files begin with, and how they are named."""

from __future__ import annotations

MCAP = b"\x89MCAP0\r\n"
SQLITE = b"SQLite format 3\0"
ZSTD = b"\x28\xb5\x2f\xfd"
"""Also what a message begins with that is packed alone."""
ZSTD_SUFFIX = ".zstd"

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""First bytes of storage files, and the suffix of packed ones."""

from __future__ import annotations

MCAP = b"\x89MCAP0\r\n"
SQLITE = b"SQLite format 3\0"
ZSTD = b"\x28\xb5\x2f\xfd"
"""Messages that are packed one by one begin with it, too."""
ZSTD_SUFFIX = ".zstd"

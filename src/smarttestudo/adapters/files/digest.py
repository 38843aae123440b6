# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fingerprints of files."""

from __future__ import annotations

import hashlib
from pathlib import Path

from smarttestudo.domain.errors import TestudoError


def sha256_of(path: Path) -> str:
    """The SHA-256 of the file at ``path`` in hexadecimal; ``TestudoError`` where it cannot be read."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        cause = f"the file cannot be read: {error.strerror}"
        raise TestudoError(cause, place=str(path), remedy="check the path and its permissions") from error

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names of files and folders that a page may see and give."""

from __future__ import annotations

import re
import unicodedata

_DRIVE = re.compile(r"[A-Za-z]:")
_UNSHOWN = frozenset({"Cc", "Cs", "Zl", "Zp"})
_SKIPPED = frozenset({"node_modules", "__pycache__", "build", "install", "log"})


def is_nameable(name: str) -> bool:
    """Whether a page may name a file or folder so: one line of text that means the same path everywhere.

    It has no control characters, which neither a page nor a log can show, and names no drive.
    """
    is_one_line = not any(unicodedata.category(one) in _UNSHOWN for one in name)
    return is_one_line and "\\" not in name and not _DRIVE.match(name)


def is_shown(name: str) -> bool:
    """Whether files of a folder of this name are shown."""
    return not name.startswith(".") and name not in _SKIPPED

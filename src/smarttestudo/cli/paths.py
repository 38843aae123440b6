# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names of files and folders on the command line."""

from __future__ import annotations

import argparse
import os
from pathlib import Path


def file_path(text: str) -> Path:
    """A path from the command line; ``ArgumentTypeError`` for an empty one, which would be this folder."""
    if not text:
        raise argparse.ArgumentTypeError("the name of a file or folder is not empty")
    return Path(text)


def own_name(path: Path) -> str:
    """Own name of the file or folder at ``path``, also where that is ``.`` or a link."""
    return Path(os.path.realpath(path)).name

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values from the command line: files and budgets."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from smarttestudo.domain import profile


def file_path(text: str) -> Path:
    """A path from the command line; ``ArgumentTypeError`` for an empty one, which would be this folder."""
    if not text:
        raise argparse.ArgumentTypeError("the name of a file or folder is not empty")
    return Path(text)


def own_name(path: Path) -> str:
    """Own name of the file or folder at ``path``, also where that is ``.`` or a link."""
    return Path(os.path.realpath(path)).name


def budget_kb_per_s(text: str) -> float:
    """A budget from the command line; ``ArgumentTypeError`` for anything but a number of KB/s."""
    try:
        return profile.budget_kb_per_s(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A budget on the command line."""

from __future__ import annotations

import argparse

from smarttestudo.domain import profile


def budget_kb_per_s(text: str) -> float:
    """A budget from the command line; ``ArgumentTypeError`` for anything but a number of KB/s."""
    try:
        return profile.budget_kb_per_s(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error

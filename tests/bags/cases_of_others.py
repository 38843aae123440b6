# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The table of recordings that others made."""

from __future__ import annotations

from bags.like_real_recordings import LIKE_REAL_ONES
from bags.lossy_recordings import LOSSY_ONES
from bags.odd_recordings import ODD_ONES

CASES = (*LIKE_REAL_ONES, *ODD_ONES, *LOSSY_ONES)

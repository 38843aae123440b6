# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Interval analysis: where conditions hold, as boxes over signals."""

from smarttestudo.language.boxes.box import (
    Border,
    Box,
    Domain,
    Effort,
    TooComplexError,
    border_between,
    common_box,
)
from smarttestudo.language.boxes.index import BoxIndex, Hull, IndexEntry, hull_of
from smarttestudo.language.boxes.search import boxes_where, find_box

__all__ = [
    "Border",
    "Box",
    "BoxIndex",
    "Domain",
    "Effort",
    "Hull",
    "IndexEntry",
    "TooComplexError",
    "border_between",
    "boxes_where",
    "common_box",
    "find_box",
    "hull_of",
]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which figures there are."""

from __future__ import annotations

from enum import Enum


class FigureKind(Enum):
    """The kinds of figures; the value is a file's name."""

    RATES = "rates"
    BANDWIDTH = "bandwidth"
    TOTAL = "total"
    INTERVALS = "intervals"
    ACCURACY = "accuracy"
    PATH = "path"

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page calls true, false and unknown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from smarttestudo.domain.signal import Truth

TruthName = Literal["true", "false", "unknown"]
_NAMES: Mapping[Truth, TruthName] = {
    Truth.TRUE: "true",
    Truth.FALSE: "false",
    Truth.UNKNOWN: "unknown",
}


def truth_name(truth: Truth) -> TruthName:
    """The name of ``truth``."""
    return _NAMES[truth]

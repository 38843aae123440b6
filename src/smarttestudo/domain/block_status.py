# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which conditions hold in a live runtime."""

from __future__ import annotations

from dataclasses import dataclass

from smarttestudo.domain.signal import Truth


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckStatus:
    """One check at its place in the text; ``value`` is what it reads now, ``None`` while that is unknown.

    ``state`` is that of the check alone, also below a Not.
    """

    line: int
    column: int
    state: Truth
    value: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockStatus:
    """The condition of one If, at its place in the rule file number ``file``, with its checks in order."""

    file: int
    line: int
    column: int
    state: Truth
    checks: tuple[CheckStatus, ...]

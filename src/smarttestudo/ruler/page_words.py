# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The words of the page for what a profile lacks, where it is a table and no TOML."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from smarttestudo.domain.errors import ProfileError, TestudoError
from smarttestudo.optimizer.model import MissingEntryError

COLUMNS: Mapping[str, str] = MappingProxyType(
    {
        "message_kb": "Message size (KB)",
        "tiers_hz": "the six levels (Hz)",
        "source_hz": "Source (Hz)",
        "max_hz": "Source (Hz)",
    }
)
"""What the table of topic parameters calls an entry."""


def in_page_words(error: TestudoError) -> TestudoError:
    """``error`` with a remedy that is possible on the page."""
    if not isinstance(error, MissingEntryError):
        return error
    if error.topic is None:
        cause = "the topic parameters do not say how much the link carries"
        return ProfileError(
            cause, place=error.place, remedy="fill in the budget, Total bandwidth (KB/s), above their table"
        )
    if error.key is None:
        cause = f"{error.topic} is in the rules but not in the chosen profile"
        remedy = f"add a row for {error.topic} to its table, or choose another profile on the right"
        return ProfileError(cause, place=error.place, remedy=remedy)
    cause = f"the topic parameters do not say all that is needed of {error.topic}"
    remedy = f"fill in {COLUMNS[error.key]} in its row of their table"
    return ProfileError(cause, place=error.place, remedy=remedy)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sizes that a bag declares for messages it holds in small."""

from __future__ import annotations

import json
from collections.abc import Mapping

from smarttestudo.domain.errors import RecordingError

DECLARED_BYTES_KEY = "smarttestudo.declared_bytes"


def declared_bytes_in(custom_data: Mapping[str, str]) -> dict[str, int]:
    """Bytes per message by topic, as the bag's ``custom_data`` declares them.

    Raises ``RecordingError`` for an entry that does not map topics to whole numbers of bytes.
    """
    text = custom_data.get(DECLARED_BYTES_KEY)
    if text is None:
        return {}
    try:
        declared = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"its {DECLARED_BYTES_KEY} is not JSON") from error
    if not isinstance(declared, dict) or not all(_is_size(size) for size in declared.values()):
        raise RecordingError(f"its {DECLARED_BYTES_KEY} does not map topics to bytes")
    return declared


def with_declared_bytes(custom_data: Mapping[str, str], declared_bytes: Mapping[str, int]) -> dict[str, str]:
    """``custom_data`` with ``declared_bytes`` in it, in place of what it declared before."""
    kept = {key: value for key, value in custom_data.items() if key != DECLARED_BYTES_KEY}
    if declared_bytes:
        kept[DECLARED_BYTES_KEY] = json.dumps(dict(declared_bytes), sort_keys=True)
    return kept


def _is_size(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0

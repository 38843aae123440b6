# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which conditions hold, as JSON, there and back: in few bytes, since it goes over the robot's radio."""

from __future__ import annotations

import math

from smarttestudo.domain.block_status import BlockStatus, CheckStatus
from smarttestudo.domain.signal import Truth

_NAMES = {Truth.FALSE: "false", Truth.UNKNOWN: "unknown", Truth.TRUE: "true"}
_TRUTHS = {name: truth for truth, name in _NAMES.items()}
_DIGITS = 6
_CHECK_ENTRIES = 4


def block_to_json(block: BlockStatus) -> dict[str, object]:
    """An object whose ``checks`` are ``[line, column, state, value]`` each."""
    return {
        "file": block.file,
        "line": block.line,
        "column": block.column,
        "state": _NAMES[block.state],
        "checks": [
            [check.line, check.column, _NAMES[check.state], _shortened(check.value)] for check in block.checks
        ],
    }


def blocks_from_json(record: object) -> tuple[BlockStatus, ...]:
    """The blocks of a stranger's JSON, without those that are not understood."""
    blocks = (_block(entry) for entry in record) if isinstance(record, list) else ()
    return tuple(block for block in blocks if block is not None)


def _block(record: object) -> BlockStatus | None:
    if not isinstance(record, dict):
        return None
    file, line, column = (_count(record.get(name)) for name in ("file", "line", "column"))
    state, checks = _truth(record.get("state")), record.get("checks")
    if file is None or line is None or column is None or state is None or not isinstance(checks, list):
        return None
    read = [_check(check) for check in checks]
    known = tuple(check for check in read if check is not None)
    return BlockStatus(file=file, line=line, column=column, state=state, checks=known)


def _check(record: object) -> CheckStatus | None:
    if not isinstance(record, list) or len(record) < _CHECK_ENTRIES:
        return None
    line, column, state = _count(record[0]), _count(record[1]), _truth(record[2])
    value = record[3]
    if line is None or column is None or state is None:
        return None
    return CheckStatus(line=line, column=column, state=state, value=_number(value))


def _number(value: object) -> float | None:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return None
    try:
        return float(value)
    except OverflowError:
        return None


def _truth(name: object) -> Truth | None:
    return _TRUTHS.get(name) if isinstance(name, str) else None


def _count(number: object) -> int | None:
    return number if isinstance(number, int) and not isinstance(number, bool) else None


def _shortened(value: float | None) -> float | None:
    """For reading; infinite values are none that JSON has."""
    return None if value is None or not math.isfinite(value) else float(f"{value:.{_DIGITS}g}")

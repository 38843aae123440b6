# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The conditions in a runtime's status as JSON, there and back: in few bytes."""

from __future__ import annotations

import math

from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import BlockStatus, CheckStatus, TimeStatus

_NAMES = {Truth.FALSE: "false", Truth.UNKNOWN: "unknown", Truth.TRUE: "true"}
_TRUTHS = {name: truth for truth, name in _NAMES.items()}
_DIGITS = 6
_PLACED_ENTRIES = 4


def block_to_json(block: BlockStatus) -> dict[str, object]:
    """An object whose ``checks`` are ``[line, column, state, value]`` each; ``held_s`` if it is told.

    ``times``, where there are some, are ``[line, column, state, held_s]`` each.
    """
    held: dict[str, object] = {} if block.held_s is None else {"held_s": round(block.held_s, 3)}
    if block.times:
        held["times"] = [
            [
                time.line,
                time.column,
                _NAMES[time.state],
                None if time.held_s is None else round(time.held_s, 3),
            ]
            for time in block.times
        ]
    return {
        "file": block.file,
        "line": block.line,
        "column": block.column,
        "state": _NAMES[block.state],
        "checks": [
            [check.line, check.column, _NAMES[check.state], _shortened(check.value)] for check in block.checks
        ],
        **held,
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
    return BlockStatus(
        file=file,
        line=line,
        column=column,
        state=state,
        checks=known,
        held_s=_number(record.get("held_s")),
        times=_times(record.get("times")),
    )


def _check(record: object) -> CheckStatus | None:
    found = _placed(record)
    if found is None:
        return None
    line, column, state, value = found
    return CheckStatus(line=line, column=column, state=state, value=value)


def _times(record: object) -> tuple[TimeStatus, ...]:
    found = [_placed(entry) for entry in record] if isinstance(record, list) else []
    return tuple(
        TimeStatus(line=one[0], column=one[1], state=one[2], held_s=one[3])
        for one in found
        if one is not None
    )


def _placed(record: object) -> tuple[int, int, Truth, float | None] | None:
    """A line, a column, a state and a number."""
    if not isinstance(record, list) or len(record) < _PLACED_ENTRIES:
        return None
    line, column, state = _count(record[0]), _count(record[1]), _truth(record[2])
    if line is None or column is None or state is None:
        return None
    return line, column, state, _number(record[3])


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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a child process of the Ruler speaks: one JSON object on its input, lines of JSON on its output.

Each line is an object whose ``kind`` is ``progress`` (``share``), ``result`` (``result``) or ``error``
(``message``, ``place``, ``remedy``).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from typing import Any

from smarttestudo.domain.errors import TestudoError

Report = Callable[[float], None]
_MIN_STEP = 0.01


def answer_order(work: Callable[[dict[str, Any], Report], object]) -> int:
    """Do what standard input asks for and say the result; the exit code of the process."""
    order: dict[str, Any] = json.load(sys.stdin)
    try:
        result = work(order, _Reporter())
    except TestudoError as error:
        _say(kind="error", message=error.cause, place=error.place, remedy=error.remedy)
        return 1
    _say(kind="result", result=result)
    return 0


class _Reporter:
    """Says how far it is, a hundred times at most."""

    def __init__(self) -> None:
        self._said = 0.0

    def __call__(self, share: float) -> None:
        if share >= self._said + _MIN_STEP:
            self._said = share
            _say(kind="progress", share=round(min(share, 1.0), 3))


def _say(**record: object) -> None:
    sys.stdout.write(json.dumps(record, allow_nan=False) + "\n")
    sys.stdout.flush()

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a process of the Ruler's says to the server: a line of JSON at a time."""

from __future__ import annotations

import json
from typing import TextIO

_MIN_STEP = 0.01


class Reporter:
    """Says how far it is, a hundred times at most."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._said = 0.0

    def __call__(self, share: float) -> None:
        """``share`` of the work is done."""
        if share >= self._said + _MIN_STEP:
            self._said = share
            say(self._stream, kind="progress", share=round(min(share, 1.0), 3))


def say(stream: TextIO, **record: object) -> None:
    """Write one line of JSON."""
    stream.write(json.dumps(record, allow_nan=False) + "\n")
    stream.flush()

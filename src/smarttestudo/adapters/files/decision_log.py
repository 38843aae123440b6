# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions on disk: JSON Lines."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from smarttestudo.adapters.files.whole_file import whole_file
from smarttestudo.domain.decision import Decision


@contextmanager
def decision_log(path: Path) -> Iterator[Callable[[Iterable[Decision]], None]]:
    """What the block is given appends decisions; the log appears at ``path`` once the block ends well.

    Raises ``OutputFileError`` where that is not possible, before the block if it is known by then.
    """
    with whole_file(path, "the decision log") as write:
        yield lambda decisions: write("".join(f"{_line(decision)}\n" for decision in decisions))


def _line(decision: Decision) -> str:
    return json.dumps(decision.to_json(), ensure_ascii=False, allow_nan=False)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions on disk: JSON Lines."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import TestudoError


class DecisionLogError(TestudoError):
    """A decision log that cannot be written."""


@contextmanager
def decision_log(path: Path) -> Iterator[Callable[[Iterable[Decision]], None]]:
    """What the block is given appends decisions; the log appears at ``path`` once the block ends well.

    Raises ``DecisionLogError`` where that is not possible, before the block if it is known by then.
    """
    with _errors_at(path):
        if path.is_dir():
            raise IsADirectoryError(None, "it is a folder")
        handle, name = tempfile.mkstemp(prefix=f".{path.name}-", suffix=".partial", dir=path.parent)
    workshop = Path(name)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:

            def append(decisions: Iterable[Decision]) -> None:
                with _errors_at(path):
                    file.writelines(f"{_line(decision)}\n" for decision in decisions)

            yield append
            with _errors_at(path):
                file.flush()
        with _errors_at(path):
            workshop.chmod(0o666 & ~_umask())
            workshop.replace(path)
    finally:
        with suppress(OSError):
            workshop.unlink(missing_ok=True)


def _line(decision: Decision) -> str:
    return json.dumps(decision.to_json(), ensure_ascii=False, allow_nan=False)


def _umask() -> int:
    # There is no way to ask for it without setting it.
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextmanager
def _errors_at(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        cause = f"the decision log cannot be written: {error.strerror or error}"
        raise DecisionLogError(cause, place=str(path), remedy="name another file") from error

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions on disk: JSON Lines."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from smarttestudo.domain.decision import AnyDecision, Decision, about_rates, decision_from_json
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.json_text import json_text
from smarttestudo.files.input_file import read_input
from smarttestudo.files.whole_file import OutputFileError, not_written, whole_file

_CONTENT = "the decision log"
_LINE_START = b'{"t":'
_T_NS = 1000
"""What a file's ``t``, in microseconds, cannot tell apart."""
_MAX_LINE_BYTES = 1 << 20
_CUT_OFF = "cut off, as where the run was killed, its disk was full or it goes on; what follows is not known"


class DecisionLogError(TestudoError):
    """A decision log that cannot be read."""


@contextmanager
def decision_log(path: Path) -> Iterator[Callable[[Iterable[AnyDecision]], None]]:
    """Write a log of decisions: the block is given a function that appends decisions.

    The log appears at ``path`` once the block ends well. It takes the place of another log, but of no other
    file: that may be what the decisions come from. Raises ``OutputFileError`` where that is not possible,
    before the block if it is known by then.
    """
    _require_no_other(path)
    with whole_file(path, _CONTENT) as write:
        yield lambda decisions: write("".join(f"{decision_text(decision)}\n" for decision in decisions))


@contextmanager
def growing_decision_log(path: Path) -> Iterator[Callable[[Iterable[AnyDecision]], None]]:
    """Append to a log of decisions: the block is given a function that writes decisions to ``path`` at once.

    A crash loses none. Half a decision, with which a full disk or a power loss ended the log, is cut off.
    Raises ``OutputFileError`` where that is not possible, and for a file with something else than decisions.
    """
    _require_no_other(path)
    try:
        _cut_half_a_line(path)
        file = path.open("a", encoding="utf-8")
    except OSError as error:
        raise not_written(path, _CONTENT, error) from error

    def append(decisions: Iterable[AnyDecision]) -> None:
        try:
            file.write("".join(f"{decision_text(decision)}\n" for decision in decisions))
            file.flush()
        except OSError as error:
            raise not_written(path, _CONTENT, error) from error

    try:
        yield append
    finally:
        # What could not be written was said when it failed.
        with suppress(OSError):
            file.close()


def _require_no_other(path: Path) -> None:
    """Raise ``OutputFileError`` where there is a file with something else than decisions."""
    try:
        if not path.is_file():
            return
        with path.open("rb") as file:
            first = file.readline(_MAX_LINE_BYTES)
    except OSError as error:
        raise not_written(path, _CONTENT, error) from error
    if not _is_first_of_log(first):
        cause = f"{_CONTENT} cannot be written: the file there holds something else"
        raise OutputFileError(cause, place=str(path), remedy="name another output, or remove it")


def _is_first_of_log(line: bytes) -> bool:
    if not line.endswith(b"\n"):
        return _is_half_a_decision(line)
    try:
        decision_from_json(json.loads(line))
    except (ValueError, RecursionError):
        return False
    return True


def _is_half_a_decision(line: bytes) -> bool:
    """Whether ``line`` is what a full disk or a power loss, which leaves zeros, makes of a decision."""
    begun = line.rstrip(b"\0")[: len(_LINE_START)]
    return begun == _LINE_START[: len(begun)]


def _cut_half_a_line(path: Path) -> None:
    if not path.is_file():
        return
    with path.open("r+b") as file:
        end = file.seek(0, os.SEEK_END)
        start = max(0, end - _MAX_LINE_BYTES)
        file.seek(start)
        last = file.read()
        line_start = last.rfind(b"\n") + 1
        if line_start < len(last) and _is_half_a_decision(last[line_start:]):
            file.truncate(start + line_start)


def read_decisions(path: Path, noticed: Callable[[str], None] | None = None) -> list[Decision]:
    """The decisions about topics in the file at ``path``; see ``read_all_decisions``."""
    return about_rates(read_all_decisions(path, noticed))


def read_all_decisions(path: Path, noticed: Callable[[str], None] | None = None) -> list[AnyDecision]:
    """The decisions in the file at ``path``; ``noticed`` is told of a last line that was cut off.

    Raises ``DecisionLogError`` for a file that cannot be read, or with the line that is no decision.
    """
    try:
        text = read_input(path).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        cause = f"the decision log cannot be read: {getattr(error, 'strerror', None) or error}"
        raise DecisionLogError(cause, place=str(path), remedy="give a file that --decisions wrote") from error
    *lines, rest = text.split("\n")
    if rest and not _is_half_a_decision(rest.encode()):
        lines.append(rest)
    elif rest and noticed is not None:
        noticed(f"{path}:{len(lines) + 1}: {_CUT_OFF}")
    return [_parsed(line, f"{path}:{number}") for number, line in enumerate(lines, 1)]


def _parsed(line: str, place: str) -> AnyDecision:
    try:
        return decision_from_json(json.loads(line))
    except (ValueError, RecursionError) as error:
        remedy = "give a file that --decisions wrote"
        raise DecisionLogError("not a decision", place=place, remedy=remedy) from error


def decision_text(decision: AnyDecision) -> str:
    """A decision as a line of JSON, in files and on ``/testudo/decisions``."""
    return json_text(decision.to_json(), ascii_only=False)


_Timed = TypeVar("_Timed", bound=AnyDecision)


def with_run_starts(decisions: Iterable[_Timed]) -> Iterator[tuple[int, _Timed]]:
    """The ``decisions``, each with the stamp of the first one of its run.

    A file holds one run after the other, and each begins at 0: nothing of the one before holds then.
    """
    began_ns: int | None = None
    for decision in decisions:
        if began_ns is None or (decision.t_s == 0 and abs(decision.stamp_ns - began_ns) > _T_NS):
            began_ns = decision.stamp_ns
        yield began_ns, decision

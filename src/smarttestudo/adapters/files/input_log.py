# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live loop was given, on disk: one JSON object a line, in order."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from smarttestudo.adapters.files.input_lines import input_from_json, input_to_json
from smarttestudo.adapters.files.whole_file import OutputFileError
from smarttestudo.domain.errors import RecordingError
from smarttestudo.runtime.inputs import LoopInput

INPUTS_FILE = "inputs.jsonl"
# A line holds at most the largest message that a check reads, in base64, or all rules.
MAX_LINE_BYTES = 64_000_000


@contextmanager
def input_log(folder: Path) -> Iterator[Callable[[LoopInput], None]]:
    """What the block is given appends an input to a new log in ``folder``; a crash costs the last ones.

    Raises ``OutputFileError`` where it cannot be written, or where ``folder`` holds a log already.
    """
    path = folder / INPUTS_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = path.open("x", encoding="ascii")
    except FileExistsError as error:
        raise OutputFileError("exists already", place=str(path), remedy="name a new folder") from error
    except OSError as error:
        raise _not_writable(path, error) from error

    def append(given: LoopInput) -> None:
        try:
            file.write(json.dumps(input_to_json(given), separators=(",", ":"), allow_nan=False) + "\n")
        except OSError as error:
            raise _not_writable(path, error) from error

    try:
        yield append
    finally:
        # What could not be written was said when it failed.
        with suppress(OSError):
            file.close()


def holds_inputs(folder: Path) -> bool:
    """Whether ``folder`` is one that ``input_log`` wrote."""
    return (folder / INPUTS_FILE).is_file()


def read_inputs(folder: Path) -> Iterator[LoopInput]:
    """The inputs in ``folder``, in order. A last line that was cut off is left out.

    Raises ``RecordingError`` for a log that cannot be read, or with the line that is none.
    """
    path = folder / INPUTS_FILE
    try:
        with path.open("rb") as file:
            number = 0
            while line := file.readline(MAX_LINE_BYTES):
                number += 1
                if not line.endswith(b"\n"):
                    return
                yield _parsed(line, f"{path}:{number}")
    except OSError as error:
        cause = f"the recorded inputs cannot be read: {error.strerror or error}"
        raise RecordingError(cause, place=str(path)) from error


def _parsed(line: bytes, place: str) -> LoopInput:
    try:
        return input_from_json(json.loads(line))
    except (ValueError, TypeError, LookupError, RecursionError) as error:
        remedy = "replay the folder as 'testudo run --record-inputs' left it"
        raise RecordingError("not a recorded input", place=place, remedy=remedy) from error


def _not_writable(path: Path, error: OSError) -> OutputFileError:
    cause = f"the inputs cannot be recorded: {error.strerror or error}"
    return OutputFileError(cause, place=str(path), remedy="name another folder")

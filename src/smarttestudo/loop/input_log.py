# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Log of a live loop's inputs, on disk: one JSON object a line, in order."""

from __future__ import annotations

import json
from base64 import b64decode, b64encode
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TextIO

from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.observation import (
    Change,
    ClockJumped,
    LinkBudget,
    ListenersChanged,
    ReceiversReckon,
    SourceChanged,
    Undecodable,
    VitalsMeasured,
)
from smarttestudo.domain.record import from_json, to_json
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import OutputFileError, not_written
from smarttestudo.loop.inputs import (
    ChangeInput,
    GraphInput,
    MessageInput,
    RecordedInput,
    RuleTextsInput,
    WakeInput,
)

INPUTS_FILE = "inputs.jsonl"
_CONTENT = "the recorded inputs"
_CUT_OFF = "cut off, as where the run was killed or its disk was full; later decisions are not repeated"
# A line holds at most the largest message that a check reads, in base64, or all rules.
MAX_LINE_BYTES = 64_000_000
_CHANGES: Mapping[str, type[Change]] = {
    "source": SourceChanged,
    "listeners": ListenersChanged,
    "budget": LinkBudget,
    "reckoned": ReceiversReckon,
    "clock": ClockJumped,
    "vitals": VitalsMeasured,
}
_OTHERS: Mapping[str, type[GraphInput | WakeInput | RuleTextsInput]] = {
    "graph": GraphInput,
    "wake": WakeInput,
    "rules": RuleTextsInput,
}
_EVENTS: Mapping[type, str] = {kind: event for event, kind in (*_CHANGES.items(), *_OTHERS.items())}


@contextmanager
def input_log(folder: Path) -> Iterator[Callable[[RecordedInput], None]]:
    """Write a new log in ``folder``: the block is given a function that appends an input.

    A crash costs the last ones. A failure before the first leaves none, so that the next try may have the
    folder.

    Raises ``OutputFileError`` where it cannot be written, or where ``folder`` holds a log already.
    """
    path = folder / INPUTS_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = path.open("x", encoding="ascii")
    except FileExistsError as error:
        raise OutputFileError("exists already", place=str(path), remedy="name a new folder") from error
    except OSError as error:
        raise not_written(path, _CONTENT, error) from error

    def append(given: RecordedInput) -> None:
        try:
            file.write(json_text(input_to_json(given), compact=True) + "\n")
        except OSError as error:
            raise not_written(path, _CONTENT, error) from error

    try:
        try:
            yield append
            _flush(file, path)
        finally:
            # What could not be written was said when it failed.
            with suppress(OSError):
                file.close()
    except BaseException:
        with suppress(OSError, TestudoError):
            if not path.stat().st_size:
                remove(folder, [INPUTS_FILE])
        raise


def _flush(file: TextIO, path: Path) -> None:
    try:
        file.flush()
    except OSError as error:
        raise not_written(path, _CONTENT, error) from error


def holds_inputs(folder: Path) -> bool:
    """Whether ``folder`` is one that ``input_log`` wrote."""
    return (folder / INPUTS_FILE).is_file()


def read_inputs(folder: Path, noticed: Callable[[str], None] | None = None) -> Iterator[RecordedInput]:
    """The inputs in ``folder``, in order. A last line that was cut off is left out, and ``noticed`` is told.

    Raises ``RecordingError`` for a log that cannot be read, or with the line that is none.
    """
    path = folder / INPUTS_FILE
    try:
        with path.open("rb") as file:
            number = 0
            while line := file.readline(MAX_LINE_BYTES):
                number += 1
                if not line.endswith(b"\n"):
                    if noticed is not None:
                        noticed(f"{path}:{number}: {_CUT_OFF}")
                    return
                yield _parsed(line, f"{path}:{number}")
    except OSError as error:
        cause = f"the recorded inputs cannot be read: {error.strerror or error}"
        raise RecordingError(cause, place=str(path), remedy="check the path and its permissions") from error


def _parsed(line: bytes, place: str) -> RecordedInput:
    try:
        return input_from_json(json.loads(line))
    except (ValueError, TypeError, LookupError, RecursionError) as error:
        remedy = "replay the folder as 'testudo run --record-inputs' left it"
        raise RecordingError("not a recorded input", place=place, remedy=remedy) from error


def input_to_json(given: RecordedInput) -> dict[str, object]:
    """The object of one line; what is absent or usual has no key."""
    match given:
        case MessageInput():
            return {"event": "message", "stamp_ns": given.stamp_ns, **_message(given)}
        case ChangeInput(stamp_ns=stamp_ns, change=change):
            return {"event": _EVENTS[type(change)], "stamp_ns": stamp_ns, **to_json(change)}
        case _:
            return {"event": _EVENTS[type(given)], **to_json(given)}


def _message(given: MessageInput) -> dict[str, object]:
    record: dict[str, object] = {"topic": given.topic, "size_bytes": given.size_bytes}
    if payload := given.payload[:]:
        record["payload"] = b64encode(payload).decode("ascii")
    if isinstance(given.message, Undecodable):
        record["decodable"] = False
    if given.publisher is not None:
        record["publisher"] = given.publisher
    return record


def input_from_json(record: Mapping[str, Any]) -> RecordedInput:
    """The input of one line. Raises ``ValueError``, ``TypeError`` or ``LookupError`` where it is none."""
    event = record["event"]
    if event == "message":
        return _read_message(record)
    if event in _CHANGES:
        change = from_json(_CHANGES[event], record)
        return ChangeInput(stamp_ns=int(record["stamp_ns"]), change=change)
    return from_json(_OTHERS[event], record)


def _read_message(record: Mapping[str, Any]) -> MessageInput:
    return MessageInput(
        stamp_ns=int(record["stamp_ns"]),
        topic=str(record["topic"]),
        size_bytes=int(record["size_bytes"]),
        payload=b64decode(record.get("payload", ""), validate=True),
        message=None if record.get("decodable", True) else Undecodable(),
        publisher=record.get("publisher"),
    )

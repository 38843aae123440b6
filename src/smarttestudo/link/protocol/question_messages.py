# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions over a link and their answers, as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.parameter import ParameterValue, Values
from smarttestudo.domain.questions import Answer, GetParameters, GetTopics, Question, SetParameters

MAX_QUESTION_BYTES = 1_100_000
"""How large the JSON of a question or an answer may be: rules of about a megabyte fit."""
_MAX_NAMES = 32
_MAX_NAME_LENGTH = 255
_MAX_ITEMS = 1_000
_MAX_TEXT = 1_000
_UNREADABLE = (ValueError, TypeError, LookupError, AttributeError, RecursionError)


def question_to_bytes(question: Question) -> bytes:
    """A question as it travels. Raises ``LinkError`` for one that is too large."""
    match question:
        case GetParameters(names=names):
            record: dict[str, object] = {"get": list(names)}
        case SetParameters(values=values):
            record = {"set": {name: _sent(value) for name, value in values.items()}}
        case GetTopics():
            record = {"topics": True}
    return _bytes(record)


def question_from_bytes(data: bytes, *, may_change: bool) -> Question:
    """What ``question_to_bytes`` made ``data`` of. Raises ``LinkError`` for anything else.

    Where one ``may_change`` something, nothing else may be asked, and the other way round.
    """
    try:
        record = json.loads(data)
        if not isinstance(record, dict):
            raise TypeError("no object")
        if may_change:
            return SetParameters(values=_values(record["set"]))
        return GetTopics() if "topics" in record else GetParameters(names=_names(record["get"]))
    except _UNREADABLE as error:
        raise LinkError(
            "the question is not understood", remedy="use the same version of SmartTestudo at both ends"
        ) from error


def answer_to_bytes(answer: Answer | TestudoError) -> bytes:
    """An answer as it travels, or why there is none. Raises ``LinkError`` for one that is too large."""
    if isinstance(answer, TestudoError):
        return _bytes({"cause": answer.cause, "place": answer.place, "remedy": answer.remedy})
    return _bytes({name: _sent(value) for name, value in answer.items()})


def values_from_bytes(data: bytes) -> Values:
    """The answer to ``GetParameters``. Raises ``LinkError``."""
    try:
        return _values(json.loads(data))
    except _UNREADABLE as error:
        raise LinkError("the answer is not understood") from error


def texts_from_bytes(data: bytes) -> Mapping[str, str]:
    """The answer to the other questions: a text to each name. Raises ``LinkError``."""
    values = values_from_bytes(data)
    if not all(isinstance(value, str) for value in values.values()):
        raise LinkError("the answer is not understood")
    return {name: str(value) for name, value in values.items()}


def error_from_bytes(data: bytes) -> LinkError | None:
    """Why there is no answer, in the robot's words; ``None`` where these are not the robot's."""
    try:
        record = json.loads(data)
        cause, place, remedy = (record[name] for name in ("cause", "place", "remedy"))
    except _UNREADABLE:
        return None
    return LinkError(
        _one_line(cause),
        place=None if place is None else _one_line(place),
        remedy=None if remedy is None else _one_line(remedy),
    )


def _bytes(record: Mapping[str, object]) -> bytes:
    data = json_text(record, ascii_only=False, compact=True).encode("utf-8", "replace")
    if len(data) > MAX_QUESTION_BYTES:
        raise LinkError(f"{len(data)} bytes are too many for a question or an answer over a link")
    return data


def _one_line(text: object) -> str:
    """Nothing in it moves a cursor."""
    line = " ".join(str(text)[:_MAX_TEXT].split())
    return "".join(character for character in line if character.isprintable())


def _sent(value: object) -> object:
    return list(value) if isinstance(value, tuple) else value


def _names(record: object) -> tuple[str, ...]:
    if not isinstance(record, list) or len(record) > _MAX_NAMES:
        raise TypeError("no list of a few names")
    return tuple(_name(name) for name in record)


def _values(record: object) -> dict[str, ParameterValue]:
    if not isinstance(record, dict) or len(record) > _MAX_ITEMS:
        raise TypeError("no object with some entries")
    return {_name(name): _value(value) for name, value in record.items()}


def _name(name: object) -> str:
    if not isinstance(name, str) or len(name) > _MAX_NAME_LENGTH:
        raise TypeError("no name")
    return name


def _value(value: object) -> ParameterValue:
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list) and all(isinstance(entry, str) for entry in value):
        return tuple(value)
    raise TypeError("no value of a parameter")

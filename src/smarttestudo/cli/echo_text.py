# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Texts of a topic's reception: lines and JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from smarttestudo.domain.units import grouped
from smarttestudo.report.table import MISSING, format_number
from smarttestudo.robot.echo import Echo, PlainValue

_MOST_ON_ONE_LINE = 8
_DIGITS = 10


def echo_block(echo: Echo) -> list[str]:
    """The rates, and each value on a line of its own, by the path that ``--fields`` takes."""
    return [_rates(echo), *(f"  {line}" for line in _value_lines(echo.values))]


def echo_line(echo: Echo, *, with_all: bool) -> str:
    """The rates and values on one line; unless ``with_all``, the first few values after the header."""
    values = [line for line in _value_lines(echo.values) if with_all or not line.startswith("header.")]
    shown = values if with_all else values[:_MOST_ON_ONE_LINE]
    return "  ".join([_rates(echo), *shown, *(["…"] * (len(shown) < len(values)))])


def message_block(echo: Echo) -> list[str]:
    """One message, whole."""
    head = (
        f"{echo.topic}  {echo.type_name}  message {grouped(echo.messages)}  {grouped(echo.size_bytes or 0)} B"
    )
    return ["  ".join([head, *([echo.state] if echo.state else [])]), *_value_lines(echo.values)]


def echo_json(echo: Echo) -> dict[str, object]:
    """Everything as one JSON object; numbers that are not known or not finite are null."""
    return {
        "topic": echo.topic,
        "type": echo.type_name,
        "messages": echo.messages,
        "rate_hz": None if echo.rate_hz is None else round(echo.rate_hz, 3),
        "kb_per_s": round(echo.kb_per_s, 3),
        "size_bytes": echo.size_bytes,
        "state": echo.state,
        "values": None if echo.values is None else _finite(dict(echo.values)),
    }


def _rates(echo: Echo) -> str:
    words = [echo.topic]
    if echo.messages:
        words += [
            f"{format_number(echo.rate_hz, 2)} Hz",
            f"{format_number(echo.kb_per_s, 1)} KB/s",
            f"{grouped(echo.messages)} message{'s' * (echo.messages != 1)}",
        ]
    if echo.state:
        words.append(echo.state)
    return "  ".join(words)


def _value_lines(values: Mapping[str, PlainValue] | None) -> Iterator[str]:
    for name, value in (values or {}).items():
        yield from _lines(name, value)


def _lines(path: str, value: PlainValue) -> Iterator[str]:
    if isinstance(value, dict) and value:
        for name, inner in value.items():
            yield from _lines(f"{path}.{name}", inner)
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for index, item in enumerate(value):
            # What was left out of an array is said at its end.
            yield from _lines(path if isinstance(item, str) else f"{path}[{index}]", item)
    else:
        yield f"{path}: {_text(value)}"


def _text(value: PlainValue) -> str:
    match value:
        case None:
            return MISSING
        case bool():
            return str(value).lower()
        case float():
            return format(value, f".{_DIGITS}g")
        case str():
            return value or '""'
        case list():
            return f"[{', '.join(map(_text, value))}]"
        case _:
            return str(value)


def _finite(value: PlainValue) -> PlainValue:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case list():
            return [_finite(item) for item in value]
        case dict():
            return {name: _finite(item) for name, item in value.items()}
        case _:
            return value

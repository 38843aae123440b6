# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Durations, ``For`` and ``Within``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Decimal
from types import MappingProxyType
from typing import NamedTuple, NoReturn

from smarttestudo.domain.finding import Fix, Span
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.language.parser.cursor import BrokenStatementError, Cursor
from smarttestudo.language.parser.tokens import TokenKind
from smarttestudo.language.parser.values import parse_number
from smarttestudo.language.syntax import Condition, Duration, DurationUnit, Timed, TimeWord

MAX_DURATION_NS = 24 * 60 * 60 * NS_PER_S
MAX_TIMED_NESTING = 10
_NS_OF = MappingProxyType(
    {
        DurationUnit.MILLISECONDS: NS_PER_MS,
        DurationUnit.SECONDS: NS_PER_S,
        DurationUnit.MINUTES: 60 * NS_PER_S,
    }
)
_UNITS = {unit.value: unit for unit in DurationUnit}
_OTHER_UNITS = MappingProxyType(
    {
        "msec": DurationUnit.MILLISECONDS,
        "millisecond": DurationUnit.MILLISECONDS,
        "milliseconds": DurationUnit.MILLISECONDS,
        "sec": DurationUnit.SECONDS,
        "secs": DurationUnit.SECONDS,
        "second": DurationUnit.SECONDS,
        "seconds": DurationUnit.SECONDS,
        "m": DurationUnit.MINUTES,
        "mins": DurationUnit.MINUTES,
        "minute": DurationUnit.MINUTES,
        "minutes": DurationUnit.MINUTES,
    }
)
_TIME_WORDS = MappingProxyType({TokenKind.FOR: TimeWord.FOR, TokenKind.WITHIN: TimeWord.WITHIN})
_MENDED_TO = frozenset(_TIME_WORDS)
_EXPECTED_WORD = "'For', 'Within' or the end of the condition"
_EXPECTED_DURATION = "a duration (a number of 'ms', 's' or 'min')"
_EXPECTED_UNIT = "the unit 'ms', 's' or 'min'"
_LOOKS_LIKE_DURATION = re.compile(r"([+-]?[0-9.]+)([A-Za-z]+)")


class TimePart(NamedTuple):
    """A ``For`` or ``Within`` with its duration, and where it ends."""

    word: TimeWord
    duration: Duration
    end: Span


def parse_time_parts(cursor: Cursor) -> Sequence[TimePart]:
    """Every ``For DURATION`` and ``Within DURATION`` that follows."""
    parts: list[TimePart] = []
    while True:
        cursor.mend("expected-connective", _EXPECTED_WORD, _MENDED_TO)
        word = _TIME_WORDS.get(cursor.kind)
        if word is None:
            break
        cursor.advance()
        parts.append(TimePart(word, parse_duration(cursor), cursor.previous.end))
    if cursor.kind is TokenKind.UNTIL:
        hint = "write 'Until' before 'For' and 'Within'" if parts else "only a check has an 'Until'"
        raise cursor.failure("misplaced-until", "'AND', 'OR', ')' or 'Then'", hint=hint)
    cursor.timed_depth += len(parts)
    if cursor.timed_depth > MAX_TIMED_NESTING:
        message = f"'For' and 'Within' nest at most {MAX_TIMED_NESTING} deep"
        cursor.report("nested-too-deep", message, hint="split the rule")
        raise BrokenStatementError
    return parts


def timed(condition: Condition, parts: Sequence[TimePart]) -> Condition:
    """``condition`` with all of ``parts`` behind it."""
    for part in parts:
        span = condition.span.to(part.end)
        condition = Timed(operand=condition, word=part.word, duration=part.duration, span=span)
    return condition


def parse_duration(cursor: Cursor) -> Duration:
    """A number of at most a day, and its unit."""
    first = cursor.token
    glued = _LOOKS_LIKE_DURATION.fullmatch(first.text) if first.kind is TokenKind.FOREIGN else None
    if glued is not None:
        _refuse_unit(cursor, glued[2], first.span, before=f"{glued[1]} ")
    _, text = parse_number(cursor, "expected-duration", _EXPECTED_DURATION)
    token = cursor.token
    unit = _UNITS.get(token.text)
    if unit is None:
        if token.kind is not TokenKind.WORD or token.starts_line:
            raise cursor.failure("expected-unit", _EXPECTED_UNIT, hint=f"for instance {text} s")
        _refuse_unit(cursor, token.text, token.span)
    cursor.advance()
    ns = duration_ns(text, unit)
    span = cursor.span_from(first)
    if not 0 <= ns <= MAX_DURATION_NS:
        limit = MAX_DURATION_NS // _NS_OF[DurationUnit.MINUTES]
        message = f"a duration lies between 0 and {limit} min, this is {text} {token.text}"
        cursor.report("duration-out-of-range", message, span=span)
        raise BrokenStatementError
    return Duration(text=text, unit=unit, ns=ns, span=span)


def duration_ns(text: str, unit: DurationUnit) -> int:
    """The nanoseconds nearest to ``text`` of ``unit``; more than a duration may have where it is far more."""
    value = float(text)
    if abs(value) > MAX_DURATION_NS:
        return -1
    # A Decimal holds no exponent of twenty digits, as that of 0e99999999999999999999.
    if value == 0:
        return 0
    return round(Decimal(text) * _NS_OF[unit])


def _refuse_unit(cursor: Cursor, word: str, span: Span, before: str = "") -> NoReturn:
    right = _OTHER_UNITS.get(word.casefold()) or _UNITS.get(word.casefold())
    fix = None
    if right is not None:
        text = f"{before}{right.value}"
        fix = Fix(span=span, replacement=text, title=f"write {text}")
    hint = f"did you mean '{right.value}'?" if right is not None else "for instance 500 ms, 5 s or 2 min"
    raise cursor.failure("expected-unit", _EXPECTED_UNIT, hint=hint, fix=fix)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics, numbers and rates."""

from __future__ import annotations

import math
import re
from typing import NoReturn

from smarttestudo.domain.finding import Fix
from smarttestudo.domain.names import MAX_NAME_LENGTH, is_topic_name
from smarttestudo.domain.rate import MAX_RATE_HZ, Tier
from smarttestudo.language.parser.cursor import Cursor
from smarttestudo.language.parser.suggestions import closest, did_you_mean, hint_on
from smarttestudo.language.parser.tokens import Token, TokenKind
from smarttestudo.language.syntax import RateExpression, RateWord, TopicName

UNIT = "Hz"
# Below Python 3.12, looking a member up in its enum costs as much as a call.
_WORD, _NUMBER = TokenKind.WORD, TokenKind.NUMBER
_OTHER_UNITS = frozenset({"hz", "khz", "mhz", "hertz"})
_TIERS = {tier.value: tier for tier in Tier}
_RATE_NAMES: dict[str, Tier | RateWord] = {
    **_TIERS,
    **{word.value: word for word in RateWord},
}
_EXPECTED_RATE = "a rate (a number of Hz, a quality level, 'Full' or 'Off')"
_EXPECTED_BOUND = "a bound (a number or a quality level)"
_TIERS_HINT = f"the quality levels are {', '.join(_TIERS)}"
_LEADING_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def parse_topic(cursor: Cursor, *, split_property: bool = False) -> TopicName:
    """A topic; with ``split_property`` a dot in it is taken for the start of a property."""
    token = cursor.token
    if token.kind is not _WORD:
        _refuse_other_than_topic(cursor, token)
    if not is_topic_name(token.text):
        _refuse_topic(cursor, token, split_property=split_property)
    cursor.advance()
    return TopicName(text=token.text, span=token.span)


def _refuse_other_than_topic(cursor: Cursor, token: Token) -> NoReturn:
    if token.kind is not TokenKind.STRING:
        raise cursor.failure("expected-topic", "a topic", hint=hint_on(token) or "for instance /odom")
    bare = token.text[1:-1]
    fix = Fix(span=token.span, replacement=bare, title="remove the quotes") if is_topic_name(bare) else None
    raise cursor.failure("expected-topic", "a topic", hint="topics are written without quotes", fix=fix)


def _refuse_topic(cursor: Cursor, token: Token, *, split_property: bool) -> NoReturn:
    name = token.text
    head, dot, tail = name.partition(".")
    hint, right = "a name holds letters, digits, '_' and '/', and no part of it starts with a digit", ""
    if split_property and dot and is_topic_name(head) and tail:
        right = f"{head} {tail}"
        hint = f"the property is a word of its own: {right}"
    elif is_topic_name(name.rstrip("/")):
        right = name.rstrip("/")
        hint = did_you_mean(right)
    elif "__" in name:
        hint = "two '_' in a row are reserved in ROS 2"
    elif len(name) > MAX_NAME_LENGTH:
        hint = f"a name has at most {MAX_NAME_LENGTH} characters"
    fix = Fix(span=token.span, replacement=right, title=f"write {right}") if right else None
    raise cursor.failure("invalid-topic", "a valid topic name", hint=hint, fix=fix)


def parse_number(cursor: Cursor, code: str, expected: str) -> tuple[float, str]:
    """A finite number and its spelling."""
    token = cursor.token
    if token.kind is not _NUMBER:
        _refuse_number(cursor, token, code, expected)
    value = float(token.text)
    if not math.isfinite(value):
        raise cursor.failure("number-out-of-range", "a number below 1.8e308 in size")
    cursor.advance()
    return value, token.text


def _refuse_number(cursor: Cursor, token: Token, code: str, expected: str) -> NoReturn:
    right = token.text.replace(",", ".").replace("−", "-").replace("–", "-")
    if token.kind is TokenKind.FOREIGN and _LEADING_NUMBER.fullmatch(right):
        fix = Fix(span=token.span, replacement=right, title=f"write {right}")
        raise cursor.failure(code, expected, hint=did_you_mean(right), fix=fix)
    number = _LEADING_NUMBER.match(token.text)
    hint = "numbers are written as 10, -2.5 or 1e3, without a unit" if number else ""
    raise cursor.failure(code, expected, hint=hint)


def parse_rate(cursor: Cursor) -> RateExpression:
    """A number of Hz, a tier, ``Full`` or ``Off``."""
    token = cursor.token
    if token.kind is not _WORD:
        return parse_hertz(cursor, "expected-rate", _EXPECTED_RATE)
    value = _RATE_NAMES.get(token.text)
    if value is None:
        right = closest(token.text, _RATE_NAMES)
        fix = Fix(span=token.span, replacement=right, title=f"write {right}") if right else None
        hint = did_you_mean(right) if right else _TIERS_HINT
        raise cursor.failure("expected-rate", _EXPECTED_RATE, hint=hint, fix=fix)
    cursor.advance()
    return RateExpression(value=value, text="", span=token.span)


def parse_bound(cursor: Cursor) -> tuple[float | Tier, str]:
    """How far off a property may be: a number and its spelling, or a tier."""
    token = cursor.token
    if token.kind is not _WORD:
        bound, text = parse_number(cursor, "expected-number", _EXPECTED_BOUND)
        if bound < 0:
            message = f"a bound is 0 or more, this is {text}"
            cursor.report("bound-out-of-range", message, span=token.span, hint="0 passes every change")
        return bound, text
    tier = _TIERS.get(token.text)
    if tier is None:
        right = closest(token.text, _TIERS)
        fix = Fix(span=token.span, replacement=right, title=f"write {right}") if right else None
        hint = did_you_mean(right) if right else _TIERS_HINT
        raise cursor.failure("expected-number", _EXPECTED_BOUND, hint=hint, fix=fix)
    cursor.advance()
    return tier, ""


def parse_hertz(cursor: Cursor, code: str, expected: str) -> RateExpression:
    """A number between 0 and ``MAX_RATE_HZ``, with or without its unit."""
    first = cursor.token
    value, text = parse_number(cursor, code, expected)
    if not 0 <= value <= MAX_RATE_HZ:
        message = f"a rate lies between 0 and {MAX_RATE_HZ:.0f} Hz, this is {text}"
        cursor.report("rate-out-of-range", message, span=first.span)
    has_unit = _take_unit(cursor)
    return RateExpression(value=value, text=text, span=cursor.span_from(first), has_unit=has_unit)


def _take_unit(cursor: Cursor) -> bool:
    token = cursor.token
    if token.kind is not _WORD or token.text.casefold() not in _OTHER_UNITS:
        return False
    if token.text.casefold() in ("khz", "mhz"):
        raise cursor.failure("unknown-unit", "the unit 'Hz' or none", hint="write the rate in Hz")
    if token.text != UNIT:
        fix = Fix(span=token.span, replacement=UNIT, title=f"write {UNIT}")
        cursor.report_found("unknown-unit", "the unit 'Hz' or none", hint=did_you_mean(UNIT), fix=fix)
    cursor.advance()
    return True

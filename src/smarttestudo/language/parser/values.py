# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics, properties, names, numbers, rates and durations."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from decimal import Decimal
from types import MappingProxyType
from typing import NamedTuple, NoReturn

from smarttestudo.domain.finding import Fix, Span
from smarttestudo.domain.names import MAX_NAME_LENGTH, SOURCES, is_source, is_topic_name, is_topic_pattern
from smarttestudo.domain.rate import MAX_RATE_HZ, Tier
from smarttestudo.domain.texts import is_shown
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.language.parser.cursor import BrokenStatementError, Cursor, closest, did_you_mean, hint_on
from smarttestudo.language.parser.lexer import Token, TokenKind
from smarttestudo.language.properties.field_path import is_property
from smarttestudo.language.syntax import (
    Condition,
    Duration,
    DurationUnit,
    Margin,
    RateExpression,
    RateWord,
    Timed,
    TimeWord,
    TopicName,
)

UNIT = "Hz"
# Below Python 3.12, looking a member up in its enum costs as much as a call.
_WORD, _NUMBER = TokenKind.WORD, TokenKind.NUMBER
_RATE_UNITS = frozenset({"hz", "khz", "mhz", "hertz"})
_TIERS = {tier.value: tier for tier in Tier}
_RATE_NAMES: dict[str, Tier | RateWord] = {**_TIERS, **{word.value: word for word in RateWord}}
_EXPECTED_RATE = "a rate (a number of Hz, a quality level, 'Full' or 'Off')"
_EXPECTED_BOUND = "a bound (a number or a quality level)"
_TIERS_HINT = f"the quality levels are {', '.join(_TIERS)}"
_LEADING_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


_BY_WORD = frozenset({TokenKind.BY})
_EXPECTED_BY = "'By' and what the rate goes by"
_MARGIN_HINT = "for instance SetFrequency /scan 2 .. 20 By /scan distance 3 .. 0.5"


def parse_topic(cursor: Cursor, *, split_property: bool = False) -> TopicName:
    """A topic; with ``split_property`` a dot in it is taken for the start of a property."""
    token = cursor.token
    if token.kind is not _WORD:
        _refuse_other_than_topic(cursor, token)
    if not is_topic_name(token.text):
        _refuse_topic(cursor, token, split_property=split_property)
    cursor.advance()
    return TopicName(text=token.text, span=token.span)


def parse_topics(cursor: Cursor, *, split_property: bool = False) -> TopicName:
    """A topic, or a pattern of topics."""
    token = cursor.token
    if token.kind is _WORD and is_topic_pattern(token.text):
        cursor.advance()
        return TopicName(text=token.text, span=token.span)
    return parse_topic(cursor, split_property=split_property)


def parse_read(cursor: Cursor) -> TopicName:
    """The topic that a check reads, or ``@machine`` or ``@link`` in place of one."""
    token = cursor.token
    if token.kind is _WORD and is_source(token.text):
        cursor.advance()
        return TopicName(text=token.text, span=token.span)
    return parse_topic(cursor, split_property=True)


def _refuse_other_than_topic(cursor: Cursor, token: Token) -> NoReturn:
    if token.kind is not TokenKind.STRING:
        raise cursor.failure("expected-topic", "a topic", hint=hint_on(token) or "for instance /odom")
    bare = token.text[1:-1]
    fix = Fix(span=token.span, replacement=bare, title="remove the quotes") if is_topic_name(bare) else None
    raise cursor.failure("expected-topic", "a topic", hint="topics are written without quotes", fix=fix)


def _refuse_topic(cursor: Cursor, token: Token, *, split_property: bool) -> NoReturn:
    name = token.text
    head, dot, tail = name.partition(".")
    if is_source(name):
        raise cursor.failure("expected-topic", "a topic", hint=f"only a check reads {name}")
    if name.startswith("@"):
        raise cursor.failure("invalid-topic", "a valid topic name", hint=_sources_hint(name))
    if is_topic_pattern(name):
        hint = "a check reads one topic; patterns stand where a topic is relayed or recorded"
        raise cursor.failure("misplaced-pattern", "the name of one topic", hint=hint)
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


def _sources_hint(name: str) -> str:
    right = closest(name, SOURCES)
    return did_you_mean(right) if right else f"beside topics there are {' and '.join(SOURCES)}"


_ESCAPE = re.compile(r"\\(.)")
_QUOTES = {"“": "”", "'": "'"}


def quoted(name: str) -> str:
    r"""``name`` as a rule file writes it; only ``"`` and ``\`` have a ``\`` before them."""
    return '"{}"'.format(re.sub(r'(["\\])', r"\\\1", name))


def parse_name(cursor: Cursor, expected: str, *, example: str, if_empty: str = "") -> str:
    """The text in quotes; ``expected`` and ``example`` say what it is where it is not there."""
    token = cursor.token
    if token.kind is TokenKind.STRING:
        return _plain_name(cursor, token, if_empty)
    if token.kind is TokenKind.WORD and not token.text.startswith("/"):
        return _bare_name(cursor, expected)
    if token.kind is TokenKind.FOREIGN and token.text[0] == '"':
        cursor.report("unclosed-name", "the name has no closing '\"' on its line")
        raise BrokenStatementError
    if (
        token.kind is TokenKind.FOREIGN
        and len(token.text) > 1
        and token.text[-1] == _QUOTES.get(token.text[0])
    ):
        _report_quotes(cursor, token, expected)
        cursor.advance()
        return token.text[1:-1]
    raise cursor.failure("expected-name", expected, hint=f"for instance {example}")


def unquoted(cursor: Cursor, token: Token, code: str, what: str) -> str:
    """The text between the quotes of ``token``; an escape without a meaning is reported."""
    text = token.text[1:-1]
    wrong = next((found for found in _ESCAPE.finditer(text) if found[1] not in '"\\'), None)
    if wrong is not None:
        fix = Fix(span=token.span, replacement=quoted(text), title="double every backslash")
        cursor.report(
            code, f"{what} cannot hold '{wrong[0]}'", hint='only \\" and \\\\ have a meaning', fix=fix
        )
    return _ESCAPE.sub(r"\1", text)


def _plain_name(cursor: Cursor, token: Token, if_empty: str) -> str:
    name = unquoted(cursor, token, "invalid-name", "a name")
    if not name.strip():
        cursor.report("invalid-name", "the name is empty", hint=if_empty)
    elif not all(map(is_shown, name)):
        cursor.report("invalid-name", "the name holds a tab or a character that cannot be seen")
    cursor.advance()
    return name


def _bare_name(cursor: Cursor, expected: str) -> str:
    first = cursor.token
    words = [cursor.advance().text]
    while (
        cursor.kind is TokenKind.WORD
        and not cursor.token.starts_line
        and not cursor.token.text.startswith("/")
    ):
        words.append(cursor.advance().text)
    name = " ".join(words)
    span = cursor.span_from(first)
    fix = Fix(span=span, replacement=quoted(name), title="put quotes around it")
    cursor.report(
        "expected-name",
        f"expected {expected}, found '{name}'",
        span=span,
        hint=f"did you mean {quoted(name)}?",
        fix=fix,
    )
    return name


def _report_quotes(cursor: Cursor, token: Token, expected: str) -> None:
    name = token.text[1:-1]
    fix = Fix(span=token.span, replacement=quoted(name), title="write straight quotes")
    cursor.report_found("expected-name", expected, hint=f"did you mean {quoted(name)}?", fix=fix)


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


def parse_margin(cursor: Cursor) -> Margin | None:
    """``.. rate By TOPIC PROPERTY NUMBER .. NUMBER`` behind a rate, if it is there."""
    first = cursor.accept(TokenKind.RANGE)
    if first is None:
        return None
    to = parse_rate(cursor)
    cursor.mend("expected-by", _EXPECTED_BY, _BY_WORD)
    if cursor.accept(TokenKind.BY) is None:
        raise cursor.failure("expected-by", _EXPECTED_BY, hint=_MARGIN_HINT)
    topic = parse_read(cursor)
    name = parse_property(cursor, topic.text)
    from_value, from_text = parse_number(cursor, "expected-number", "the value at which the first rate holds")
    if cursor.accept(TokenKind.RANGE) is None:
        raise cursor.failure("expected-range", "'..' and a second value", hint=_MARGIN_HINT)
    to_value, to_text = parse_number(cursor, "expected-number", "the value at which the second rate holds")
    return Margin(
        to=to,
        topic=topic,
        property=name.text,
        property_span=name.span,
        from_value=from_value,
        from_text=from_text,
        to_value=to_value,
        to_text=to_text,
        span=cursor.span_from(first),
    )


def parse_property(cursor: Cursor, topic: str) -> Token:
    """The word that names a property of ``topic``."""
    token = cursor.token
    if token.kind is not _WORD or not is_property(token.text):
        _refuse_property(cursor, token, topic)
    return cursor.advance()


def _refuse_property(cursor: Cursor, token: Token, topic: str) -> NoReturn:
    expected = f"a property of '{topic}'"
    if token.kind in (TokenKind.OPERATOR, TokenKind.NUMBER):
        hint = f"for instance {topic} age"
        raise cursor.failure("expected-property", expected, hint=hint)
    if token.kind is not _WORD:
        raise cursor.failure("expected-property", expected)
    hint = "a property is a name such as speed or a field such as pose.pose.position.x or ranges[0]"
    raise cursor.failure("invalid-property", expected, hint=hint)


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
    if token.kind is not _WORD or token.text.casefold() not in _RATE_UNITS:
        return False
    if token.text.casefold() in ("khz", "mhz"):
        raise cursor.failure("unknown-unit", "the unit 'Hz' or none", hint="write the rate in Hz")
    if token.text != UNIT:
        fix = Fix(span=token.span, replacement=UNIT, title=f"write {UNIT}")
        cursor.report_found("unknown-unit", "the unit 'Hz' or none", hint=did_you_mean(UNIT), fix=fix)
    cursor.advance()
    return True


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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statements of a document in the words of the page, and back."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from typing import TypedDict

from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Tier
from smarttestudo.domain.signal import Value
from smarttestudo.editing import Document, EditError, Entry, NewStatement, comment_texts
from smarttestudo.language.formatter import number_text, value_text
from smarttestudo.language.parser.comparisons import written_value
from smarttestudo.language.parser.values import duration_ns
from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    CallService,
    Check,
    Compared,
    Condition,
    Constant,
    Duration,
    Group,
    KeepAtLeast,
    KeepWithin,
    Margin,
    Not,
    Notify,
    Or,
    RateExpression,
    RateWord,
    RecordIncident,
    SetFrequency,
    SetParameter,
    Statement,
    Timed,
    TopicName,
    Until,
)
from smarttestudo.ruler.rules import statements as page

_LAST_SINGLE = "\uffff"


class Utf16:
    """Turns offsets into ``text`` from characters to UTF-16 code units, and back."""

    def __init__(self, text: str) -> None:
        is_wide = not text.isascii() and max(text) > _LAST_SINGLE
        self._pairs = [at for at, character in enumerate(text) if character > _LAST_SINGLE] if is_wide else []

    def offset(self, characters: int) -> int:
        """The code units before the character number ``characters``."""
        return characters + bisect_left(self._pairs, characters)

    def characters(self, offset: int) -> int:
        """The characters before the code unit number ``offset``; within a pair, those before the pair."""
        ends = (at + number + 1 for number, at in enumerate(self._pairs))
        return offset - sum(end <= offset for end in ends)


_NOWHERE = Span(line=1, column=1, end_line=1, end_column=1)
_UNNAMED = "Rule"


class _Place(TypedDict):
    id: str
    key: str
    comments: tuple[str, ...]
    offset: int
    end_offset: int
    line: int


class StatementWriter:
    """Puts the statements of one document into the words of the page."""

    def __init__(self, document: Document) -> None:
        self._places = document.places
        self._utf16 = Utf16(document.text)

    def offset(self, characters: int) -> int:
        """An offset as JavaScript counts it."""
        return self._utf16.offset(characters)

    def range(self, span: Span) -> tuple[int, int]:
        """Where ``span`` starts and ends, as JavaScript counts it."""
        start, end = self._places.range(span)
        return self.offset(start), self.offset(end)

    def entry(self, entry: Entry) -> page.Statement:
        """One statement with its id and key."""
        words = entry.token_range
        start = self.offset(words.start)
        place = _Place(
            id=entry.id,
            key=entry.key,
            comments=tuple(comment_texts(entry.comments)),
            offset=start,
            end_offset=self.offset(words.end),
            line=words.tokens[0].line,
        )
        match entry.statement:
            case None:
                return page.RawStatement(text=words.text[words.start : words.end], **place)
            case SetFrequency() as one:
                return _set_frequency(one, place)
            case KeepWithin() as one:
                return _keep_within(one, place)
            case KeepAtLeast() as one:
                return page.KeepStatement(topic=one.topic.text, hz=_hertz(one.rate), **place)
            case Block() as block:
                return page.RuleStatement(
                    name=block.name,
                    priority=block.priority or 0,
                    is_disabled=block.is_disabled,
                    label=block.label,
                    condition=self._condition(block.condition, start),
                    then=tuple(self._inner(one, start) for one in block.then),
                    otherwise=tuple(self._inner(one, start) for one in block.otherwise),
                    **place,
                )

    def _inner(self, one: Action, base: int) -> page.Action:
        start, end = self.range(one.span)
        place = _Place(
            id="",
            key="",
            comments=tuple(comment_texts(one.trivia.above)),
            offset=start - base,
            end_offset=end - base,
            line=one.span.line,
        )
        return _action(one, place)

    def _condition(self, condition: Condition, base: int) -> page.Condition:
        match condition:
            case Timed():
                return page.TimedCondition(
                    term=self._condition(condition.operand, base),
                    word=condition.word,
                    duration=_duration(condition.duration),
                )
            case Check():
                start, end = self.range(condition.span)
                return page.CheckCondition(
                    topic=condition.topic.text,
                    property=condition.property,
                    op=condition.operator,
                    value=page_value(condition.value),
                    until=_until(condition.until),
                    offset=start - base,
                    end_offset=end - base,
                )
            case Group():
                return self._condition(condition.operand, base)
            case Not():
                return page.NotCondition(term=self._condition(condition.operand, base))
            case And():
                return page.AndCondition(terms=self._conditions(condition.operands, base))
            case Or():
                return page.OrCondition(terms=self._conditions(condition.operands, base))

    def _conditions(self, conditions: Sequence[Condition], base: int) -> tuple[page.Condition, ...]:
        return tuple(self._condition(one, base) for one in conditions)


def _action(one: Action, place: _Place) -> page.Action:
    match one:
        case SetFrequency():
            return _set_frequency(one, place)
        case KeepWithin():
            return _keep_within(one, place)
        case RecordIncident():
            return page.RecordStatement(
                name=one.name,
                topics=tuple(topic.text for topic in one.topics),
                before=_duration(one.before),
                after=_duration(one.after),
                **place,
            )
        case SetParameter():
            value = one.text or value_text(one.value)
            return page.ParameterStatement(node=one.node.text, parameter=one.parameter, value=value, **place)
        case CallService():
            return page.CallStatement(service=one.service.text, argument=one.argument, **place)
        case Notify():
            return page.NotifyStatement(text=one.text, **place)


def _set_frequency(one: SetFrequency, place: _Place) -> page.SetStatement:
    margin = None if one.margin is None else _margin(one.margin)
    return page.SetStatement(topic=one.topic.text, rate=_rate(one.rate), margin=margin, **place)


def _margin(margin: Margin) -> page.MarginValue:
    return page.MarginValue(
        to=_rate(margin.to),
        topic=margin.topic.text,
        property=margin.property,
        from_value=margin.from_value,
        to_value=margin.to_value,
    )


def _keep_within(one: KeepWithin, place: _Place) -> page.WithinStatement:
    return page.WithinStatement(topic=one.topic.text, property=one.property, bound=one.bound, **place)


def page_value(value: Compared) -> page.Compared:
    """The right side of a check, in the words of the page."""
    return value if isinstance(value, float) else value_text(value)


def value_words(value: Value, compared: page.Compared) -> str:
    """The right side that was read for a check that compares with no number."""
    if isinstance(value, str):
        return value
    is_truth = compared in ("true", "false")
    return value_text(bool(value)) if is_truth else number_text(value)


def _duration(duration: Duration) -> page.DurationValue:
    return page.DurationValue(value=float(duration.text), unit=duration.unit)


def _until(until: Until | None) -> page.UntilValue | None:
    return None if until is None else page.UntilValue(op=until.operator, value=page_value(until.value))


def new_statement(model: page.Statement) -> NewStatement:
    """Statement that a request asks to write. Raises ``EditError`` for what no rule file can say."""
    return NewStatement(content=_content(model), comments=model.comments)


def _content(model: page.Statement) -> Statement | str:
    match model:
        case page.RawStatement():
            return model.text
        case page.SetStatement():
            return _set(model)
        case page.WithinStatement():
            return _within(model)
        case page.KeepStatement():
            rate = RateExpression(value=model.hz, text="", span=_NOWHERE)
            return KeepAtLeast(topic=_topic(model.topic), rate=rate, span=_NOWHERE)
        case page.RuleStatement():
            name = model.name
            if name is None and model.priority:
                name = model.label or _UNNAMED
            return Block(
                name=name,
                priority=model.priority or None,
                label=name or model.label,
                condition=_read_condition(model.condition),
                then=tuple(map(_read_action, model.then)),
                otherwise=tuple(map(_read_action, model.otherwise)),
                has_end_if=True,
                is_disabled=model.is_disabled,
                span=_NOWHERE,
            )


def _read_action(model: page.Action) -> Action:
    match model:
        case page.SetStatement():
            return _set(model)
        case page.WithinStatement():
            return _within(model)
        case page.RecordStatement():
            return RecordIncident(
                name=model.name,
                topics=tuple(map(_topic, model.topics)),
                before=_read_duration(model.before),
                after=_read_duration(model.after),
                span=_NOWHERE,
            )
        case page.ParameterStatement():
            return SetParameter(
                node=_topic(model.node),
                parameter=model.parameter,
                parameter_span=_NOWHERE,
                value=_read_parameter(model.value),
                text=model.value.strip(),
                span=_NOWHERE,
            )
        case page.CallStatement():
            return CallService(service=_topic(model.service), argument=model.argument, span=_NOWHERE)
        case page.NotifyStatement():
            return Notify(text=model.text, span=_NOWHERE)


def _set(model: page.SetStatement) -> SetFrequency:
    margin = None if model.margin is None else _read_margin(model.margin)
    return SetFrequency(topic=_topic(model.topic), rate=_read_rate(model.rate), margin=margin, span=_NOWHERE)


def _read_rate(model: page.Rate) -> RateExpression:
    return RateExpression(value=_rate_value(model), text="", span=_NOWHERE)


def _read_margin(model: page.MarginValue) -> Margin:
    return Margin(
        to=_read_rate(model.to),
        topic=_topic(model.topic),
        property=model.property,
        property_span=_NOWHERE,
        from_value=model.from_value,
        from_text="",
        to_value=model.to_value,
        to_text="",
        span=_NOWHERE,
    )


def _within(model: page.WithinStatement) -> KeepWithin:
    return KeepWithin(
        topic=_topic(model.topic),
        property=model.property,
        property_span=_NOWHERE,
        bound=model.bound,
        text="",
        span=_NOWHERE,
    )


def _read_duration(model: page.DurationValue) -> Duration:
    text = number_text(model.value)
    return Duration(text=text, unit=model.unit, ns=duration_ns(text, model.unit), span=_NOWHERE)


def _read_until(model: page.UntilValue | None) -> Until | None:
    return (
        None
        if model is None
        else Until(operator=model.op, value=_read_value(model.value), text="", span=_NOWHERE)
    )


def _read_value(value: page.Compared) -> Compared:
    """Raises ``EditError`` for a text that no rule file can compare with."""
    if not isinstance(value, str):
        return value
    read = written_value(value)
    if read is None:
        raise EditError(f"{value[:40]} is no number, text in quotes, constant, true or false")
    return read


def _read_parameter(text: str) -> float | bool | str:
    """Raises ``EditError`` for what no parameter can be."""
    read = _read_value(text)
    if isinstance(read, Constant):
        raise EditError(f"{text[:40]} is no number, text in quotes, true or false")
    return read


def _topic(name: str) -> TopicName:
    return TopicName(text=name, span=_NOWHERE)


def _read_condition(model: page.Condition) -> Condition:
    match model:
        case page.CheckCondition():
            return Check(
                topic=_topic(model.topic),
                property=model.property,
                property_span=_NOWHERE,
                operator=model.op,
                value=_read_value(model.value),
                text="",
                span=_NOWHERE,
                until=_read_until(model.until),
            )
        case page.TimedCondition():
            return Timed(
                operand=_read_condition(model.term),
                word=model.word,
                duration=_read_duration(model.duration),
                span=_NOWHERE,
            )
        case page.NotCondition():
            return Not(operand=_read_condition(model.term), span=_NOWHERE)
        case page.AndCondition():
            return _joined(And, model.terms)
        case page.OrCondition():
            return _joined(Or, model.terms)


def _joined(kind: type[And | Or], terms: Sequence[page.Condition]) -> Condition:
    if not terms:
        raise EditError("an 'AND' or 'OR' has no conditions in it", remedy="put a check in it")
    operands = [_read_condition(term) for term in terms]
    if len(operands) == 1:
        return operands[0]
    grouped = (Group(operand=one, span=_NOWHERE) if isinstance(one, And | Or) else one for one in operands)
    return kind(operands=tuple(grouped), span=_NOWHERE)


def _rate(rate: RateExpression) -> page.Rate:
    match rate.value:
        case Tier():
            return page.TierRate(value=rate.value)
        case RateWord.FULL:
            return page.FullRate()
        case RateWord.OFF:
            return page.OffRate()
        case _:
            return page.Hz(value=_hertz(rate))


def _hertz(rate: RateExpression) -> float:
    if isinstance(rate.value, Tier | RateWord):
        raise TypeError(rate.value)
    return rate.value


def _rate_value(rate: page.Rate) -> float | Tier | RateWord:
    match rate:
        case page.Hz() | page.TierRate():
            return rate.value
        case page.FullRate():
            return RateWord.FULL
        case page.OffRate():
            return RateWord.OFF

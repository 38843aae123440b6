# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks, ``[Disabled] [Rule …] If … Then … [Else …] [EndIf]``, and what stands in them."""

from __future__ import annotations

import re
from dataclasses import dataclass

from smarttestudo.domain.finding import Fix
from smarttestudo.domain.rate import Tier
from smarttestudo.language.parser.comparisons import parse_value
from smarttestudo.language.parser.conditions import parse_condition
from smarttestudo.language.parser.cursor import SAFE_PLACES, BrokenStatementError, Cursor
from smarttestudo.language.parser.lexer import CONNECTIVES, Token, TokenKind
from smarttestudo.language.parser.values import (
    parse_bound,
    parse_duration,
    parse_margin,
    parse_name,
    parse_property,
    parse_rate,
    parse_topic,
    parse_topics,
    quoted,
)
from smarttestudo.language.syntax import (
    NO_TRIVIA,
    Act,
    Action,
    And,
    Block,
    CallService,
    Comment,
    Condition,
    Constant,
    Duration,
    KeepWithin,
    Margin,
    Not,
    Notify,
    Or,
    RateExpression,
    RecordIncident,
    SetFrequency,
    SetParameter,
    Timed,
    TopicName,
    Trivia,
    label_in,
    unnamed_label,
)

_INTEGER = re.compile(r"[+-]?[0-9]{1,9}")
_EXPECTED_NAME = "the rule's name in quotes"
_IF_EMPTY = "leave out 'Rule' for a block without a name"


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleLine:
    """A block's name and priority; ``is_written`` is whether there is a ``Rule``."""

    name: str | None = None
    priority: int | None = None
    is_written: bool = False


def parse_rule_line(cursor: Cursor) -> RuleLine:
    """``Rule "name" [Priority n]``; after an error in it the cursor is at ``If``, or the block is broken."""
    cursor.advance()
    try:
        name = parse_name(cursor, _EXPECTED_NAME, example='Rule "Corridor"', if_empty=_IF_EMPTY)
        cursor.mend("expected-if", "'Priority' or 'If'", (TokenKind.PRIORITY, TokenKind.IF))
        priority = _priority(cursor) if cursor.accept(TokenKind.PRIORITY) else None
        cursor.mend("expected-if", "'If'", (TokenKind.IF,))
    except BrokenStatementError:
        cursor.skip_to(SAFE_PLACES)
        if cursor.kind is not TokenKind.IF:
            raise
        return RuleLine(is_written=True)
    return RuleLine(name=name, priority=priority, is_written=True)


def _priority(cursor: Cursor) -> int:
    token = cursor.token
    if token.kind is not TokenKind.NUMBER or not _INTEGER.fullmatch(token.text):
        raise cursor.failure("invalid-priority", "a whole number of at most nine digits")
    cursor.advance()
    return int(token.text)


def parse_record(cursor: Cursor) -> RecordIncident:
    """The whole statement; both durations are written, and they are not both 0."""
    first = cursor.advance()
    name = parse_name(
        cursor, "the recording's name in quotes", example='Record "near miss" Before 30 s After 10 s'
    )
    topics: list[TopicName] = []
    while cursor.kind is TokenKind.WORD and not cursor.mend(
        "expected-before", "'Before'", (TokenKind.BEFORE,)
    ):
        topics.append(parse_topics(cursor))
    before = _part(cursor, TokenKind.BEFORE)
    after = _part(cursor, TokenKind.AFTER)
    span = cursor.span_from(first)
    if not before.ns and not after.ns:
        cursor.report(
            "empty-window", "the window is empty", span=span, hint="a duration above 0 s records something"
        )
    return RecordIncident(
        name=name,
        topics=tuple(topics),
        before=before,
        after=after,
        span=span,
        trivia=cursor.take_trivia(first),
    )


def _part(cursor: Cursor, keyword: TokenKind) -> Duration:
    word = f"'{keyword.value}'"
    code = f"expected-{keyword.value.lower()}"
    cursor.mend(code, word, (keyword,))
    if cursor.accept(keyword) is None:
        hint = 'for instance Record "near miss" Before 30 s After 10 s'
        raise cursor.failure(code, word, hint=hint)
    return parse_duration(cursor)


# Below Python 3.12, looking a member up in its enum costs as much as a call.
_SET_FREQUENCY, _KEEP_WITHIN, _RECORD, _DISABLED, _RULE, _IF, _THEN, _ELSE, _END_IF = (
    TokenKind.SET_FREQUENCY,
    TokenKind.KEEP_WITHIN,
    TokenKind.RECORD,
    TokenKind.DISABLED,
    TokenKind.RULE,
    TokenKind.IF,
    TokenKind.THEN,
    TokenKind.ELSE,
    TokenKind.END_IF,
)
_ACTIONS = frozenset(
    {_SET_FREQUENCY, _KEEP_WITHIN, _RECORD, TokenKind.SET_PARAMETER, TokenKind.CALL, TokenKind.NOTIFY}
)
_ACTIONS_END = SAFE_PLACES - {*_ACTIONS, _THEN}
_ARGUMENTS = {"true": True, "false": False}
_PARAMETER = re.compile(r"[A-Za-z_][A-Za-z0-9_.\-]*")
_EXPECTED_BLOCK = "'Rule' or 'If'"
_DISABLED_HINT = "'Disabled' stands before a block, which it switches off"
_EXPECTED_ACTION = "'SetFrequency', 'KeepWithin', 'Record', 'SetParameter', 'Call' or 'Notify'"
_EXPECTED_AFTER_ACTION = "a statement of the block, 'Else', 'EndIf' or the next rule"
_AFTER_ACTION = frozenset(
    {
        *_ACTIONS,
        TokenKind.KEEP_AT_LEAST,
        TokenKind.ELSE,
        TokenKind.END_IF,
        TokenKind.DISABLED,
        TokenKind.RULE,
        TokenKind.IF,
        TokenKind.END,
    }
)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Head:
    """Everything up to ``Then``; without a ``Rule``, ``trivia`` is that of ``If``."""

    rule: RuleLine
    condition: Condition
    trivia: Trivia
    if_trivia: Trivia
    then_trivia: Trivia

    @property
    def comments(self) -> tuple[Comment, ...]:
        """The comments above the block, where the formatter puts those before its first check, too."""
        return (*self.trivia.above, *comments_above(self.condition))


def parse_set(cursor: Cursor) -> SetFrequency:
    """``SetFrequency TOPIC rate``, which may go by a margin."""
    first = cursor.advance()
    topic = parse_topics(cursor)
    rate = parse_rate(cursor)
    margin = parse_margin(cursor)
    if margin is not None:
        _check_ends(cursor, rate, margin)
    return SetFrequency(
        topic=topic, rate=rate, margin=margin, span=cursor.span_from(first), trivia=cursor.take_trivia(first)
    )


def _check_ends(cursor: Cursor, rate: RateExpression, margin: Margin) -> None:
    kinds = {type(rate.value), type(margin.to.value)}
    if kinds not in ({float}, {Tier}):
        message = "a rate goes from one number to another, or from one quality level to another"
        cursor.report("margin-end", message, span=rate.span.to(margin.to.span))
    elif rate.value == margin.to.value:
        cursor.report("empty-margin", "the two rates are equal", span=rate.span.to(margin.to.span))
    elif margin.from_value == margin.to_value:
        cursor.report("empty-margin", "the two values are equal", span=margin.span)


def parse_within(cursor: Cursor) -> KeepWithin:
    """``KeepWithin TOPIC PROPERTY bound``."""
    first = cursor.advance()
    topic = parse_topics(cursor, split_property=True)
    name = parse_property(cursor, topic.text)
    bound, text = parse_bound(cursor)
    return KeepWithin(
        topic=topic,
        property=name.text,
        property_span=name.span,
        bound=bound,
        text=text,
        span=cursor.span_from(first),
        trivia=cursor.take_trivia(first),
    )


def parse_block(cursor: Cursor) -> Block | None:
    """A block, or ``None`` when it is broken; the statements in it are checked all the same."""
    first = cursor.token
    is_disabled = _take_disabled(cursor)
    head = _head_or_recover(cursor, first)
    then = parse_actions(cursor, after_error=head is None)
    otherwise: tuple[Action, ...] = ()
    else_trivia = end_if_trivia = NO_TRIVIA
    if started := cursor.accept(_ELSE):
        else_trivia = cursor.take_trivia(started)
        cursor.begin_statement()
        otherwise = parse_actions(cursor, after_error=head is None)
        _refuse_more_else(cursor)
    if ended := cursor.accept(_END_IF):
        cursor.is_block_open = False
        end_if_trivia = cursor.take_trivia(ended)
    if head is None or not then:
        return None
    return Block(
        name=head.rule.name,
        priority=head.rule.priority,
        label=head.rule.name or label_in(head.comments) or unnamed_label(first.line),
        condition=head.condition,
        then=then,
        otherwise=otherwise,
        has_end_if=ended is not None,
        span=cursor.span_from(first),
        is_disabled=is_disabled,
        trivia=head.trivia,
        if_trivia=head.if_trivia,
        then_trivia=head.then_trivia,
        else_trivia=else_trivia,
        end_if_trivia=end_if_trivia,
    )


def _take_disabled(cursor: Cursor) -> bool:
    """Whether ``Disabled`` was there; what follows it is a block, or the statement is given up."""
    if cursor.accept(_DISABLED) is None:
        return False
    cursor.mend("expected-if", _EXPECTED_BLOCK, (_RULE, _IF))
    if cursor.kind not in (_RULE, _IF):
        raise cursor.failure("expected-if", _EXPECTED_BLOCK, hint=_DISABLED_HINT)
    return True


def _refuse_more_else(cursor: Cursor) -> None:
    while cursor.kind is _ELSE:
        cursor.begin_statement()
        cursor.report("stray-keyword", "the block has an 'Else' already")
        cursor.advance()
        parse_actions(cursor, after_error=True)


def parse_actions(cursor: Cursor, *, after_error: bool) -> tuple[Action, ...]:
    """The statements after ``Then`` or ``Else``; none at all is an error, unless it follows from another."""
    statements: list[Action] = []
    is_broken = after_error
    while cursor.kind not in _ACTIONS_END:
        cursor.begin_statement()
        if cursor.kind in _ACTIONS:
            cursor.is_block_open = True
            try:
                statements.append(_parse_action(cursor))
            except BrokenStatementError:
                is_broken = True
                cursor.skip_to(SAFE_PLACES)
        elif not cursor.mend("expected-statement", _EXPECTED_AFTER_ACTION, _AFTER_ACTION):
            is_broken = True
            cursor.report_found("expected-statement", _EXPECTED_AFTER_ACTION)
            cursor.advance()
            cursor.skip_to(SAFE_PLACES)
    if not statements and not is_broken:
        cursor.report_missing("expected-statement", _EXPECTED_ACTION, hint=_nesting_hint(cursor))
    return tuple(statements)


def _parse_action(cursor: Cursor) -> Action:
    kind = cursor.kind
    if kind is _SET_FREQUENCY:
        return parse_set(cursor)
    if kind is _KEEP_WITHIN:
        return parse_within(cursor)
    return parse_record(cursor) if kind is _RECORD else _parse_act(cursor, kind)


def _parse_act(cursor: Cursor, kind: TokenKind) -> Act:
    if kind is TokenKind.SET_PARAMETER:
        return _parse_parameter(cursor)
    first = cursor.advance()
    if kind is TokenKind.NOTIFY:
        text = parse_name(cursor, "the text in quotes", example='Notify "The robot waits for help"')
        return Notify(text=text, span=cursor.span_from(first), trivia=cursor.take_trivia(first))
    service = parse_topic(cursor)
    argument = _ARGUMENTS.get(cursor.token.text) if cursor.kind is TokenKind.WORD else None
    if argument is not None:
        cursor.advance()
    return CallService(
        service=service,
        argument=argument,
        span=cursor.span_from(first),
        trivia=cursor.take_trivia(first),
    )


def _parse_parameter(cursor: Cursor) -> SetParameter:
    first = cursor.advance()
    node = parse_topic(cursor)
    name = cursor.token
    if name.kind is not TokenKind.WORD or not _PARAMETER.fullmatch(name.text):
        hint = "for instance SetParameter /camera_driver jpeg_quality 40"
        raise cursor.failure("expected-parameter", f"a parameter of '{node.text}'", hint=hint)
    cursor.advance()
    at = cursor.token
    value, text = parse_value(cursor)
    if isinstance(value, Constant):
        cursor.report(
            "constant-parameter", "a parameter has no constants", span=at.span, hint=quoted(at.text)
        )
        raise BrokenStatementError
    return SetParameter(
        node=node,
        parameter=name.text,
        parameter_span=name.span,
        value=value,
        text=text,
        span=cursor.span_from(first),
        trivia=cursor.take_trivia(first),
    )


def comments_above(condition: Condition) -> tuple[Comment, ...]:
    """The comments before the first check or parenthesis of ``condition``."""
    match condition:
        case And() | Or():
            return comments_above(condition.operands[0])
        case Timed():
            return comments_above(condition.operand)
        case Not():
            return (*condition.trivia.above, *comments_above(condition.operand))
        case _:
            return condition.trivia.above


def _nesting_hint(cursor: Cursor) -> str:
    if cursor.kind is not TokenKind.IF:
        return ""
    if cursor.previous.kind is TokenKind.ELSE:
        return "there is no 'Else If'; write a block of its own"
    return "blocks do not nest; join the conditions with 'AND'"


def _head_or_recover(cursor: Cursor, first: Token) -> _Head | None:
    try:
        return _head(cursor, first)
    except BrokenStatementError:
        cursor.skip_to(SAFE_PLACES)
        cursor.mend("expected-then", "'Then'", (TokenKind.THEN,))
        cursor.accept(TokenKind.THEN)
        return None


def _head(cursor: Cursor, first: Token) -> _Head:
    """The statement behind ``first`` where that is ``Disabled``, else the one that begins with it."""
    rule, trivia = RuleLine(), NO_TRIVIA
    if cursor.kind is _RULE:
        rule = parse_rule_line(cursor)
        trivia = cursor.take_trivia(first)
    if_token = cursor.token
    if if_token.kind is not _IF:
        fix = Fix(span=if_token.start, replacement="If ", title="put 'If' here")
        raise cursor.failure("expected-if", "'If'", fix=fix if if_token.kind in _CONDITION_STARTS else None)
    cursor.advance()
    if_trivia = Trivia(
        above=cursor.take_above(), blank_above=(if_token if rule.is_written else first).blank_above
    )
    condition = parse_condition(cursor)
    then = _then(cursor)
    return _Head(
        rule=rule,
        condition=condition,
        trivia=trivia if rule.is_written else if_trivia,
        if_trivia=if_trivia if rule.is_written else NO_TRIVIA,
        then_trivia=cursor.take_trivia(then),
    )


_CONDITION_STARTS = frozenset({TokenKind.CHECK_VALUE, TokenKind.OPEN, TokenKind.NOT})


def _then(cursor: Cursor) -> Token:
    token = cursor.token
    if token.kind in CONNECTIVES or cursor.mend("expected-then", "'Then'", CONNECTIVES):
        raise cursor.failure(
            "missing-parentheses", "'Then'", hint="put the whole condition in parentheses: If (… AND …) Then"
        )
    if token.kind is TokenKind.CLOSE:
        fix = Fix(span=token.span, replacement="", title="delete it")
        cursor.report("stray-parenthesis", "no '(' is open for this ')'", fix=fix)
        raise BrokenStatementError
    cursor.mend("expected-then", "'Then'", (_THEN,))
    if cursor.kind is not _THEN:
        fix = Fix(span=token.start, replacement="Then ", title="put 'Then' here")
        raise cursor.failure("expected-then", "'Then'", fix=fix if token.kind in _ACTIONS else None)
    return cursor.advance()

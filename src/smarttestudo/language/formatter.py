# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The house style of rule files, printed from the syntax tree."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from smarttestudo.domain.rate import Tier
from smarttestudo.language.parser import parse
from smarttestudo.language.parser.lexer import TokenKind
from smarttestudo.language.parser.values import quoted
from smarttestudo.language.syntax import (
    Act,
    Action,
    And,
    Block,
    CallService,
    Check,
    Collection,
    Comment,
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
    RuleFile,
    SetFrequency,
    SetParameter,
    Statement,
    Timed,
    Trivia,
    Until,
)

INDENT = 4
BEFORE_COMMENT = "  "


class LineWriter:
    """Collects lines; two blank lines never follow each other, and none opens or ends an indented part."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._can_be_blank = False

    def line(self, level: int, text: str, beside: Comment | None = None) -> None:
        """Add ``text`` at indentation ``level``, with the comment beside it."""
        comment = f"{BEFORE_COMMENT}{beside.text}" if beside is not None else ""
        self._lines.append(f"{' ' * (INDENT * level)}{text}{comment}")
        self._can_be_blank = True

    def opening_line(self, level: int, text: str, beside: Comment | None = None) -> None:
        """Add a line after which an indented part begins."""
        self.line(level, text, beside)
        self._can_be_blank = False

    def blank(self) -> None:
        """Add a blank line where one may be."""
        if self._can_be_blank:
            self._lines.append("")
        self._can_be_blank = False

    def comments(self, level: int, comments: Iterable[Comment]) -> None:
        """Add comments on lines of their own, with the blank lines above them."""
        for comment in comments:
            if comment.blank_above:
                self.blank()
            self.line(level, comment.text)

    def above(self, level: int, trivia: Trivia) -> None:
        """Add what stands above a statement."""
        self.comments(level, trivia.above)
        if trivia.blank_above:
            self.blank()

    def text(self) -> str:
        """All lines, the last one ended like the others."""
        return "".join(f"{line}\n" for line in self._lines)


def number_text(value: float) -> str:
    """The shortest spelling that reads back as ``value``, a whole number without its ``.0``."""
    return repr(float(value)).removesuffix(".0")


def value_text(value: Compared) -> str:
    """A value as one would write it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    return str(value) if isinstance(value, Constant) else number_text(value)


def within_text(statement: KeepWithin) -> str:
    """The statement on one line, without its comments."""
    return f"KeepWithin {statement.topic.text} {statement.property} {bound_text(statement)}"


def bound_text(statement: KeepWithin) -> str:
    """The bound as written, or as one would write it where the tree holds no spelling."""
    bound = statement.bound
    return bound.value if isinstance(bound, Tier) else statement.text or number_text(bound)


def duration_text(duration: Duration) -> str:
    """The duration as written."""
    return f"{duration.text} {duration.unit.value}"


def set_text(statement: SetFrequency) -> str:
    """The statement on one line, without its comments."""
    rate = rate_text(statement.rate)
    margin = "" if statement.margin is None else f" {margin_text(statement.margin)}"
    return f"SetFrequency {statement.topic.text} {rate}{margin}"


def margin_text(margin: Margin) -> str:
    """``.. 20 By /scan distance 3 .. 0.5``."""
    from_text = margin.from_text or number_text(margin.from_value)
    to_text = margin.to_text or number_text(margin.to_value)
    read = f"{margin.topic.text} {margin.property}"
    return f".. {rate_text(margin.to)} By {read} {from_text} .. {to_text}"


def act_text(statement: Act) -> str:
    """The statement on one line, without its comments."""
    match statement:
        case SetParameter():
            value = statement.text or value_text(statement.value)
            return f"SetParameter {statement.node.text} {statement.parameter} {value}"
        case CallService(argument=None):
            return f"Call {statement.service.text}"
        case CallService():
            return f"Call {statement.service.text} {'true' if statement.argument else 'false'}"
        case Notify():
            return f"Notify {quoted(statement.text)}"


def rate_text(rate: RateExpression) -> str:
    """The rate as written, or as one would write it where the tree holds no spelling."""
    if isinstance(rate.value, Tier | RateWord):
        name: str = rate.value.value
        return name
    unit = " Hz" if rate.has_unit else ""
    return f"{rate.text or number_text(rate.value)}{unit}"


MAX_WIDTH = 100


def write_condition(writer: LineWriter, level: int, lead: str, condition: Condition) -> None:
    """Add the whole condition of a block; ``lead`` stands before it on its first line."""
    _write(writer, level, lead, _grouped(condition))


def _write(writer: LineWriter, level: int, lead: str, condition: Condition, tail: str = "") -> None:
    """Add ``condition``; ``tail`` stands behind it on its last line."""
    match condition:
        case Check():
            _write_comments(writer, level, condition.trivia.above)
            writer.line(level, f"{lead}CheckValue {check_text(condition)}{tail}", condition.trivia.beside)
        case Not():
            _write_comments(writer, level, condition.trivia.above)
            _write(writer, level, f"{lead}Not ", _grouped(condition.operand))
        case Group():
            _write_group(writer, level, lead, condition, tail)
        case Timed():
            _write(writer, level, lead, _timed_operand(condition), f" {time_text(condition)}{tail}")
        case And() | Or():
            _write_joined(writer, level, lead, condition, level)


def _write_group(writer: LineWriter, level: int, lead: str, group: Group, tail: str) -> None:
    _write_comments(writer, level, group.trivia.above)
    line = _one_line(_group_pieces(group), _room(level, lead) - len(tail))
    if line is not None:
        writer.line(level, f"{lead}{line}{tail}", group.trivia.beside)
        return
    writer.line(level, f"{lead}(")
    _write(writer, level + 1, "", group.operand)
    _write_comments(writer, level + 1, group.closing)
    writer.line(level, f"){tail}", group.trivia.beside)


def _write_joined(
    writer: LineWriter, level: int, lead: str, condition: And | Or, level_of_others: int
) -> None:
    """One operand a line; those of an ``AND`` inside an ``OR`` stand one level in, but for the first."""
    connective = "AND " if isinstance(condition, And) else "OR "
    at, before = level, lead
    for operand in condition.operands:
        _write_operand(writer, at, before, _bound(operand, condition))
        at, before = level_of_others, connective


def _write_operand(writer: LineWriter, level: int, lead: str, operand: Condition) -> None:
    line = _one_line(_pieces(operand), _room(level, lead))
    if line is not None:
        writer.line(level, f"{lead}{line}")
    elif isinstance(operand, And | Or):
        _write_joined(writer, level, lead, operand, level + 1)
    else:
        _write(writer, level, lead, operand)


def _write_comments(writer: LineWriter, level: int, comments: Iterable[Comment]) -> None:
    for comment in comments:
        writer.line(level, comment.text)


def _grouped(condition: Condition) -> Condition:
    """Where the language wants one condition, several need parentheses."""
    return Group(operand=condition, span=condition.span) if isinstance(condition, And | Or) else condition


def _bound(operand: Condition, around: And | Or) -> Condition:
    """An ``OR`` inside an ``AND`` needs parentheses."""
    return _grouped(operand) if isinstance(around, And) and isinstance(operand, Or) else operand


def _timed_operand(timed: Timed) -> Condition:
    """Without parentheses, a time behind a ``Not`` would belong to what the ``Not`` is about."""
    operand = timed.operand
    return Group(operand=operand, span=operand.span) if isinstance(operand, And | Or | Not) else operand


def time_text(timed: Timed) -> str:
    """``For 5 s``."""
    return f"{timed.word.value} {duration_text(timed.duration)}"


def _room(level: int, lead: str) -> int:
    return MAX_WIDTH - INDENT * level - len(lead)


def _one_line(pieces: Iterable[str | None], room: int) -> str | None:
    """The pieces on one line; ``None`` when they need more than ``room`` or hold a comment."""
    line: list[str] = []
    for piece in pieces:
        if piece is None or len(piece) > room:
            return None
        room -= len(piece)
        line.append(piece)
    return "".join(line)


def _pieces(condition: Condition) -> Iterator[str | None]:
    """The condition in pieces of text, with ``None`` for a comment."""
    if not isinstance(condition, And | Or | Timed) and (condition.trivia.above or condition.trivia.beside):
        yield None
    match condition:
        case Check():
            yield f"CheckValue {check_text(condition)}"
        case Not():
            yield "Not "
            yield from _pieces(_grouped(condition.operand))
        case Group():
            yield from _group_pieces(condition)
        case Timed():
            yield from _pieces(_timed_operand(condition))
            yield f" {time_text(condition)}"
        case And() | Or():
            connective = " AND " if isinstance(condition, And) else " OR "
            for index, operand in enumerate(condition.operands):
                yield connective if index else ""
                yield from _pieces(_bound(operand, condition))


def _group_pieces(group: Group) -> Iterator[str | None]:
    yield "("
    yield from _pieces(group.operand)
    if group.closing:
        yield None
    yield ")"


def check_text(check: Check) -> str:
    """A check without its keyword."""
    text = f"{check.topic.text} {check.property} {check.operator.value} {compared_text(check)}"
    return text if check.until is None else f"{text} {until_text(check.until)}"


def until_text(until: Until) -> str:
    """``Until > 25``."""
    return f"Until {until.operator.value} {compared_text(until)}"


def compared_text(comparison: Check | Until) -> str:
    """The value as written, or as one would write it where the tree holds no spelling."""
    return comparison.text or value_text(comparison.value)


def format_rules(text: str, path: str) -> str:
    """``text`` in the house style, with the line ends of its first line; unchanged if it has an error.

    Comments, blank lines, order and the spelling of numbers stay.
    """
    result = parse(text, path)
    return format_file(result.file, line_end=first_line_end(text)) if result.is_valid else text


def first_line_end(text: str) -> str:
    """CRLF for a text whose first line ends so, else LF."""
    return "\r\n" if text.partition("\n")[0].endswith("\r") else "\n"


def format_file(file: RuleFile, *, line_end: str = "\n") -> str:
    """The text of a syntax tree, whether parsed or built by a program."""
    writer = LineWriter()
    for collection in file.collections:
        _write_collection(writer, collection)
    writer.comments(0, file.footer)
    return writer.text().replace("\n", line_end)


def format_statement(statement: Statement | Action) -> str:
    """The lines of one statement without indentation, each ended by LF."""
    writer = LineWriter()
    _write_statement(writer, 0, statement)
    return writer.text()


def format_condition(condition: Condition) -> str:
    """The lines of what stands behind ``If``, without indentation, each ended by LF."""
    writer = LineWriter()
    write_condition(writer, 0, "", condition)
    return writer.text()


def format_heading(block: Block) -> str:
    """``Rule "name" [Priority n]``, or nothing for a block without name and priority."""
    if block.name is None and block.priority is None:
        return ""
    priority = "" if block.priority is None else f" Priority {block.priority}"
    return f"Rule {quoted(block.name if block.name is not None else block.label)}{priority}"


def _write_collection(writer: LineWriter, collection: Collection) -> None:
    writer.blank()
    writer.above(0, collection.trivia)
    writer.opening_line(0, "begin", collection.trivia.beside)
    previous: Statement | None = None
    for statement in collection.statements:
        if isinstance(previous, Block) or isinstance(statement, Block):
            _write_missing_end(writer, previous, statement)
            writer.blank()
        _write_statement(writer, 1, statement)
        previous = statement
    writer.comments(1, collection.end_trivia.above)
    writer.line(0, "end", collection.end_trivia.beside)


def _write_missing_end(writer: LineWriter, previous: Statement | None, following: Statement) -> None:
    """Without ``EndIf`` the block before would take in what follows."""
    if isinstance(previous, Block) and not previous.has_end_if and not isinstance(following, Block):
        writer.line(1, "EndIf")


def _write_statement(writer: LineWriter, level: int, statement: Statement | Action) -> None:
    writer.above(level, statement.trivia)
    match statement:
        case SetFrequency():
            writer.line(level, set_text(statement), statement.trivia.beside)
        case KeepAtLeast():
            text = f"KeepAtLeast {statement.topic.text} {rate_text(statement.rate)}"
            writer.line(level, text, statement.trivia.beside)
        case KeepWithin():
            writer.line(level, within_text(statement), statement.trivia.beside)
        case RecordIncident():
            writer.line(level, _record_text(statement), statement.trivia.beside)
        case SetParameter() | CallService() | Notify():
            writer.line(level, act_text(statement), statement.trivia.beside)
        case Block():
            _write_block(writer, level, statement)


def _record_text(record: RecordIncident) -> str:
    names = "".join(f" {topic.text}" for topic in record.topics)
    window = f"Before {duration_text(record.before)} After {duration_text(record.after)}"
    return f"Record {quoted(record.name)}{names} {window}"


def _write_block(writer: LineWriter, level: int, block: Block) -> None:
    heading = format_heading(block)
    disabled = f"{TokenKind.DISABLED.value} " if block.is_disabled else ""
    if heading:
        writer.line(level, f"{disabled}{heading}", block.trivia.beside)
        writer.comments(level, block.if_trivia.above)
    write_condition(writer, level, "If " if heading else f"{disabled}If ", block.condition)
    writer.comments(level, block.then_trivia.above)
    writer.opening_line(level, "Then", block.then_trivia.beside)
    for statement in block.then:
        _write_statement(writer, level + 1, statement)
    if block.otherwise:
        writer.comments(level, block.else_trivia.above)
        writer.opening_line(level, "Else", block.else_trivia.beside)
        for statement in block.otherwise:
            _write_statement(writer, level + 1, statement)
    if block.has_end_if:
        writer.comments(level + 1, block.end_if_trivia.above)
        writer.line(level, "EndIf", block.end_if_trivia.beside)

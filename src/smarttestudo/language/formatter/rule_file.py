# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The house style of rule files, printed from the syntax tree."""

from __future__ import annotations

from smarttestudo.language.formatter.conditions import write_condition
from smarttestudo.language.formatter.text import LineWriter, duration_text, rate_text, within_text
from smarttestudo.language.parser import parse
from smarttestudo.language.parser.headings import quoted
from smarttestudo.language.parser.tokens import TokenKind
from smarttestudo.language.syntax import (
    Action,
    Block,
    Collection,
    Condition,
    KeepAtLeast,
    KeepWithin,
    RecordIncident,
    RuleFile,
    SetFrequency,
    Statement,
)


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
            text = f"SetFrequency {statement.topic.text} {rate_text(statement.rate)}"
            writer.line(level, text, statement.trivia.beside)
        case KeepAtLeast():
            text = f"KeepAtLeast {statement.topic.text} {rate_text(statement.rate)}"
            writer.line(level, text, statement.trivia.beside)
        case KeepWithin():
            writer.line(level, within_text(statement), statement.trivia.beside)
        case RecordIncident():
            writer.line(level, _record_text(statement), statement.trivia.beside)
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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Edits of one statement; every other statement, comment and blank line keeps its bytes.

The one thing that an edit may add elsewhere is an ``EndIf``, where a block would else take in what follows.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.editing.document import CollectionPart, Document, Entry, meaning
from smarttestudo.editing.rewriting import rewritten
from smarttestudo.editing.text_edit import (
    TextEdit,
    TokenRange,
    addition,
    apply,
    comment_lines,
    comment_texts,
    removal,
)
from smarttestudo.language.formatter import INDENT, first_line_end, format_statement
from smarttestudo.language.parser import parse
from smarttestudo.language.parser.lexer import TokenKind
from smarttestudo.language.parser.values import quoted
from smarttestudo.language.syntax import Block, Statement

_END_IF = "EndIf"
_NUMBERED = re.compile(r"(?<=\S) [0-9]+\Z")
_NO_COLLECTION = "put 'begin' and 'end' around the rules"


class EditError(RuleFileError):
    """An edit of a statement or collection that is not there, or that the language cannot say."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewStatement:
    """A statement or raw text to write; ``comments`` go above it, ``None`` leaves those there are."""

    content: Statement | str
    comments: Sequence[str] | None = None


def replaced(document: Document, name: str, new: NewStatement) -> str:
    """The text with ``new`` in the place of statement ``name``; what is the same in both keeps its bytes."""
    entry = _entry(document, name)
    _require_sayable(new)
    part = document.part_of(entry)
    at = part.entries.index(entry)
    line_end = first_line_end(document.text)
    text_edits = rewritten(entry, _closed(new.content), line_end)
    if new.comments is not None and list(new.comments) != comment_texts(entry.comments):
        text_edits.append(_comments_above(entry.token_range, new.comments, line_end))
    if text_edits and at > 0 and takes_in(part.entries[at - 1], new.content):
        text_edits.append(_end_if(part.entries[at - 1], line_end))
    return apply(document.text, text_edits)


def inserted(document: Document, part_name: str, index: int, new: NewStatement) -> str:
    """The text with ``new`` before the statement that is number ``index`` of the collection."""
    return inserted_all(document, part_name, index, [new])


def inserted_all(document: Document, part_name: str, index: int, news: Sequence[NewStatement]) -> str:
    """``inserted`` for one statement or several, one below the other."""
    for new in news:
        _require_sayable(new)
    part = _part(document, part_name)
    if not 0 <= index <= len(part.entries):
        raise EditError(f"the collection has no place {index}", remedy="read the document again")
    line_end = first_line_end(document.text)
    indent = _indent(part, index)
    lines: list[str] = []
    for number, new in enumerate(news):
        if number and (_is_tall(new.content) or _is_tall(news[number - 1].content)):
            lines.append("")
        lines += [*comment_lines(new.comments or ()), *_printed(_closed(new.content)).split("\n")]
    body = line_end.join(f"{indent}{line}" if line else "" for line in lines)
    place = _Place(part=part, index=index, others=part.entries)
    return apply(document.text, _put(place, [new.content for new in news], body, line_end))


def deleted(document: Document, name: str) -> str:
    """The text without statement ``name`` and its own comments."""
    entry = _entry(document, name)
    return apply(document.text, _taken_out(document, entry))


def duplicated(document: Document, name: str) -> str:
    """The text with a copy of statement ``name``, as it is written, behind it.

    A rule's copy has the first free number behind its name: two rules of one name cannot be told apart.
    """
    entry = _entry(document, name)
    part = _part(document, document.part_of(entry).id)
    index = part.entries.index(entry) + 1
    words, line_end = entry.token_range, first_line_end(document.text)
    indent = words.indent if words.indent is not None else _indent(part, 0)
    body = indent + _copied(document, entry)
    if index < len(part.entries) and takes_in(entry, part.entries[index].statement):
        body += f"{line_end}{indent}{_END_IF}"
    place = _Place(part=part, index=index, others=part.entries)
    return apply(document.text, _put(place, [entry.statement or ""], body, line_end))


def _copied(document: Document, entry: Entry) -> str:
    """The content of a copy of ``entry``, with its own comments."""
    words, statement = entry.token_range, entry.statement
    text = document.text[words.own_start : words.own_end]
    if not isinstance(statement, Block) or statement.name is None:
        return text
    at = next(index for index, token in enumerate(words.tokens) if token.kind is TokenKind.STRING)
    start, end = words.offsets[at] - words.own_start, words[at].end - words.own_start
    return f"{text[:start]}{quoted(_free_name(document, statement.name))}{text[end:]}"


def _free_name(document: Document, name: str) -> str:
    """``name`` with the first number behind it, from 2 on, that no rule's name has."""
    taken = {entry.statement.name for entry in document.entries if isinstance(entry.statement, Block)}
    stem = _NUMBERED.sub("", name)
    return next(free for number in count(2) if (free := f"{stem} {number}") not in taken)


def moved(document: Document, name: str, part_name: str, index: int) -> str:
    """The text with statement ``name``, as it is written, at place ``index`` among the others."""
    entry = _entry(document, name)
    part = _part(document, part_name)
    others = tuple(other for other in part.entries if other is not entry)
    if not 0 <= index <= len(others):
        raise EditError(f"the collection has no place {index}", remedy="read the document again")
    if entry in part.entries and part.entries.index(entry) == index:
        return document.text
    token_range, line_end = entry.token_range, first_line_end(document.text)
    indent = token_range.indent if token_range.indent is not None else _indent(part, 0)
    body = indent + document.text[token_range.own_start : token_range.own_end]
    following = others[index] if index < len(others) else None
    if following is not None and takes_in(entry, following.statement):
        body += f"{line_end}{indent}{_END_IF}"
    text_edits = _taken_out(document, entry)
    place = _Place(part=part, index=index, others=others)
    text_edits += _put(place, [entry.statement or ""], body, line_end)
    return apply(document.text, text_edits)


def _entry(document: Document, name: str) -> Entry:
    entry = document.entry(name)
    if entry is None:
        raise EditError(f"the text has no statement {name!r}", remedy="read the document again")
    return entry


def _part(document: Document, name: str) -> CollectionPart:
    part = next((known for known in document.parts if known.id == name), None)
    if part is None or part.begin is None:
        raise EditError(
            f"the text has no collection {name!r} to write in",
            remedy="put 'begin' and 'end' around the rules",
        )
    return part


def _require_sayable(new: NewStatement) -> None:
    """Refuse what would read back as something else: an invalid topic, a rate out of range."""
    if isinstance(new.content, str):
        return
    text = f"begin\n{format_statement(new.content)}end\n"
    result = parse(text, "statement")
    if result.findings:
        first = result.findings[0]
        raise EditError(first.message, place=first.code, remedy=first.hint or None)
    if [meaning(statement) for statement in result.file.statements] != [meaning(new.content)]:
        raise EditError("a rule file cannot say this statement", remedy="write it as text")


def _closed(content: Statement | str) -> Statement | str:
    """A new block ends by itself, whatever will follow it."""
    return replace(content, has_end_if=True) if isinstance(content, Block) else content


def _printed(content: Statement | str) -> str:
    return content.strip("\r\n") if isinstance(content, str) else format_statement(content).rstrip("\n")


def _indent(part: CollectionPart, index: int) -> str:
    near = [*part.entries[max(index - 1, 0) : index], *part.entries[index : index + 1]]
    known = next(
        (sibling.token_range.indent for sibling in near if sibling.token_range.indent is not None), None
    )
    base = part.begin.indent if part.begin is not None else None
    return known if known is not None else (base or "") + " " * INDENT


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    """Before number ``index`` of ``others``, the statements of ``part``."""

    part: CollectionPart
    index: int
    others: Sequence[Entry]


def _put(place: _Place, contents: Sequence[Statement | str], body: str, line_end: str) -> list[TextEdit]:
    """Puts ``body``, which holds ``contents``, at ``place``."""
    index, others = place.index, place.others
    before, following = others[:index][-1:], others[index : index + 1]
    point = before[0].token_range if before else place.part.begin
    if point is None:
        raise EditError("there is no collection to write in", remedy=_NO_COLLECTION)
    text_edits = [_end_if(sibling, line_end) for sibling in before if takes_in(sibling, contents[0])]
    if any(_is_apart(sibling, contents[0]) for sibling in before):
        body = line_end + body
    if any(_is_apart(sibling, contents[-1]) for sibling in following) and not _is_blank_behind(point):
        body += line_end
    return [*text_edits, addition(point, body, line_end)]


def _is_apart(neighbour: Entry, content: Statement | str) -> bool:
    """Whether an empty line goes between them, as the formatter has it."""
    return isinstance(content, Block) or isinstance(neighbour.statement, Block)


def _is_tall(content: Statement | str) -> bool:
    return isinstance(content, Block | str)


def _is_blank_behind(point: TokenRange) -> bool:
    """Whether an empty line follows the line of ``point``."""
    at = point.places.after_break(point.places.line_range(point.own_end)[1])
    return not point.text[at : point.places.line_range(at)[1]].strip()


def _taken_out(document: Document, entry: Entry) -> list[TextEdit]:
    part = document.part_of(entry)
    at = part.entries.index(entry)
    following = part.entries[at + 1] if at + 1 < len(part.entries) else None
    words = entry.token_range
    text_edits = [removal(words, document.behind(words))]
    if at > 0 and following is not None and takes_in(part.entries[at - 1], following.statement):
        text_edits.append(_end_if(part.entries[at - 1], first_line_end(document.text)))
    return text_edits


def takes_in(before: Entry, following: Statement | str | None) -> bool:
    """Whether ``following`` might become a part of ``before``, a block without ``EndIf``."""
    is_open = isinstance(before.statement, Block) and not before.statement.has_end_if
    return is_open and following is not None and not isinstance(following, Block | str)


def _end_if(entry: Entry, line_end: str) -> TextEdit:
    token_range = entry.token_range
    behind = line_end if token_range.after.strip() else ""
    return TextEdit(
        token_range.own_end, token_range.own_end, f"{line_end}{token_range.indent or ''}{_END_IF}{behind}"
    )


def _comments_above(token_range: TokenRange, comments: Sequence[str], line_end: str) -> TextEdit:
    indent = token_range.indent
    lines = "".join(f"{line}{line_end}{indent or ''}" for line in comment_lines(comments))
    opening = line_end if indent is None and lines else ""
    return TextEdit(token_range.own_start, token_range.start, opening + lines)

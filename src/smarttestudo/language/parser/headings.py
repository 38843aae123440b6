# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The line that names a block: ``Rule "name" [Priority n]``."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from smarttestudo.domain.finding import Fix
from smarttestudo.language.parser.cursor import SAFE_PLACES, BrokenStatementError, Cursor
from smarttestudo.language.parser.tokens import Token, TokenKind

_INTEGER = re.compile(r"[+-]?[0-9]{1,9}")
_ESCAPE = re.compile(r"\\(.)")
_EXPECTED_NAME = "the rule's name in quotes"
_IF_EMPTY = "leave out 'Rule' for a block without a name"
_QUOTES = {"“": "”", "'": "'"}


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


def _plain_name(cursor: Cursor, token: Token, if_empty: str) -> str:
    text = token.text[1:-1]
    wrong = next((found for found in _ESCAPE.finditer(text) if found[1] not in '"\\'), None)
    if wrong is not None:
        fix = Fix(span=token.span, replacement=quoted(text), title="double every backslash")
        cursor.report(
            "invalid-name",
            f"a name cannot hold '{wrong[0]}'",
            hint='only \\" and \\\\ have a meaning',
            fix=fix,
        )
    name = _ESCAPE.sub(r"\1", text)
    if not name.strip():
        cursor.report("invalid-name", "the name is empty", hint=if_empty)
    elif not all(_can_be_shown(character) for character in name):
        cursor.report("invalid-name", "the name holds a tab or a character that cannot be seen")
    cursor.advance()
    return name


def _can_be_shown(character: str) -> bool:
    return character.isprintable() or unicodedata.category(character) == "Zs"


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


def _priority(cursor: Cursor) -> int:
    token = cursor.token
    if token.kind is not TokenKind.NUMBER or not _INTEGER.fullmatch(token.text):
        raise cursor.failure("invalid-priority", "a whole number of at most nine digits")
    cursor.advance()
    return int(token.text)

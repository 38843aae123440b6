# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text to tokens, in one pass that no text can stop."""

from __future__ import annotations

import re
from dataclasses import replace

from smarttestudo.adirf.comments import Comment
from smarttestudo.adirf.parser.tokens import CONNECTIVES, KEYWORDS, Token, TokenKind
from smarttestudo.domain.source import Span

BYTE_ORDER_MARK = "\ufeff"

_PATTERN = re.compile(
    r"""
      (?P<newline> \r\n | \r | \n )
    | (?P<blank>   [^\S\r\n]+ )
    | (?P<comment> // [^\r\n]* | \# [^\r\n]* | /\* [^\r\n]* )   # the parser tells # and /* apart from //
    | (?P<string>  " (?: [^"\\\r\n] | \\[^\r\n] )* " )
    | (?P<number>  [+-]? (?: [0-9]+ (?: \.[0-9]* )? | \.[0-9]+ ) (?: [eE][+-]?[0-9]+ )?
                   (?= (?: [kM]? [hH][zZ] )? (?! [\w.] | ,[0-9] ) ) )
    | (?P<word>    (?: [^\W\d] | ~ | / (?![/*]) ) (?: [\w~.\[\]-] | / (?![/*]) )* )
    | (?P<operator> >= | <= (?!>) | != | > | < (?!>) | = (?![=><]) )
    | (?P<open>    \( )
    | (?P<close>   \) )
    | (?P<foreign> == | => | =< | <> | && | \|\|
                 | " [^\r\n]* | ' [^'\r\n]* ' | “ [^“”\r\n]* ”
                 | [+\-−–]? \.? [0-9] [\w.]* (?: ,[0-9]+ )?
                 | [^\s\w()"'“/~.+\-−–<>=!&|#]+ | . )
    """,
    re.VERBOSE,
)
_KINDS = {
    "string": TokenKind.STRING,
    "number": TokenKind.NUMBER,
    "operator": TokenKind.OPERATOR,
    "open": TokenKind.OPEN,
    "close": TokenKind.CLOSE,
    "foreign": TokenKind.FOREIGN,
}


def tokenize(text: str) -> list[Token]:
    """The tokens of ``text`` with their comments, the last one of kind ``END_OF_FILE``.

    A byte order mark at the start is skipped. Lines end at LF, CRLF or CR; a tab is one column.
    """
    lexer = _Lexer()
    for match in _PATTERN.finditer(text.removeprefix(BYTE_ORDER_MARK)):
        lexer.take(match)
    return lexer.finish()


class _Lexer:
    def __init__(self) -> None:
        self._tokens: list[Token] = []
        self._comments: list[Comment] = []
        self._line = 1
        self._line_start = 0
        self._end = 0
        self._newlines = 0
        self._is_first = True

    def take(self, match: re.Match[str]) -> None:
        self._end = match.end()
        match match.lastgroup:
            case "newline":
                self._line += 1
                self._line_start = self._end
                self._newlines += 1
            case "comment":
                self._add_comment(match.group().rstrip(), match.start())
            case "word":
                word = match.group()
                self._add_token(KEYWORDS.get(word, TokenKind.WORD), word, match.start())
            case str() as group if group in _KINDS:
                self._add_token(_KINDS[group], match.group(), match.start())

    def finish(self) -> list[Token]:
        self._add_token(TokenKind.END_OF_FILE, "", self._end)
        return self._tokens

    def _add_token(self, kind: TokenKind, text: str, offset: int) -> None:
        token = Token(
            kind=kind,
            text=text,
            line=self._line,
            column=offset - self._line_start + 1,
            starts_line=self._starts_line,
            blank_above=self._has_blank_above,
            above=tuple(self._comments),
        )
        self._tokens.append(token)
        self._comments.clear()
        self._after_item()

    def _add_comment(self, text: str, offset: int) -> None:
        column = offset - self._line_start + 1
        span = Span(line=self._line, column=column, end_line=self._line, end_column=column + len(text))
        own_line = self._starts_line
        comment = Comment(text=text, span=span, own_line=own_line, blank_above=self._has_blank_above)
        if own_line:
            self._comments.append(comment)
        else:
            self._put_beside(comment)
        self._after_item()

    def _put_beside(self, comment: Comment) -> None:
        """A comment after ``AND`` at a line's end speaks about the check before it."""
        at = len(self._tokens) - 1
        if at > 0 and self._tokens[at].kind in CONNECTIVES and self._tokens[at - 1].line == self._line:
            at -= 1
        self._tokens[at] = replace(self._tokens[at], beside=comment)

    @property
    def _starts_line(self) -> bool:
        return self._is_first or self._newlines > 0

    @property
    def _has_blank_above(self) -> bool:
        return self._newlines > 1 and not self._is_first

    def _after_item(self) -> None:
        self._newlines = 0
        self._is_first = False

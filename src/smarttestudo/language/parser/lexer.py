# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text to tokens, in one pass that no text can stop."""

from __future__ import annotations

import re
from collections.abc import Sequence

from smarttestudo.domain.finding import Span
from smarttestudo.domain.texts import without_mark
from smarttestudo.language.comments import Comment
from smarttestudo.language.parser.tokens import CONNECTIVES, KEYWORDS, Token, TokenKind

_KEYWORD = re.compile("|".join(KEYWORDS))
_GLUED = re.compile(rf"(?P<keywords>(?:{_KEYWORD.pattern})+)(?P<topic>/.*)?\Z", re.DOTALL)
_SIGNS = frozenset("<>=!≤≥≠")
# Below Python 3.12, looking a member up in its enum costs as much as a call.
_WORD, _CHECK_VALUE = TokenKind.WORD, TokenKind.CHECK_VALUE
_BEFORE_TOPIC = frozenset({TokenKind.SET_FREQUENCY, TokenKind.KEEP_AT_LEAST, _CHECK_VALUE})


def told_apart(tokens: Sequence[Token]) -> list[Token]:
    """``tokens`` with glued keywords apart, except in the name of a topic or property.

    A keyword between a check's topic and its comparison is a property.
    """
    found: list[Token] = []
    before = before_that = None
    for token in tokens:
        kind = token.kind
        if kind is _WORD:
            is_name = before in _BEFORE_TOPIC or (before is _WORD and before_that is _CHECK_VALUE)
            if not is_name and (glued := _GLUED.match(token.text)):
                found.extend(_parts(token, [*_KEYWORD.findall(glued["keywords"]), glued["topic"] or ""]))
                before_that, before = found[-2].kind, found[-1].kind
                continue
        elif token.text[:1] in _SIGNS and _is_at_property(found):
            found[-1] = found[-1]._replace(kind=_WORD)
        found.append(token)
        before_that, before = before, kind
    return found


def _is_at_property(tokens: Sequence[Token]) -> bool:
    """Whether the last of ``tokens`` is a keyword where a check has its property."""
    return (
        len(tokens) > 2
        and tokens[-1].text in KEYWORDS
        and tokens[-2].kind is _WORD
        and tokens[-3].kind is _CHECK_VALUE
    )


def _parts(token: Token, words: Sequence[str]) -> list[Token]:
    """``token`` in its ``words``, the comments at the first and last of them."""
    parts: list[Token] = []
    column = token.column
    for word in filter(None, words):
        kind = KEYWORDS.get(word, _WORD)
        parts.append(Token(kind, word, token.line, column, is_glued=bool(parts)))
        column += len(word)
    parts[0] = parts[0]._replace(
        starts_line=token.starts_line, blank_above=token.blank_above, above=token.above
    )
    parts[-1] = parts[-1]._replace(beside=token.beside)
    return parts


_PATTERN = re.compile(
    r"""[^\S\r\n]* (?:
      (?P<word>    (?: (?!\d) [\w~] | / (?![/*]) ) [\w~.\[\]-]* (?: / (?![/*]) [\w~.\[\]-]* )* )
    | (?P<newline> \r\n | \r | \n )
    | (?P<number>  [+-]? (?: [0-9]+ (?: \.[0-9]* )? | \.[0-9]+ ) (?: [eE][+-]?[0-9]+ )?
                   (?= (?: [kM]? [hH][zZ] | ms | s | min )? (?! [\w.] | ,[0-9] ) ) )
    | (?P<operator> >= | <= (?!>) | != | > | < (?!>) | = (?![=><]) )
    | (?P<open>    \( )
    | (?P<close>   \) )
    | (?P<string>  " [^"\\\r\n]* (?: \\[^\r\n] [^"\\\r\n]* )* " )
    | (?P<comment> // [^\r\n]* | \# [^\r\n]* | /\* [^\r\n]* )   # the parser tells # and /* apart from //
    | (?P<foreign> == | => | =< | <> | && | \|\|
                 | " [^\r\n]* | ' [^'\r\n]* ' | “ [^“”\r\n]* ”
                 | [+\-−–]? \.? [0-9] [\w.]* (?: ,[0-9]+ )?
                 | [^\s\w()"'“/~.+\-−–<>=!&|#]+ | . )
    | \Z )
    """,
    re.VERBOSE,
)
"""One word with the blanks before it; it matches anywhere, without a group at the end of the text only."""

_KINDS = {
    "word": TokenKind.WORD,
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
    text = without_mark(text)[1]
    tokens: list[Token] = []
    comments: list[Comment] = []
    line, line_start = 1, -1
    newlines = -len(text) - 1  # The first word starts its line, and no line above it counts as empty.
    for match in _PATTERN.finditer(text):
        group = match.lastgroup
        if group is None:
            break
        if group == "newline":
            line += 1
            line_start = match.end() - 1
            newlines += 1
            continue
        word = match[group]
        column = match.end() - len(word) - line_start
        if group == "comment":
            span = Span(line, column, line, column + len(word.rstrip()))
            comment = Comment(text=word.rstrip(), span=span, own_line=newlines != 0, blank_above=newlines > 1)
            if comment.own_line:
                comments.append(comment)
            else:
                _put_beside(tokens, comment)
        elif newlines:
            kind = KEYWORDS.get(word) or _KINDS[group]
            above = tuple(comments)
            tokens.append(
                Token(kind, word, line, column, starts_line=True, blank_above=newlines > 1, above=above)
            )
            comments.clear()
        else:
            tokens.append(Token(KEYWORDS.get(word) or _KINDS[group], word, line, column))
        newlines = 0
    column = len(text) - line_start
    tokens.append(
        Token(TokenKind.END_OF_FILE, "", line, column, newlines != 0, newlines > 1, tuple(comments))
    )
    return told_apart(tokens)


def _put_beside(tokens: list[Token], comment: Comment) -> None:
    """A comment after ``AND`` at a line's end belongs to the check before it."""
    at = len(tokens) - 1
    if at > 0 and tokens[at].kind in CONNECTIVES and tokens[at - 1].line == comment.span.line:
        at -= 1
    tokens[at] = tokens[at]._replace(beside=comment)

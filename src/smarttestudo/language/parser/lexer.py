# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text to the words of a rule file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Tier
from smarttestudo.domain.texts import without_mark
from smarttestudo.language.syntax import Comment


class TokenKind(Enum):
    """The kind of a token; a keyword's value is its spelling.

    ``Hz``, ``Full``, ``Off``, the tiers and units of time are words: they mean something in one place only.
    ``FOREIGN`` is whatever the language does not have, such as ``==``, ``1,5`` or a quote without its end.
    """

    BEGIN = "begin"
    END = "end"
    SET_FREQUENCY = "SetFrequency"
    KEEP_AT_LEAST = "KeepAtLeast"
    KEEP_WITHIN = "KeepWithin"
    RECORD = "Record"
    SET_PARAMETER = "SetParameter"
    CALL = "Call"
    NOTIFY = "Notify"
    BY = "By"
    BEFORE = "Before"
    AFTER = "After"
    DISABLED = "Disabled"
    RULE = "Rule"
    PRIORITY = "Priority"
    IF = "If"
    THEN = "Then"
    ELSE = "Else"
    END_IF = "EndIf"
    NOT = "Not"
    AND = "AND"
    OR = "OR"
    CHECK_VALUE = "CheckValue"
    FOR = "For"
    WITHIN = "Within"
    UNTIL = "Until"
    OPEN = "("
    CLOSE = ")"
    WORD = "word"
    NUMBER = "number"
    STRING = "string"
    OPERATOR = "operator"
    RANGE = ".."
    FOREIGN = "foreign"
    END_OF_FILE = "end of file"

    __hash__ = object.__hash__  # Sets of kinds are asked once a word; the hash of an enum is a slow call.


_NO_KEYWORDS = frozenset(
    {
        TokenKind.OPEN,
        TokenKind.CLOSE,
        TokenKind.WORD,
        TokenKind.NUMBER,
        TokenKind.STRING,
        TokenKind.OPERATOR,
        TokenKind.RANGE,
        TokenKind.FOREIGN,
        TokenKind.END_OF_FILE,
    }
)
KEYWORDS = {kind.value: kind for kind in TokenKind if kind not in _NO_KEYWORDS}
CONNECTIVES = frozenset({TokenKind.AND, TokenKind.OR})


class Token(NamedTuple):
    """A word of the file and where it starts; no token goes over the end of its line.

    ``starts_line`` is whether it is the first of its line, ``blank_above`` whether an empty line is directly
    above it. ``above`` are the comments on lines of their own since the token before, ``beside`` is the one
    on the rest of its line. ``is_glued`` is whether the keyword before it is written without a blank behind.
    """

    kind: TokenKind
    text: str
    line: int
    column: int
    starts_line: bool = False
    blank_above: bool = False
    above: tuple[Comment, ...] = ()
    beside: Comment | None = None
    is_glued: bool = False

    @property
    def span(self) -> Span:
        """The stretch that the token covers."""
        return Span(self.line, self.column, self.line, self.column + len(self.text))

    @property
    def start(self) -> Span:
        """The empty stretch just before the token."""
        return Span(self.line, self.column, self.line, self.column)

    @property
    def end(self) -> Span:
        """The empty stretch just after the token."""
        column = self.column + len(self.text)
        return Span(self.line, column, self.line, column)


NEVER_GLUED = frozenset({TokenKind.SET_PARAMETER, TokenKind.CALL, TokenKind.NOTIFY, TokenKind.BY})
"""The thesis, whose files have keywords without blanks between, has none of these."""
_KEYWORD = re.compile("|".join(word for word, kind in KEYWORDS.items() if kind not in NEVER_GLUED))
_GLUED = re.compile(rf"(?P<keywords>(?:{_KEYWORD.pattern})+)(?P<topic>/.*)?\Z", re.DOTALL)
_SIGNS = frozenset("<>=!≤≥≠")
# Below Python 3.12, looking a member up in its enum costs as much as a call.
_WORD, _CHECK_VALUE = TokenKind.WORD, TokenKind.CHECK_VALUE
_TIERS = frozenset(tier.value for tier in Tier)
_BEFORE_TOPICS = tuple(
    kind.value for kind in (TokenKind.SET_FREQUENCY, TokenKind.KEEP_AT_LEAST, TokenKind.KEEP_WITHIN)
)
_BEFORE_TOPIC = frozenset({TokenKind.SET_FREQUENCY, TokenKind.KEEP_AT_LEAST, _CHECK_VALUE})


def without_glue(tokens: Sequence[Token]) -> list[Token]:
    """``tokens`` with glued keywords apart, except in the name of a topic or property.

    A keyword between a check's topic and its comparison is a property.
    """
    found: list[Token] = []
    before = before_that = None
    for token in tokens:
        kind = token.kind
        if kind is _WORD and token.text.partition("..")[0] in _TIERS:
            found.extend(_ends(token))
            before_that, before = before, kind
            continue
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


def _ends(token: Token) -> list[Token]:
    """``Marginal..Desirable`` in its words."""
    low, dots, high = token.text.partition("..")
    if not dots:
        return [token]
    column = token.column + len(low)
    parts = [
        token._replace(text=low, beside=None),
        Token(TokenKind.RANGE, dots, token.line, column),
        Token(_WORD, high, token.line, column + len(dots)),
    ]
    parts = parts if high else parts[:-1]
    parts[-1] = parts[-1]._replace(beside=token.beside)
    return parts


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


_STRING = r'" [^"\\\r\n]* (?: \\[^\r\n] [^"\\\r\n]* )* "'
_ELEMENT = rf"(?<=\[) (?: {_STRING} | \* ) \] [\w~.\[\]-]*"
"""An element by its name, or any: the rest of a word behind its ``[``."""
_FIRST_STARS = r"/ \*{1,2} (?= /[\w*~])"
_STARS = re.compile(r"/\*{1,2}(?=\s|\Z)")
_PATTERN = re.compile(
    rf"""[^\S\r\n]* (?:
      (?P<word>    (?: (?!\d) [\w~] | @ (?=\w) | / (?![/*]) | {_FIRST_STARS} ) [\w~.\[\]-]*
                   (?: / (?: \*{{1,2}} (?=[/\s]|\Z) | (?![/*]) ) [\w~.\[\]-]* | {_ELEMENT} )* )
    | (?P<newline> \r\n | \r | \n )
    | (?P<number>  [+-]? (?: [0-9]+ (?: \.(?!\.)[0-9]* )? | \.[0-9]+ ) (?: [eE][+-]?[0-9]+ )?
                   (?= (?: [kM]? [hH][zZ] | ms | s | min )? (?! \w | \.(?!\.) | ,[0-9] ) ) )
    | (?P<range>   \.\. )
    | (?P<operator> >= | <= (?!>) | != | > | < (?!>) | = (?![=><]) )
    | (?P<open>    \( )
    | (?P<close>   \) )
    | (?P<string>  {_STRING} )
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
    "range": TokenKind.RANGE,
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
    position = 0
    while (match := _PATTERN.match(text, position)) and (group := match.lastgroup):
        position = match.end()
        if group == "newline":
            line += 1
            line_start = position - 1
            newlines += 1
            continue
        word = match[group]
        column = position - len(word) - line_start
        if group == "comment" and (stars := _STARS.match(word)) and _wants_topics(tokens):
            position -= len(word) - stars.end()
            group, word = "word", stars[0]
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
    return without_glue(tokens)


def _wants_topics(tokens: Sequence[Token]) -> bool:
    """Whether a topic is next, so that ``/*`` is a pattern and no comment of another language."""
    if not tokens or tokens[-1].kind is not TokenKind.STRING:
        return bool(tokens) and tokens[-1].text.endswith(_BEFORE_TOPICS)
    return len(tokens) > 1 and tokens[-2].kind is TokenKind.RECORD


def _put_beside(tokens: list[Token], comment: Comment) -> None:
    """A comment after ``AND`` at a line's end belongs to the check before it."""
    at = len(tokens) - 1
    if at > 0 and tokens[at].kind in CONNECTIVES and tokens[at - 1].line == comment.span.line:
        at -= 1
    tokens[at] = tokens[at]._replace(beside=comment)

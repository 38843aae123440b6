# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Words whose kind depends on their place: keywords without a blank after, and properties named like one.

The grammar of the thesis is matched without a lexer: it reads ``ThenSetFrequency/odom 4`` and
``CheckValue /odom If > 3``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from smarttestudo.adirf.parser.tokens import KEYWORDS, Token, TokenKind

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

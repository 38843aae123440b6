# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Suggestions: from a word as written to the word of the language."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Mapping
from types import MappingProxyType

from smarttestudo.language.parser.tokens import Token, TokenKind

SYNONYMS: Mapping[str, str] = MappingProxyType(
    {
        "==": "=",
        "=>": ">=",
        "=<": "<=",
        "<>": "!=",
        "≥": ">=",
        "≤": "<=",
        "≠": "!=",
        "&&": "AND",
        "&": "AND",
        "||": "OR",
        "|": "OR",
        "!": "Not",
        "When": "If",
        "Always": "Full",
        "All": "Full",
        "Never": "Off",
        "None": "Off",
    }
)
"""The words of other languages, and what ADIRF writes for them."""

_HINTS: Mapping[str, str] = MappingProxyType(
    {
        ";": "statements need nothing between them",
        ",": "nothing is separated by commas",
        ":": "there are no colons",
        "{": "a collection is written 'begin … end', a block 'If … Then … EndIf'",
        "}": "a collection is written 'begin … end', a block 'If … Then … EndIf'",
        "%": "numbers carry no unit",
    }
)
_LONGEST_WORD = 24
_SHORTEST_PREFIX = 3
_SHOWN = 40


def closest(word: str, candidates: Iterable[str]) -> str | None:
    """The candidate that ``word`` is a synonym, another case, a beginning or a misspelling of."""
    known = tuple(candidates)
    synonym = SYNONYMS.get(word)
    if synonym in known:
        return synonym
    if len(word) > _LONGEST_WORD:
        return None
    plain = word.casefold()
    near = [(distance, name) for name in known if (distance := _distance(plain, name.casefold())) is not None]
    return min(near, key=lambda pair: pair[0])[1] if near else None


def _distance(word: str, name: str) -> int | None:
    """How far ``word`` is from ``name``, ``None`` when too far to be it."""
    if word == name:
        return 0
    allowed = 1 if len(name) < 6 else 2
    if _may_be_within(allowed, word, name):
        edits = edit_distance(word, name)
        if edits <= allowed:
            return edits
    return allowed + 1 if len(word) >= _SHORTEST_PREFIX and name.startswith(word) else None


def _may_be_within(edits: int, word: str, name: str) -> bool:
    """A cheap bound: an edit changes the length by one, and the set of letters by two, at most."""
    return len(word) > 1 and abs(len(word) - len(name)) <= edits and len(set(word) ^ set(name)) <= 2 * edits


def edit_distance(first: str, second: str) -> int:
    """Insertions, deletions, substitutions and swaps of neighbours between two short words.

    The restricted Damerau-Levenshtein distance (optimal string alignment), by rows.
    """
    before: list[int] = []
    row = list(range(len(second) + 1))
    for i, letter in enumerate(first, start=1):
        last, row, before = before, [i], row
        for j, other in enumerate(second, start=1):
            best = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == second[j - 2] and first[i - 2] == other:
                best = min(best, last[j - 2] + 1)
            row.append(best)
    return row[-1]


def did_you_mean(text: str) -> str:
    """The hint that offers ``text``."""
    return f"did you mean '{text}'?"


def hint_on(token: Token) -> str:
    """Advice on a token of another language."""
    if token.kind is not TokenKind.FOREIGN or not token.text:
        return ""
    if not token.text.isprintable():
        return f"{described(token)} cannot be seen in most editors; delete it"
    return _HINTS.get(token.text[0], "")


def described(token: Token) -> str:
    """The token as a message names it, short and printable."""
    if token.kind is TokenKind.END_OF_FILE:
        return "the end of the file"
    if not token.text.isprintable():
        hidden = next(character for character in token.text if not character.isprintable())
        name = unicodedata.name(hidden, "")
        return f"the character U+{ord(hidden):04X}{f' ({name.lower()})' if name else ''}"
    text = token.text if len(token.text) <= _SHOWN else f"{token.text[: _SHOWN - 1]}…"
    return f'"{text}"' if "'" in text else f"'{text}'"

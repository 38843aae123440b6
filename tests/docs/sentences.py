# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sentences of a Markdown page, as a reader counts their words.

A heading, a paragraph and an item of a list each end a sentence. Code blocks, tables, comments, pictures and
the addresses of links are left out; code within a line is one word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

_NOT_PROSE = re.compile(
    r"<!--.*?-->|^ *```.*?^ *```$|^(?: *\|[^\n]*\n?)+|!\[[^\]]*\]\([^)]*\)", re.MULTILINE | re.DOTALL
)
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
_CODE = re.compile(r"(`+)[^`].*?\1", re.DOTALL)
_MARKER = r"(?:[-*+>]|\d+\.|#+) "
_BLOCK_ENDS = re.compile(rf"\n\s*\n|\n(?=\s*{_MARKER})")
_HEADING = re.compile(r"^#+ [^\n]*$", re.MULTILINE)
_SENTENCE_ENDS = re.compile(
    r"(?<!e\.g\.)(?<!i\.e\.)(?:(?<=[.!?])|(?<=[.!?][\")*])|(?<=[.!?]\*\*))\s+(?=[\"(*~/]*[A-ZΑ-ω\d])"
)
_LETTER_OR_DIGIT = re.compile(r"[^\W_]")


def sentences(markdown: str) -> Iterator[str]:
    """The sentences of a page in their order, each on one line."""
    prose = _CODE.sub("Code", _LINK.sub(r"\1", _NOT_PROSE.sub("\n", markdown)))
    for block in _BLOCK_ENDS.split(_HEADING.sub(r"\n\g<0>\n", prose)):
        text = " ".join(re.sub(rf"^\s*{_MARKER}", "", block).split())
        yield from filter(None, _SENTENCE_ENDS.split(text))


def word_count(sentence: str) -> int:
    """How many words it has; a sign between spaces is none: a dash, an ellipsis, an operator."""
    return sum(bool(_LETTER_OR_DIGIT.search(word)) for word in sentence.split())

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The code blocks of the pages that a reader follows, and what a mark before a block says of it.

A mark is a comment on the line before the block, which no page shows:

- ``<!-- not run: REASON -->``
- ``<!-- run in: PAGE -->``: the same lines stand in a block of that page, which is run
- ``<!-- run by: TEST -->``: a test of its own reads the block from the page
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path

from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
FOLLOWED = ("Start", "Tutorials", "How-to")
"""The parts of the site's menu whose pages a reader follows with a keyboard."""
_BLOCK = re.compile(
    r"(?:^<!-- (?P<kind>not run|run in|run by): (?P<words>[^\n]+) -->\n)?"
    r"^(?P<indent> *)```(?P<language>[\w-]*)(?: title=\"(?P<title>[^\"\n]*)\")?\n"
    r"(?P<text>.*?)^(?P=indent)```$",
    re.MULTILINE | re.DOTALL,
)
_GOES_ON = re.compile(r" *\\\n *")
_COMMENT = re.compile(r"(?:^|\s+)#(?: .*)?$")


class Mark(Enum):
    """What a mark says of the block below it."""

    NOT_RUN = "not run"
    RUN_IN = "run in"
    RUN_BY = "run by"


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeBlock:
    """A block of ``page``, a path from the root of the checkout, that begins at ``line``."""

    page: str
    line: int
    language: str
    title: str | None
    text: str
    mark: Mark | None
    mark_words: str

    def __str__(self) -> str:
        return f"{self.page}:{self.line} [{self.language}]"

    @property
    def commands(self) -> tuple[str, ...]:
        """The lines of a shell's block, those that a backslash goes on as one, without comments."""
        lines = (_COMMENT.sub("", line).strip() for line in _GOES_ON.sub(" ", self.text).splitlines())
        return tuple(line for line in lines if line)


def pages_in(menu: object) -> Iterator[str]:
    """The pages that a part of the site's menu names."""
    if isinstance(menu, str):
        yield menu
    elif isinstance(menu, dict):
        for part in menu.values():
            yield from pages_in(part)
    elif isinstance(menu, list):
        for part in menu:
            yield from pages_in(part)


@cache
def followed_pages() -> tuple[str, ...]:
    """The README and the pages of ``FOLLOWED``, as paths from the root of the checkout."""
    menu = YAML(typ="safe").load(ROOT / "mkdocs.yml")["nav"]
    followed = [part for part in menu if set(part) & set(FOLLOWED)]
    return ("README.md", *(f"docs/{page}" for page in pages_in(followed)))


@cache
def blocks_of(page: str) -> tuple[CodeBlock, ...]:
    """All code blocks of ``page``."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return tuple(
        CodeBlock(
            page=page,
            line=text.count("\n", 0, found.start("language")) + 1,
            language=found["language"],
            title=found["title"],
            text=found["text"],
            mark=Mark(found["kind"]) if found["kind"] else None,
            mark_words=found["words"] or "",
        )
        for found in _BLOCK.finditer(text)
    )


def shell_blocks_run_of(page: str) -> tuple[CodeBlock, ...]:
    """The shell's blocks of ``page`` without a mark: ``tests/ros/test_documented_commands.py`` runs them."""
    return tuple(block for block in blocks_of(page) if block.language == "sh" and block.mark is None)

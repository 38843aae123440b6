# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""No sentence of a page that is written by hand has more than thirty words."""

from __future__ import annotations

from pathlib import Path

import pytest

from docs.sentences import sentences, word_count

ROOT = Path(__file__).parents[2]
MOST_WORDS = 30
MADE_BY_CODE = ("checks*.md", "commands.md", "errors.md", "metrics.md", "properties.md")
"""Pages of docs/reference that ``make docs`` writes."""
PAGES = [
    *(ROOT / name for name in ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md")),
    *(
        page
        for page in sorted((ROOT / "docs").rglob("*.md"))
        # A decision is kept as it was taken.
        if page.parent.name != "decisions"
        and not (page.parent.name == "reference" and any(page.match(name) for name in MADE_BY_CODE))
    ),
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_sentence_is_too_long(page: Path) -> None:
    found = list(sentences(page.read_text(encoding="utf-8")))
    assert len(found) > 3, "the sentences are not read"
    assert [text for text in found if word_count(text) > MOST_WORDS] == []


@pytest.mark.parametrize(
    ("markdown", "expected"),
    [
        ("One ends. Another\nbegins. 3 ends it!", ["One ends.", "Another begins.", "3 ends it!"]),
        ("- a first item\n- a second,\n  which goes on", ["a first item", "a second, which goes on"]),
        ("# A title\nText", ["A title", "Text"]),
        ("A rate is 0.5 Hz, e.g. The one of `/a. B`.", ["A rate is 0.5 Hz, e.g. The one of Code."]),
        ("**Bold.** Then [a link. Here](https://example.org/A. B).", ["**Bold.**", "Then a link.", "Here."]),
        ("Before\n\n| a. B | c |\n|---|---|\n| d | e |\n\nafter", ["Before", "after"]),
        ("Before\n\n```sh\nA. B\n```\n<!-- C. D -->\nafter", ["Before", "after"]),
    ],
)
def test_sentences_end_where_a_reader_ends_them(markdown: str, expected: list[str]) -> None:
    assert list(sentences(markdown)) == expected


def test_code_is_one_word_and_a_sign_is_none() -> None:
    assert word_count("Code … a – b = 3") == 4

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The colours that editors give rule files by a grammar of TextMate: those of what the language reads."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given

from language.wide_rules import wide_rule_files
from smarttestudo.cli.finding_text import finding_lines
from smarttestudo.domain.finding import Finding, Severity, Span
from smarttestudo.domain.rate import Tier
from smarttestudo.language.formatter import format_file
from smarttestudo.language.parser.lexer import KEYWORDS, TokenKind, tokenize
from smarttestudo.language.syntax import DurationUnit, Operator, RateWord, RuleFile

ROOT = Path(__file__).resolve().parents[2]
EXTENSION = ROOT / "extras" / "vscode"
KEYWORD_SCOPES = ("keyword.control", "keyword.operator.logical", "keyword.other.time", "support.function")
NAME_SCOPES = (
    "",
    "entity.name.type.topic",
    "variable.other.property",
    "constant.language",
    "keyword.other.unit",
)
SCOPES: Mapping[TokenKind, tuple[str, ...]] = {
    **dict.fromkeys(KEYWORDS.values(), KEYWORD_SCOPES),
    TokenKind.WORD: NAME_SCOPES,
    TokenKind.NUMBER: ("constant.numeric",),
    TokenKind.STRING: ("string.quoted.double",),
    TokenKind.OPERATOR: ("keyword.operator.comparison",),
    TokenKind.RANGE: ("keyword.operator.range",),
    TokenKind.OPEN: ("punctuation.section.parens",),
    TokenKind.CLOSE: ("punctuation.section.parens",),
}
RULE_FILES = sorted((ROOT / "examples").rglob("*.adirf")) + sorted(
    (ROOT / "tests" / "golden").rglob("*.adirf")
)


def read(name: str) -> Any:
    return json.loads((EXTENSION / name).read_text(encoding="utf-8"))


PATTERNS = [(re.compile(one["match"]), one) for one in read("adirf.tmLanguage.json")["patterns"]]


def scopes_of(line: str) -> list[str]:
    """The scope of each character, as an editor finds it: the first pattern of those that match soonest."""
    scopes = [""] * len(line)
    at = 0
    while at < len(line):
        found = [
            (match, one) for pattern, one in PATTERNS if (match := pattern.search(line, at)) and match[0]
        ]
        if not found:
            break
        match, one = min(found, key=lambda each: each[0].start())
        named = (
            {0: one["name"]} if "name" in one else {int(n): to["name"] for n, to in one["captures"].items()}
        )
        for group, name in named.items():
            begin, end = match.span(group)
            scopes[max(begin, 0) : max(end, 0)] = [name.removesuffix(".adirf")] * (end - begin)
        at = match.end()
    return scopes


def miscoloured(text: str) -> Iterator[str]:
    """Words of a rule file that an editor shows as something else than the language reads."""
    lines = [scopes_of(line) for line in text.split("\n")]
    for token in tokenize(text):
        scopes = set(lines[token.line - 1][token.column - 1 : token.column - 1 + len(token.text)])
        if token.kind is not TokenKind.END_OF_FILE and not any(
            all(scope == allowed or scope.startswith(f"{allowed}.") for scope in scopes)
            for allowed in SCOPES[token.kind]
        ):
            yield f"{token.line}:{token.column}: {token.kind.value} {token.text} is {scopes}"
        for comment in (*token.above, *([token.beside] if token.beside else [])):
            shown = lines[comment.span.line - 1][comment.span.column - 1 : comment.span.end_column - 1]
            if set(shown) != {"comment.line.double-slash"}:
                yield f"{comment.text} is {shown}"


@pytest.mark.parametrize("path", RULE_FILES, ids=lambda path: path.name)
def test_an_editor_shows_the_words_of_a_rule_file_as_what_they_are(path: Path) -> None:
    assert list(miscoloured(path.read_text(encoding="utf-8"))) == []


@given(wide_rule_files())
def test_an_editor_shows_the_words_of_any_rule_file_as_what_they_are(file: RuleFile) -> None:
    assert list(miscoloured(format_file(file))) == []


@pytest.mark.parametrize(
    ("word", "scope"),
    [
        *((tier.value, "constant.language.level") for tier in Tier),
        *((word.value, "constant.language.rate") for word in RateWord),
        *((operator.value, "keyword.operator.comparison") for operator in Operator),
        *((keyword, KEYWORD_SCOPES) for keyword in KEYWORDS),
    ],
)
def test_every_word_of_the_language_has_a_colour(word: str, scope: str | tuple[str, ...]) -> None:
    (found,) = set(scopes_of(word))
    assert found.startswith(scope)


@pytest.mark.parametrize("unit", ["Hz", *(unit.value for unit in DurationUnit)])
@pytest.mark.parametrize("blank", ["", " "])
def test_a_unit_is_shown_behind_its_number(unit: str, blank: str) -> None:
    scopes = scopes_of(f"1.5{blank}{unit}")
    assert scopes[:3] == ["constant.numeric"] * 3
    assert set(scopes[3 + len(blank) :]) == {"keyword.other.unit"}


@pytest.mark.parametrize("line", ["# a", "/* a"])
def test_what_is_a_comment_elsewhere_is_shown_as_wrong(line: str) -> None:
    assert set(scopes_of(line)) == {"invalid.illegal.comment"}


def test_the_extension_names_files_that_are_there() -> None:
    package = read("package.json")
    (language,), (grammar,) = package["contributes"]["languages"], package["contributes"]["grammars"]
    assert language["extensions"] == [".adirf"]
    assert grammar["language"] == language["id"]
    assert read(grammar["path"])["scopeName"] == grammar["scopeName"]
    assert read(language["configuration"])["comments"] == {"lineComment": "//"}


@pytest.mark.parametrize("severity", list(Severity))
def test_the_extension_reads_the_places_that_check_prints(severity: Severity) -> None:
    (matcher,) = read("package.json")["contributes"]["problemMatchers"]
    finding = Finding(
        code="two-defaults", severity=severity, message="it: is so", path="a b/x.adirf", span=Span(3, 5, 3, 9)
    )
    (line, *_) = finding_lines(finding, ())
    pattern = matcher["pattern"]
    match = re.fullmatch(pattern["regexp"], line)
    assert match is not None
    assert [match[pattern[key]] for key in ("file", "line", "column", "severity", "code", "message")] == [
        *("a b/x.adirf", "3", "5", severity.value, "two-defaults", "it: is so")
    ]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The house style, shown by files."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from language.rule_strategies import NOWHERE
from smarttestudo.language.formatter import format_file, format_rules
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import Block, RateExpression, SetFrequency

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.adirf"))
GOLDEN = sorted((ROOT / "tests" / "golden" / "format").glob("*.before.adirf"))
THESIS_FORMS = sorted((ROOT / "tests" / "golden" / "thesis_forms").glob("*.adirf"))


@pytest.mark.parametrize("before", GOLDEN, ids=lambda path: path.name.partition(".")[0])
def test_a_file_is_set_in_the_house_style(before: Path) -> None:
    after = before.with_name(before.name.replace(".before.", ".after."))
    assert format_rules(before.read_text(), before.name) == after.read_text()


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_are_valid_and_in_the_house_style(path: Path) -> None:
    text = path.read_text()
    assert parse(text, path.name).findings == ()
    assert format_rules(text, path.name) == text


@pytest.mark.parametrize("path", THESIS_FORMS, ids=lambda path: path.stem)
def test_formatting_keeps_what_blocks_of_the_thesis_are_called(path: Path) -> None:
    text = path.read_bytes().decode()
    formatted = format_rules(text, path.name)
    assert named_labels(formatted) == named_labels(text)


def named_labels(text: str) -> list[str]:
    blocks = [one for one in parse(text, "").file.statements if isinstance(one, Block)]
    return [block.label for block in blocks if not block.label.startswith("block at line")]


def test_a_file_with_an_error_stays_as_it_is() -> None:
    text = "begin   SetFrequency /odom 10\n  SetFrequency /scan\nend"
    assert format_rules(text, "rules.adirf") == text


def test_a_byte_order_mark_goes() -> None:
    assert format_rules("\ufeffbegin end", "rules.adirf") == "begin\nend\n"


def test_a_changed_tree_prints_with_its_comments() -> None:
    file = parse("begin // all\n// the map\nSetFrequency /odom Marginal // needs it\nend", "").file
    (collection,) = file.collections
    (statement,) = collection.statements
    assert isinstance(statement, SetFrequency)
    rate = RateExpression(value=12.5, text="", span=NOWHERE)
    solved = dataclasses.replace(collection, statements=(dataclasses.replace(statement, rate=rate),))
    assert format_file(dataclasses.replace(file, collections=(solved,))) == (
        "begin  // all\n    // the map\n    SetFrequency /odom 12.5  // needs it\nend\n"
    )

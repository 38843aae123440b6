# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A text that is read with what is known of others means what it means by itself."""

from __future__ import annotations

import dataclasses
import random

from hypothesis import given, settings

from language.edited_texts import BLOCKS, edited_texts
from smarttestudo.language.parser import ParseResult, parse


def everything(node: object) -> object:
    """All of a tree, with places, labels and comments, which do not count when trees are compared."""
    if dataclasses.is_dataclass(node) and not isinstance(node, type):
        return type(node), [everything(getattr(node, field.name)) for field in dataclasses.fields(node)]
    return [everything(part) for part in node] if isinstance(node, tuple) else node


def seen(result: ParseResult) -> object:
    return everything(result.file), result.findings, everything(result.tokens)


@given(edited_texts())
@settings(max_examples=400)
def test_an_edited_text_is_read_as_if_it_were_new(texts: list[str]) -> None:
    before = None
    for text in texts:
        before = parse(text, "rules.adirf", before)
        assert seen(before) == seen(parse(text, "rules.adirf"))


def test_only_the_edited_block_is_read_anew() -> None:
    text = f"begin\nSetFrequency /odom 1\n{BLOCKS[1] * 200}end\n"
    generator = random.Random(1)
    before = parse(text, "rules.adirf")
    for _ in range(20):
        at = text.index("7", generator.randrange(len(text) // 2))
        text = f"{text[:at]}8{text[at + 1 :]}"
        after = parse(text, "rules.adirf", before)
        old = {id(one) for one in before.file.statements}
        assert sum(id(one) not in old for one in after.file.statements) <= 3
        before = after


def test_what_is_below_a_line_break_or_a_new_block_is_not_read_anew() -> None:
    text = f"begin\nSetFrequency /odom 1\n{''.join(map(numbered_block, range(300)))}end\n"
    generator = random.Random(1)
    before = parse(text, "rules.adirf", parse("", "rules.adirf"))
    for edit in range(100):
        at = text.index("EndIf\n", generator.randrange(len(text) - 100)) + len("EndIf\n")
        edited = f"{text[:at]}{generator.choice((numbered_block(edit), chr(10)))}{text[at:]}"
        for one in (edited, text, edited):
            after = parse(one, "rules.adirf", before)
            old = {id(statement) for statement in before.numbered.statements}
            assert sum(id(statement) not in old for statement in after.numbered.statements) <= 3
            before = after
        text = edited
    assert seen(before) == seen(parse(text, "rules.adirf"))


def numbered_block(number: int) -> str:
    return f"// Zone\nIf (CheckValue /odom pose_x > {number}) Then\n    SetFrequency /odom 5\nEndIf\n"

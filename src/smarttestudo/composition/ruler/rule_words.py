# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What stands at the places of which a robot tells whether they hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from smarttestudo.adirf.parser import parse
from smarttestudo.adirf.syntax import Block, Check, checks_in
from smarttestudo.domain.rule_texts import RuleTexts

Place = tuple[int, int, int]
"""A file's number, line and column."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleWords:
    """The names of blocks and the words of checks by their places in the texts with ``sha256``."""

    sha256: str = ""
    labels: Mapping[Place, str] = field(default_factory=dict)
    checks: Mapping[Place, Check] = field(default_factory=dict)
    full_names: Mapping[str, str] = field(default_factory=dict)


def words_of(texts: RuleTexts) -> RuleWords:
    """The words of all blocks in ``texts``."""
    labels: dict[Place, str] = {}
    checks: dict[Place, Check] = {}
    for number, (name, text) in enumerate(texts.files):
        for statement in parse(text, name).file.statements:
            if isinstance(statement, Block):
                labels[number, statement.span.line, statement.span.column] = statement.label
                for check in checks_in(statement.condition):
                    checks[number, check.span.line, check.span.column] = check
    return RuleWords(sha256=texts.sha256, labels=labels, checks=checks, full_names=texts.full_names)

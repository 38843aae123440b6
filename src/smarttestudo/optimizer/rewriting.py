# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file with numbers in the place of its levels, everything else as it was."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import accumulate

from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.texts import without_mark
from smarttestudo.language.formatter import number_text
from smarttestudo.language.syntax import (
    RuleFile,
    SetFrequency,
)
from smarttestudo.language.syntax_walks import (
    tiers_in,
)
from smarttestudo.optimizer.requirements import StatementKey
from smarttestudo.optimizer.rule_rates import Optimization
from smarttestudo.optimizer.wording import hz_text

PROVENANCE = "// Rates by testudo optimize: "
APPENDED = "// Topics of the profile without a default"
_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n|\Z)")
_DEFAULT_INDENT = "    "
_BEGIN = "begin"

_Edit = tuple[int, int, str]
"""From one offset to another, what stands there instead."""


def rewrite(text: str, file: RuleFile, optimization: Optimization, *, provenance: str) -> str:
    """``text``, which parsed to ``file``, with the rates of a feasible ``optimization``.

    Each level becomes its rate or its bound, except in disabled blocks. The topics that the optimization
    appended become defaults, after the last one of the file, or at its start. A first line says
    ``provenance``, in the place of one that did. A byte order mark stays in front.
    """
    # Places do not count it.
    mark, text = without_mark(text)
    starts = list(accumulate((len(line) for line in _LINE.findall(text)), initial=0))
    line_end = "\r\n" if "\r\n" in text else "\n"
    edits = [
        (_start(span, starts), _end(span, starts), _number_text((file.path, span), optimization))
        for statement in file.enabled_statements
        for span, _ in tiers_in(statement)
    ]
    rates = optimization.appended_rates
    if rates:
        edits.append(_appended(text, file, rates, starts, line_end))
    edits.append((0, _old_provenance(text), f"{PROVENANCE}{provenance}{line_end}"))
    for start, end, replacement in sorted(edits, reverse=True):
        text = text[:start] + replacement + text[end:]
    return mark + text


def _number_text(key: StatementKey, optimization: Optimization) -> str:
    bound = optimization.tier_bounds.get(key)
    return hz_text(optimization.tier_rates_hz[key]) if bound is None else number_text(bound)


def _appended(
    text: str, file: RuleFile, rates: Mapping[str, Rate], starts: list[int], line_end: str
) -> _Edit:
    defaults = [one for one in file.statements if isinstance(one, SetFrequency)]
    if defaults:
        at = _end(defaults[-1].span, starts)
        line = text[starts[defaults[-1].span.line - 1] :]
        indent = line[: len(line) - len(line.lstrip(" \t"))]
    else:
        at = _start(file.collections[0].span, starts) + len(_BEGIN)
        indent = _DEFAULT_INDENT
    rest_of_line = _LINE.match(text, at)
    rest = rest_of_line.group().strip() if rest_of_line else ""
    lines = [f"{indent}{APPENDED}"]
    for topic, rate in rates.items():
        lines.append(f"{indent}SetFrequency {topic} {rate if rate.is_full else f'{hz_text(rate.hz)} Hz'}")
    if not rest or rest.startswith("//"):
        at += len((rest_of_line.group() if rest_of_line else "").rstrip("\r\n"))
        blank = "" if defaults else line_end
        return at, at, line_end + line_end.join(lines) + blank
    return at, at, line_end + line_end.join(lines) + line_end + indent


def _old_provenance(text: str) -> int:
    """Where the first line ends, if it is a provenance; else 0."""
    first = _LINE.match(text)
    return first.end() if first and text.startswith(PROVENANCE) else 0


def _start(span: Span, starts: list[int]) -> int:
    return starts[span.line - 1] + span.column - 1


def _end(span: Span, starts: list[int]) -> int:
    return starts[span.end_line - 1] + span.end_column - 1

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo optimize``: quality levels to rates within the budget."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from typing import TextIO

from smarttestudo.cli.arguments import budget_kb_per_s, file_path
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.output import write_file_text, write_line, write_lines
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.finding import Finding
from smarttestudo.domain.json_text import json_text
from smarttestudo.files.outputs import require_separate
from smarttestudo.language.formatter import number_text
from smarttestudo.optimizer.explanation import SubproblemExplanation, TopicRow
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.rule_rates import SolvedSubproblem
from smarttestudo.optimizer.wording import kb_text, wanted_text
from smarttestudo.report.table import Column, Table, decimals
from smarttestudo.rules.optimize import (
    OptimizeCommand,
    OptimizeOutcome,
    RefusedRulesError,
    optimize,
    optimize_json,
)
from smarttestudo.rules.rule_files import write_rule_text

EXIT_ERROR = 1


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Turn the quality levels of a rule file into rates that fit the profile's budget. "
        "Without -o the new rule file goes to standard output."
    )
    parser.add_argument("file", metavar="FILE", type=file_path, help="a rule file")
    parser.add_argument(
        "--profile", metavar="P", type=file_path, required=True, help="sizes, levels and the budget"
    )
    parser.add_argument(
        "--model",
        choices=[model.value for model in Model],
        default=Model.QUPER.value,
        help="what to maximise (default: quper, the rates within the intervals of their levels)",
    )
    parser.add_argument(
        "--budget",
        metavar="N",
        type=budget_kb_per_s,
        help="KB/s that all topics together may take, in place of the profile's budget_kb_per_s",
    )
    parser.add_argument("-o", "--output", metavar="OUT", type=file_path, help="where to write the rule file")
    parser.add_argument(
        "--only-named", action="store_true", help="leave out topics that are only in the profile"
    )
    parser.add_argument("--explain", action="store_true", help="explain what limits each rate")
    parser.add_argument("--json", action="store_true", help="print one JSON object with everything")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Solve and write; 1 where something does not fit or the file has errors."""
    require_separate({"--output": arguments.output}, (arguments.file, arguments.profile))
    request = OptimizeCommand(
        rules=arguments.file,
        profile=arguments.profile,
        model=Model(arguments.model),
        only_named=arguments.only_named,
        budget_kb_per_s=arguments.budget,
    )
    try:
        outcome = optimize(request)
    except RefusedRulesError as error:
        for finding in error.findings:
            _print_finding(finding, [finding.hint] if finding.hint else [])
        return EXIT_ERROR
    if outcome.rewritten is not None and arguments.output is not None:
        write_rule_text(arguments.output, outcome.rewritten)
    if arguments.json:
        write_lines(json_text(optimize_json(outcome), ascii_only=False, indent=2).split("\n"))
    elif outcome.rewritten is not None and arguments.output is None:
        write_file_text(outcome.rewritten)
    if arguments.explain and not arguments.json:
        # Standard output stays a rule file where it is one.
        _print_explanations(outcome, sys.stderr if arguments.output is None else sys.stdout)
    if not arguments.json:
        for one in outcome.infeasible:
            _print_finding(one.finding(), one.remedies)
    return EXIT_ERROR if outcome.infeasible else 0


def _print_finding(finding: Finding, hints: Sequence[str]) -> None:
    write_line(finding.line_of_text(), sys.stderr)
    for hint in hints:
        write_line(f"    hint: {hint}", sys.stderr)


def _print_explanations(outcome: OptimizeOutcome, stream: TextIO) -> None:
    for solved, explanation in outcome.explained():
        print_table(_table(solved, explanation, outcome.optimization.budget_kb_per_s), stream)
        for note in explanation.notes:
            write_line(f"  {note}", stream)
        write_line(stream=stream)


def _table(
    solved: SolvedSubproblem, explanation: SubproblemExplanation, budget_kb_per_s: float
) -> Table[TopicRow]:
    title = (
        "Defaults"
        if solved.subproblem.label is None
        else f'"{solved.subproblem.label}" ({solved.subproblem.place})'
    )
    return Table(
        title=f"{title}: {kb_text(solved.used_kb_per_s)} of {kb_text(budget_kb_per_s)} KB/s",
        columns=tuple(_columns(solved, explanation, budget_kb_per_s)),
        rows=explanation.rows,
    )


def _columns(
    solved: SolvedSubproblem, explanation: SubproblemExplanation, budget_kb_per_s: float
) -> Iterator[Column[TopicRow]]:
    sums_kb_per_s = {"all topics": solved.used_kb_per_s}
    if solved.subproblem.label is not None:
        sums_kb_per_s = {"other topics": solved.others_kb_per_s, **sums_kb_per_s}
    loads = tuple(sums_kb_per_s.values())
    shares = tuple(100 * load / budget_kb_per_s if budget_kb_per_s else None for load in loads)
    yield Column("Topic", "", lambda row: row.topic, is_text=True, sums=tuple(sums_kb_per_s))
    yield Column("Asked for", "", lambda row: wanted_text(row.wanted), is_text=True)
    yield Column("Level", "", lambda row: row.level.value if row.level else "", is_text=True)
    if any(row.bound is not None for row in explanation.rows):
        yield Column("Within", "", lambda row: "" if row.bound is None else number_text(row.bound))
    yield Column("Rate", "Hz", lambda row: row.rate_hz, decimals(3))
    yield Column("Load", "KB/s", lambda row: row.kb_per_s, sums=loads)
    yield Column("Share", "%", lambda row: 100 * row.share, decimals(1), sums=shares)
    yield Column("Held by", "", lambda row: row.binding.value, is_text=True)

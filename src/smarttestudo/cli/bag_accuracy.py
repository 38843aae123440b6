# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag accuracy``: how far the operator's picture is off, at fixed rates and under rules."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.accuracy.comparison import View
from smarttestudo.cli.bag_options import (
    add_form,
    print_csv,
    print_incident,
    print_json,
    print_notices,
    print_tables,
)
from smarttestudo.cli.command_parser import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.progress import progress
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.profile import Profile
from smarttestudo.report.accuracy_comparison_table import accuracy_sentences, accuracy_tables
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_sets import load_rules

if TYPE_CHECKING:
    from smarttestudo.rules.rule_sets import LoadedRules

EXIT_ERROR = 1


def add_arguments(action: CommandParser) -> None:
    """Add the arguments of ``testudo bag accuracy``."""
    action.description = (
        "Replay a recording under each of the rules, thin it to fixed rates with the bytes of "
        "the first ones, and show how far the operator's picture of what the rules bound (KeepWithin) is "
        "off. Without a bound: of poses, frames and joints. Images are left out."
    )
    action.add_argument(
        "bag", metavar="BAG", type=file_path, help="a rosbag2 folder, a .db3 or an .mcap file"
    )
    action.add_argument(
        "--rules",
        metavar="FILE",
        nargs="+",
        action="append",
        type=file_path,
        required=True,
        help="rule files, or folders of them, that mean something together; once for each set of rules",
    )
    action.add_argument(
        "--predicted",
        metavar="FILE",
        nargs="+",
        action="append",
        type=file_path,
        default=[],
        help="the same for an operator's end that shows dead reckoning of what these rules bound",
    )
    action.add_argument(
        "--profile", metavar="FILE", type=file_path, help="what is known about the topics (TOML)"
    )
    add_form(action)
    action.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Compare and print; 1 if rules have an error."""
    from smarttestudo.accuracy.recorded_comparison import AccuracyRequest, NamedRules, compare_accuracy  # noqa: PLC0415  needs packages a robot lacks

    profile = load_profile(arguments.profile) if arguments.profile else Profile()
    loaded = list(_loaded(arguments, profile))
    errors = [rules for _, _, rules in loaded if rules.errors]
    for rules in errors:
        print_findings(rules.errors, rules.texts, sys.stderr)
    if errors:
        return EXIT_ERROR
    comparison = compare_accuracy(
        AccuracyRequest(
            bag=arguments.bag,
            rules=[NamedRules(name=name, rule_set=rules.rule_set, view=view) for name, view, rules in loaded],
            profile=profile,
            progress=progress,
        )
    )
    if comparison is None:
        raise UsageError(
            "no rule relays a topic whose picture can be measured",
            place=str(arguments.bag),
            remedy="bound a property with KeepWithin, or relay odometry, poses, frames or joints",
        )
    if arguments.json:
        print_json(comparison.to_json())
    elif arguments.csv:
        print_csv(comparison.rows())
    else:
        print_incident(arguments.bag)
        print_tables(accuracy_tables(comparison))
        for number, sentence in enumerate(accuracy_sentences(comparison)):
            print(sentence if number else f"\n{sentence}")  # noqa: T201
    print_notices(comparison.notices)
    return 0


def _loaded(arguments: argparse.Namespace, profile: Profile) -> Iterator[tuple[str, View, LoadedRules]]:
    for view, sets in ((View.HOLD, arguments.rules), (View.RECKONED, arguments.predicted)):
        for paths in sets:
            yield _name(paths), view, load_rules(paths, profile=profile)


def _name(paths: list[Path]) -> str:
    return " + ".join(path.stem for path in paths)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag accuracy``: how far the operator's picture is off, at fixed rates and under rules."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smarttestudo.accuracy.comparison import View
from smarttestudo.cli.arguments import file_path
from smarttestudo.cli.bag_options import add_form, add_recordings, add_several, print_incident, print_tables
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.output import Progress, write_line
from smarttestudo.cli.recordings import RecordingCommand, each_recording, recordings_asked
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import column_types
from smarttestudo.report.accuracy_tables import accuracy_sentences, accuracy_tables
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_sets import load_rules

if TYPE_CHECKING:
    from smarttestudo.accuracy.comparison import AccuracyComparison
    from smarttestudo.rules.rule_sets import LoadedRules

EXIT_ERROR = 1


def add_arguments(action: CommandParser) -> None:
    action.description = (
        "Replay a recording under each of the rules, thin it to fixed rates with the bytes of "
        "the first ones, and of each that is shown reckoned, and show how far the operator's picture of what "
        "the rules bound (KeepWithin) is off. Without a bound: of poses, frames and joints. Images are left "
        "out."
    )
    add_recordings(action)
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
    add_several(action)
    action.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Compare and print; 1 if rules have an error, or a recording could not be read."""
    arguments.loaded_profile = load_profile(arguments.profile) if arguments.profile else Profile()
    arguments.loaded = list(_loaded(arguments, arguments.loaded_profile))
    errors = [rules for _, _, rules in arguments.loaded if rules.errors]
    for rules in errors:
        print_findings(rules.errors, rules.texts, sys.stderr)
    if errors:
        return EXIT_ERROR
    return each_recording(arguments, recordings_asked(arguments), _Accuracies())


class _Accuracies(RecordingCommand["AccuracyComparison"]):
    """Errors of the operator's picture of recordings, under rules and at fixed rates."""

    table = "accuracies"

    @staticmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> AccuracyComparison:
        from smarttestudo.accuracy.comparison import AccuracyRequest, NamedRules, compare_accuracy  # noqa: PLC0415  needs packages a robot lacks

        comparison = compare_accuracy(
            AccuracyRequest(
                bag=arguments.bag,
                rules=[
                    NamedRules(name=name, rule_set=rules.rule_set, view=view)
                    for name, view, rules in arguments.loaded
                ],
                profile=arguments.loaded_profile,
                progress=progress,
            )
        )
        if comparison is None:
            raise UsageError(
                "no rule relays a topic whose picture can be measured",
                place=str(arguments.bag),
                remedy="bound a property with KeepWithin, or relay odometry, poses, frames or joints",
            )
        return comparison

    def columns(self) -> Mapping[str, Any]:
        """The columns of a property."""
        from smarttestudo.accuracy.comparison import AccuracyRow  # noqa: PLC0415  needs packages a robot lacks

        return column_types(AccuracyRow)

    def print_text(self, result: AccuracyComparison) -> None:
        """A table of each topic, and what they say in sentences."""
        print_incident(Path(result.bag))
        print_tables(accuracy_tables(result))
        for number, sentence in enumerate(accuracy_sentences(result)):
            if not number:
                write_line()
            write_line(sentence)


def _loaded(arguments: argparse.Namespace, profile: Profile) -> Iterator[tuple[str, View, LoadedRules]]:
    for view, sets in ((View.HOLD, arguments.rules), (View.RECKONED, arguments.predicted)):
        for paths in sets:
            yield " + ".join(path.stem for path in paths), view, load_rules(paths, profile=profile)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag loss``: what the operator lost."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smarttestudo.accuracy.bounds import bounded_topics, needs_decisions
from smarttestudo.cli.arguments import file_path
from smarttestudo.cli.bag_options import (
    add_map,
    add_pair,
    add_predict,
    add_several,
    add_topics_and_form,
    print_incident,
    print_notice,
    print_tables,
    require_bounded,
    topic_mapping,
)
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.output import Progress, write_lines
from smarttestudo.cli.recordings import RecordingCommand, each_recording, pairs_asked
from smarttestudo.domain.decision import Decision, about_rates
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import column_types
from smarttestudo.language.properties import ARRIVAL_PROPERTIES, is_field_path
from smarttestudo.loop.decision_log import read_decisions
from smarttestudo.report.accuracy_tables import accuracy_table
from smarttestudo.report.loss_tables import arms_lines, curve_table, loss_tables
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_sets import LoadedRules, load_rules

if TYPE_CHECKING:
    from smarttestudo.accuracy.curve import LossCurves
    from smarttestudo.accuracy.loss_report import LossReport
    from smarttestudo.report.table import Table

EXIT_ERROR = 1


def add_arguments(action: CommandParser) -> None:
    action.description = (
        "Show how far the operator's picture was from the robot: the error of each field, the "
        "age of each topic, threshold crossings seen late or not at all, and the same for the best fixed "
        "rates with the same bytes. With A alone: the error at rates of 0.1, 0.2, 0.5, 1 … Hz, with "
        "proposed levels, and the messages that an accuracy needs, with hold and with dead reckoning."
    )
    add_pair(
        action,
        a="the recording of what the robot sent",
        b="the recording of what the operator received",
        is_b_optional=True,
    )
    action.add_argument(
        "--field",
        metavar=("/topic", "FIELD"),
        nargs="+",
        action="append",
        default=[],
        help="fields of a topic, by property or path (twist.twist.linear.x): beside the usual ones; with A "
        "alone only these, also for the levels",
    )
    action.add_argument(
        "--rules",
        metavar="FILE",
        nargs="+",
        action="extend",
        type=file_path,
        default=[],
        help="rule files, or folders of them: their checks give the thresholds, KeepWithin the bounds",
    )
    action.add_argument(
        "--decisions",
        metavar="FILE",
        type=file_path,
        help="the file that --decisions wrote when B was made: when blocks asked for bounds (default: "
        "/testudo/decisions of B or A; without that, the rules decide over A once more)",
    )
    add_predict(action)
    action.add_argument(
        "--profile", metavar="FILE", type=file_path, help="levels and priorities of the topics (TOML)"
    )
    add_map(action)
    add_topics_and_form(action)
    add_several(action)
    action.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure and print; 1 if the rules have an error, or a recording could not be read."""
    arguments.fields = _fields(arguments.field)
    arguments.loaded_profile = load_profile(arguments.profile) if arguments.profile else Profile()
    arguments.loaded_rules = None
    if arguments.b is None:
        _refuse_options_of_pairs(arguments)
        return each_recording(arguments, pairs_asked(arguments), _Curves())
    topic_mapping(arguments.map)
    rules = load_rules(arguments.rules, profile=arguments.loaded_profile) if arguments.rules else None
    if rules and rules.errors:
        print_findings(rules.errors, rules.texts, sys.stderr)
        return EXIT_ERROR
    require_bounded(arguments.predict, rules)
    arguments.loaded_rules = rules
    asked = pairs_asked(arguments)
    if len(asked) > 1 and arguments.decisions is not None:
        raise UsageError("it belongs to one recording", place="--decisions", remedy="leave it out")
    return each_recording(arguments, asked, _Losses())


class _Losses(RecordingCommand["LossReport"]):
    """Losses between recordings as sent and as received."""

    table = "losses"
    is_named_by_text = True

    @staticmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> LossReport:
        """The loss of one pair."""
        from smarttestudo.accuracy.recorded_loss import LossQuestion, measure_loss  # noqa: PLC0415  needs packages a robot lacks

        rules, profile = arguments.loaded_rules, arguments.loaded_profile
        decisions = _decisions(arguments, rules, profile, progress)
        with progress(f"Reading {arguments.a} and {arguments.b}") as report:
            question = LossQuestion(
                mapping=topic_mapping(arguments.map),
                topics=arguments.topics,
                fields=arguments.fields,
                rule_set=rules.rule_set if rules else None,
                decisions=decisions,
                predict=arguments.predict,
                profile=profile,
            )
            return measure_loss(arguments.a, arguments.b, question, report)

    def columns(self) -> Mapping[str, Any]:
        """The columns of a field."""
        from smarttestudo.accuracy.loss_report import LossRow  # noqa: PLC0415  as above

        return column_types(LossRow)

    def print_text(self, result: LossReport) -> None:
        """The recordings' names, and a table of each kind of loss."""
        write_lines([*arms_lines(result), ""])
        print_incident(Path(result.a))
        print_tables(loss_tables(result))


def _decisions(
    arguments: argparse.Namespace, rules: LoadedRules | None, profile: Profile, progress: Progress
) -> Sequence[Decision]:
    """Decisions that were kept, where blocks ask for bounds; else those of the rules over A."""
    from smarttestudo.replays.decisions import decisions_over, kept_decisions  # noqa: PLC0415  as above

    if arguments.decisions is not None:
        return read_decisions(arguments.decisions, print_notice)
    rule_set = rules.rule_set if rules else None
    if rule_set is None:
        return ()
    # What patterns bound is known where A is read.
    if not rule_set.patterns and not any(map(partial(needs_decisions, rule_set), bounded_topics(rule_set))):
        return ()
    if kept := about_rates(kept_decisions(arguments.b, arguments.a)):
        return kept
    with progress(f"Deciding over {arguments.a}") as report:
        return decisions_over(arguments.a, rule_set, profile, report)


def _refuse_options_of_pairs(arguments: argparse.Namespace) -> None:
    for option in ("rules", "map", "decisions", "predict"):
        if getattr(arguments, option):
            raise UsageError(
                "it needs a second recording",
                place=f"--{option}",
                remedy="give what the operator received as B",
            )


class _Curves(RecordingCommand["LossCurves"]):
    """Losses of recordings at each rate."""

    table = "curves"

    @staticmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> LossCurves:
        """The curves of one recording."""
        from smarttestudo.accuracy.curve import measure_curves  # noqa: PLC0415  as above

        with progress(f"Reading {arguments.a}") as report:
            return measure_curves(
                arguments.a,
                topics=arguments.topics,
                fields=arguments.fields,
                profile=arguments.loaded_profile,
                with_accuracy=not arguments.csv,
                report=report,
            )

    def columns(self) -> Mapping[str, Any]:
        """The columns of a field at a rate."""
        from smarttestudo.accuracy.curve import CurveRow  # noqa: PLC0415  as above

        return column_types(CurveRow)

    def print_text(self, result: LossCurves) -> None:
        """The tables of each topic."""
        print_incident(Path(result.name))
        print_tables(_curve_tables(result))


def _curve_tables(curves: LossCurves) -> Iterator[Table[Any]]:
    """Of each topic first its rates, then its accuracies."""
    by_topic = {curve.topic: curve for curve in curves.curves}
    for topic in sorted({*by_topic, *(curve.topic for curve in curves.accuracies)}):
        if topic in by_topic:
            yield curve_table(by_topic[topic])
        accuracies = curves.accuracies_of(topic)
        if accuracies:
            yield accuracy_table(accuracies)


def _fields(asked: Sequence[Sequence[str]]) -> dict[str, list[str]]:
    """Fields that ``--field`` asks for, by topic; ``UsageError`` for what cannot be a field."""
    fields: dict[str, list[str]] = {}
    for topic, *names in asked:
        if not topic.startswith("/") or not names:
            raise UsageError(
                f"{' '.join((topic, *names))} is no topic with fields",
                place="--field",
                remedy="write it as in /odom pose_x twist.twist.linear.x",
            )
        for name in names:
            _require_field(name)
        fields.setdefault(topic, []).extend(names)
    return fields


def _require_field(name: str) -> None:
    if name in ARRIVAL_PROPERTIES:
        remedy = f"msg.{name} is a field of that name"
        raise UsageError(f"{name} is not a field but how messages arrive", place="--field", remedy=remedy)
    if not is_field_path(name):
        remedy = "write it as in twist.twist.linear.x or ranges[0]"
        raise UsageError(f"{name!r} is not a field", place="--field", remedy=remedy)

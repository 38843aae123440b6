# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag report``: a recording, two beside each other, or many of either, as one HTML file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo import __version__
from smarttestudo.cli.bag_figures import (
    add_budget,
    add_figures_folder,
    figure_files,
    print_written,
)
from smarttestudo.cli.bag_options import (
    add_form,
    add_map,
    add_predict,
    add_topics,
    print_notice,
    print_notices,
    require_bounded,
    topic_mapping,
)
from smarttestudo.cli.command_parser import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.output import write_line
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.progress import progress
from smarttestudo.cli.recording_options import add_pair, add_several
from smarttestudo.cli.recordings import name_of, pairs_asked
from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.profile import Profile
from smarttestudo.files.outputs import require_separate
from smarttestudo.files.whole_file import whole_file
from smarttestudo.loop.decision_log import read_decisions
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import rule_files_named
from smarttestudo.rules.rule_sets import LoadedRules, load_rules

if TYPE_CHECKING:
    from smarttestudo.report.run_report import RunReport

EXIT_ERROR = 1
_DEFAULT_OUTPUT = Path("report.html")


def add_arguments(action: CommandParser) -> None:
    action.description = (
        "Write one HTML file that shows a recording, or two of one run beside each other: A as "
        "sent, B as received. Of several it shows which robots, recordings, topics and rules lost and cost "
        "most. It needs no network and no other file."
    )
    add_pair(
        action,
        a="the recording, as the robot sent it",
        b="the same run as the operator received it",
        is_b_optional=True,
    )
    action.add_argument(
        "--rules",
        metavar="FILE",
        nargs="+",
        action="extend",
        type=file_path,
        default=[],
        help="the rule files of B, or folders of them; shown, with their zones on the map; of several "
        "recordings they decide over each A once more",
    )
    action.add_argument(
        "--decisions", metavar="FILE", type=file_path, help="the file that --decisions wrote when B was made"
    )
    action.add_argument(
        "--profile", metavar="FILE", type=file_path, help="levels and priorities of the topics (TOML)"
    )
    add_predict(action)
    add_budget(action)
    action.add_argument(
        "--nav2-map",
        metavar="FILE",
        type=file_path,
        help="the map under the path: the .yaml beside its image",
    )
    add_map(action)
    add_topics(action)
    add_figures_folder(action, "the charts of the report")
    action.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=file_path,
        default=_DEFAULT_OUTPUT,
        help="the report (default: %(default)s)",
    )
    add_several(action)
    add_form(action, instead_of="a line, for each of several recordings")
    action.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the report; 1 if the rules have an error, or one of several recordings could not be read."""
    topic_mapping(arguments.map)
    profile = None if arguments.profile is None else load_profile(arguments.profile)
    rules = load_rules(arguments.rules, profile=profile) if arguments.rules else None
    if rules is not None and rules.errors:
        print_findings(rules.errors, rules.texts, sys.stderr)
        return EXIT_ERROR
    require_bounded(arguments.predict, rules)
    asked = pairs_asked(arguments)
    if len(asked) > 1:
        from smarttestudo.cli.bag_fleet_report import write_fleet_report  # noqa: PLC0415  as below

        return write_fleet_report(arguments, asked, profile or Profile(), rules)
    (only,) = asked
    if isinstance(only, TestudoError):
        raise only
    for option in ("json", "csv", "parquet"):
        if getattr(arguments, option):
            raise UsageError(
                "it needs several recordings",
                place=f"--{option}",
                remedy="`testudo bag bandwidth` and `testudo bag loss` have the numbers of one",
            )
    return _write_one(argparse.Namespace(**{**vars(arguments), **only}), profile, rules)


def _write_one(arguments: argparse.Namespace, profile: Profile | None, rules: LoadedRules | None) -> int:
    _require_separate(arguments)
    with whole_file(arguments.output, "the report") as write:
        report = _report(arguments, profile or Profile(), rules)
        write(_html(report))
    if arguments.figures is not None:
        from smarttestudo.report.bag_report import draw_report  # noqa: PLC0415  as below

        print_written(draw_report(report, arguments.figures))
    write_line(f"{arguments.output}: {_summary(report)}")
    print_notices(report.notices)
    return 0


def _require_separate(arguments: argparse.Namespace) -> None:
    figures = arguments.figures
    require_separate(
        {"--output": arguments.output, "--figures": None if figures is None else figure_files(figures)},
        [
            *(arguments.a, arguments.b, arguments.decisions, arguments.profile),
            *rule_files_named(arguments.rules),
            *_map_files(arguments.nav2_map),
        ],
    )


def _map_files(nav2_map: Path | None) -> Sequence[Path]:
    """The map's description and the image that it names."""
    if nav2_map is None:
        return ()
    from smarttestudo.ruler.project.nav2_map import read_map_header  # noqa: PLC0415  needs packages a robot lacks

    return nav2_map, read_map_header(nav2_map).image


def _report(arguments: argparse.Namespace, profile: Profile, rules: LoadedRules | None) -> RunReport:
    from smarttestudo.domain.floor_plan import FloorPlan  # noqa: PLC0415
    from smarttestudo.report.bag_report import ReportRequest, bag_report  # noqa: PLC0415
    from smarttestudo.report.comparison_tables import RunNames  # noqa: PLC0415
    from smarttestudo.report.run_report import Fact  # noqa: PLC0415
    from smarttestudo.ruler.project.nav2_map import read_nav2_map  # noqa: PLC0415  needs packages a robot lacks

    a, b = arguments.a, arguments.b
    occupancy = None if arguments.nav2_map is None else read_nav2_map(arguments.nav2_map)
    facts = {
        "SmartTestudo": __version__,
        "A": a,
        "B": b,
        "Decisions": arguments.decisions,
        "Map": arguments.nav2_map,
    }
    return bag_report(
        ReportRequest(
            a=a,
            b=b,
            title=name_of(a) if b is None else f"{name_of(a)} beside {name_of(b)}",
            explanation=""
            if b is None
            else f"A is what the robot sent ({a}), B what was received of it ({b}).",
            names=RunNames(before="A" if b else name_of(a), after="B"),
            mapping=topic_mapping(arguments.map),
            topics=arguments.topics,
            rule_set=rules.rule_set if rules else None,
            rule_texts=rules.texts if rules else {},
            decisions=read_decisions(arguments.decisions, print_notice) if arguments.decisions else (),
            predict=arguments.predict,
            profile=profile,
            budget_kb_per_s=arguments.budget,
            floor_plan=FloorPlan(occupancy=occupancy),
            provenance=tuple(Fact(label=label, value=str(value)) for label, value in facts.items() if value),
            progress=progress,
        )
    )


def _html(report: RunReport) -> str:
    from smarttestudo.report.document import render_report  # noqa: PLC0415  as above

    return render_report(report)


def _summary(report: RunReport) -> str:
    from smarttestudo.report.summary import summary_sentence  # noqa: PLC0415  as above

    return summary_sentence(report.comparison, len(report.decisions), report.loss)

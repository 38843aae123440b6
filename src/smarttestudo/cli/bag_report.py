# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag report``: a recording, two beside each other, or many of either, as one HTML file."""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shlex
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from smarttestudo import __version__
from smarttestudo.bags.remote_path import DEFAULT_TIMEOUT_S, is_url
from smarttestudo.cli.arguments import file_path
from smarttestudo.cli.bag_figures import add_budget, add_figures_folder, figure_files, print_written
from smarttestudo.cli.bag_options import (
    add_form,
    add_map,
    add_pair,
    add_predict,
    add_several,
    add_topics,
    print_notice,
    print_notices,
    require_bounded,
    topic_mapping,
)
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.output import Progress, progress, write_line
from smarttestudo.cli.recordings import (
    Asked,
    RecordingCommand,
    each_recording,
    name_of,
    pairs_asked,
    recordings_in,
)
from smarttestudo.domain.decision import about_actions, about_rates
from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import column_types, to_json
from smarttestudo.files.outputs import require_separate
from smarttestudo.files.whole_file import whole_file
from smarttestudo.loop.decision_log import read_all_decisions
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import rule_files_named, sha256_of
from smarttestudo.rules.rule_sets import LoadedRules, load_rules

if TYPE_CHECKING:
    from smarttestudo.report.fleet.numbers import RecordingNumbers
    from smarttestudo.report.fleet.page import FleetReport, OwnReport
    from smarttestudo.report.run_report import RunReport


_OF_ONE = ("decisions", "budget", "nav2_map", "figures")
"""Options that make sense of one recording, or pair, only."""
_STRANGE = re.compile(r"[^A-Za-z0-9._-]+")
_MOST_OF_A_NAME = 60
_DIGEST_DIGITS = 8


def _write_fleet_report(
    arguments: argparse.Namespace, asked: Sequence[Asked], profile: Profile, rules: LoadedRules | None
) -> int:
    """Write one page over ``asked``; 1 if one of them could not be read."""
    _refuse_options_of_one(arguments)
    read = [
        path for one in asked if not isinstance(one, TestudoError) for path in recordings_in(one).values()
    ]
    require_separate(
        {"--output": arguments.output}, [*read, arguments.profile, *rule_files_named(arguments.rules)]
    )
    arguments.loaded_profile, arguments.loaded_rules = profile, rules
    recordings = _Recordings(arguments)
    with whole_file(arguments.output, "the report") as write:
        code = each_recording(arguments, asked, recordings)
        write(recordings.html())
    if arguments.csv or arguments.json:
        print_written([arguments.output])
    else:
        write_line(f"{arguments.output}: {recordings.sum()}")
    return code


def _refuse_options_of_one(arguments: argparse.Namespace) -> None:
    for option in _OF_ONE:
        if getattr(arguments, option) is not None:
            raise UsageError(
                "it belongs to one recording",
                place=f"--{option.replace('_', '-')}",
                remedy="leave it out, or name one recording",
            )


class _Recordings(RecordingCommand["RecordingNumbers"]):
    """The numbers of each recording, and all of them added up."""

    table = "reports"
    prints_each = False

    def __init__(self, arguments: argparse.Namespace) -> None:
        from smarttestudo.report.fleet.totals import FleetTotals  # noqa: PLC0415  needs packages a robot lacks

        self._arguments = arguments
        self._totals = FleetTotals(are_pairs=arguments.b is not None)
        rules, profile = arguments.loaded_rules, arguments.profile
        self._inputs = (
            __version__,
            "" if rules is None else rules.in_force.sha256,
            "" if profile is None else sha256_of(profile),
        )

    @staticmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> RecordingNumbers:
        """The numbers of a recording or a pair."""
        from smarttestudo.report.fleet.measure import RecordingQuestion, measure_recording  # noqa: PLC0415  as above

        rules = arguments.loaded_rules
        with progress(f"Reading {arguments.a}"):
            return measure_recording(
                RecordingQuestion(
                    a=arguments.a,
                    b=arguments.b,
                    robot=arguments.robot,
                    mapping=topic_mapping(arguments.map),
                    topics=arguments.topics,
                    rule_set=rules.rule_set if rules else None,
                    predict=arguments.predict,
                    profile=arguments.loaded_profile,
                )
            )

    def columns(self) -> Mapping[str, Any]:
        """The columns of a topic."""
        from smarttestudo.report.fleet.numbers import ReportRow  # noqa: PLC0415  needs packages a robot lacks

        return column_types(ReportRow)

    def print_text(self, result: RecordingNumbers) -> None:
        """Print nothing: the numbers are on the page."""

    def shown(self, result: RecordingNumbers) -> RecordingNumbers:
        """Add the numbers to those of the page."""
        self._totals.add(result)
        return result

    def failed(self, line: str) -> None:
        """Keep the line for the page."""
        self._totals.failures.add(line)

    def sum(self) -> str:
        """The headline of the page."""
        from smarttestudo.report.fleet.page import sentence  # noqa: PLC0415  as above

        return sentence(self._totals)

    def html(self) -> str:
        """The page. Raises ``RecordingError`` for a pattern of --topics that names none of any recording."""
        from smarttestudo.bags.topic_selection import select_topics  # noqa: PLC0415
        from smarttestudo.report.fleet.page import render_fleet_report  # noqa: PLC0415  as above

        select_topics(sorted(self._totals.unmatched), (), place=self._arguments.a)
        return render_fleet_report(self._report())

    def _report(self) -> FleetReport:
        from smarttestudo.report.fleet.page import FleetReport  # noqa: PLC0415  as above
        from smarttestudo.report.run_report import Fact  # noqa: PLC0415

        a, b = self._arguments.a, self._arguments.b
        facts = {
            "SmartTestudo": __version__,
            "A": a,
            "B": b,
            "Rules": ", ".join(map(str, self._arguments.rules)),
            "Profile": self._arguments.profile,
        }
        return FleetReport(
            title=a if b is None else f"{a} beside {b}",
            totals=self._totals,
            own_report=self._own_report,
            provenance=tuple(Fact(label=label, value=str(value)) for label, value in facts.items() if value),
        )

    def _own_report(self, recording: RecordingNumbers) -> OwnReport:
        from smarttestudo.report.fleet.page import OwnReport  # noqa: PLC0415  as above

        places = [_from_the_root(one) for one in (recording.a, recording.b) if one is not None]
        words = ["testudo", "bag", "report", *places, *_passed_on(self._arguments)]
        # A report of what has changed since is no report of what the page shows.
        numbers = json_text(to_json(recording), ascii_only=True)
        name = _file_name(recording, [*words, *self._inputs, numbers])
        path = self._arguments.output.absolute().parent / name
        return OwnReport(
            command=" ".join(map(_quoted, [*words, "-o", str(path)])), file_name=name, is_made=path.is_file()
        )


def _from_the_root(place: str) -> str:
    """A path that means the same in any folder."""
    return place if is_url(place) else str(Path(place).absolute())


def _passed_on(arguments: argparse.Namespace) -> Iterator[str]:
    """Options that mean the same of one recording."""
    if arguments.rules:
        yield from ("--rules", *(str(path.absolute()) for path in arguments.rules))
    if arguments.predict:
        yield from ("--predict", *arguments.predict)
    if arguments.profile is not None:
        yield from ("--profile", str(arguments.profile.absolute()))
    for a, b in arguments.map:
        yield from ("--map", f"{a}={b}")
    if arguments.topics:
        yield from ("--topics", *arguments.topics)
    if arguments.timeout != DEFAULT_TIMEOUT_S:
        yield from ("--timeout", f"{arguments.timeout:g}")


def _file_name(recording: RecordingNumbers, contents: Sequence[str]) -> str:
    """The name of a recording's own report, which only one with the same ``contents`` has."""
    own = "-".join(filter(None, (recording.robot, PurePosixPath(recording.a).name)))
    digest = hashlib.sha256("\0".join(contents).encode("utf-8", "surrogateescape")).hexdigest()
    readable = _STRANGE.sub("-", own).strip("-.")[:_MOST_OF_A_NAME]
    return "-".join(filter(None, (readable, digest[:_DIGEST_DIGITS]))) + ".html"


def _quoted(word: str) -> str:
    """``word`` for a shell; what cannot be printed as bash, ksh and zsh write it."""
    if word.isprintable():
        return shlex.quote(word)
    return "$'" + "".join(f"\\x{byte:02x}" for byte in os.fsencode(word)) + "'"


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
        "recordings they decide over each A once more where no decisions were recorded",
    )
    action.add_argument(
        "--decisions",
        metavar="FILE",
        type=file_path,
        help="the file that --decisions wrote when B was made (default: /testudo/decisions of B or A)",
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
        return _write_fleet_report(arguments, asked, profile or Profile(), rules)
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
    from smarttestudo.ruler.files.nav2_map import read_map_header  # noqa: PLC0415  needs packages a robot lacks

    return nav2_map, read_map_header(nav2_map).image


def _report(arguments: argparse.Namespace, profile: Profile, rules: LoadedRules | None) -> RunReport:
    from smarttestudo.domain.floor_plan import FloorPlan  # noqa: PLC0415
    from smarttestudo.replays.decisions import kept_decisions  # noqa: PLC0415
    from smarttestudo.report.bag_report import ReportRequest, bag_report  # noqa: PLC0415
    from smarttestudo.report.comparison_tables import RunNames  # noqa: PLC0415
    from smarttestudo.report.run_report import Fact  # noqa: PLC0415
    from smarttestudo.ruler.files.nav2_map import read_nav2_map  # noqa: PLC0415  needs packages a robot lacks

    a, b = arguments.a, arguments.b
    occupancy = None if arguments.nav2_map is None else read_nav2_map(arguments.nav2_map)
    names = RunNames(before="Sent" if b else name_of(a), after="Received")
    facts = {
        "SmartTestudo": __version__,
        "Recording" if b is None else names.before: a,
        names.after: b,
        "Decisions": arguments.decisions,
        "Map": arguments.nav2_map,
    }
    decided = kept_decisions(b, a)
    if arguments.decisions is not None:
        decided = read_all_decisions(arguments.decisions, print_notice)
    return bag_report(
        ReportRequest(
            a=a,
            b=b,
            title=name_of(a) if b is None else f"{name_of(a)} beside {name_of(b)}",
            explanation=""
            if b is None
            else f"Sent is what the robot published ({a}), received what arrived of it ({b}).",
            names=names,
            mapping=topic_mapping(arguments.map),
            topics=arguments.topics,
            rule_set=rules.rule_set if rules else None,
            rule_texts=rules.texts if rules else {},
            decisions=about_rates(decided),
            actions=about_actions(decided),
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

    return summary_sentence(report.comparison, report.loss)

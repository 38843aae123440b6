# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag report`` over many recordings: one page over all."""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from smarttestudo import __version__
from smarttestudo.bags.remote_path import DEFAULT_TIMEOUT_S, is_url
from smarttestudo.cli.bag_figures import print_written
from smarttestudo.cli.bag_options import topic_mapping
from smarttestudo.cli.output import write_line
from smarttestudo.cli.recordings import Asked, RecordingCommand, each_recording, recordings_in
from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.record import column_types, to_json
from smarttestudo.files.outputs import require_separate
from smarttestudo.files.whole_file import whole_file
from smarttestudo.rules.rule_files import rule_files_named, sha256_of

if TYPE_CHECKING:
    from smarttestudo.cli.progress import Progress
    from smarttestudo.domain.profile import Profile
    from smarttestudo.report.fleet.numbers import RecordingNumbers
    from smarttestudo.report.fleet.page import FleetReport, OwnReport
    from smarttestudo.rules.rule_sets import LoadedRules

_OF_ONE = ("decisions", "budget", "nav2_map", "figures")
"""Options that make sense of one recording, or pair, only."""
_STRANGE = re.compile(r"[^A-Za-z0-9._-]+")
_MOST_OF_A_NAME = 60
_DIGEST_DIGITS = 8


def write_fleet_report(
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
        """Nothing: it is on the page."""

    def shown(self, result: RecordingNumbers) -> RecordingNumbers:
        """All of it, once it is added up."""
        self._totals.add(result)
        return result

    def failed(self, line: str) -> None:
        """Keep it for the page."""
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

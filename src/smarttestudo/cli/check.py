# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo check``: what is wrong or doubtful in rule files."""

from __future__ import annotations

import argparse
import json
import sys
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeVar

from smarttestudo.checks import CheckContext
from smarttestudo.cli.arguments import add_rule_files, file_path
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings, summary
from smarttestudo.cli.link_options import add_connect, connect_options, warn
from smarttestudo.cli.output import write_line, write_lines
from smarttestudo.cli.robots import add_robot, topics_of_robot
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.domain.errors import RuleFileError, UsageError
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import to_json
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.language.resolved_rules import resolve_rules
from smarttestudo.rules.findings import all_findings
from smarttestudo.rules.rule_files import find_rule_files, read_rule_text
from smarttestudo.rules.rule_sets import known_types

_T = TypeVar("_T")

EXIT_ERROR = 1


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Report errors and doubtful rules in rule files. Several files form one set. "
        "Exits with 1 if there is an error; warnings and infos do not count."
    )
    add_rule_files(parser)
    parser.add_argument("--profile", type=file_path, help="what is known about the topics (TOML)")
    parser.add_argument("--bag", type=file_path, help="a recording; report the topics that it does not hold")
    add_connect(parser)
    add_robot(parser)
    parser.add_argument("--format", choices=("text", "json"), default="text", help="default: text")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print all findings; 1 if one is an error or a file could not be read."""
    profile = None if arguments.profile is None else _profile_of(arguments.profile)
    robot_topics = _robot_topics(arguments)
    texts, unreadable = _read(arguments.files)
    results = [parse(text, path) for path, text in texts.items()]
    context = CheckContext(profile=profile, types=known_types(None, profile), has_all_files=not unreadable)
    if robot_topics is not None:
        from smarttestudo.bags.type_definitions import installed_types  # noqa: PLC0415  most ask no robot

        context = replace(
            context,
            bag_topics=robot_topics,
            types=known_types(installed_types(robot_topics), profile),
            topics_lack="the robot publishes no",
            topics_have="which the robot publishes",
        )
    elif arguments.bag is not None:
        context = _with_recording(context, arguments.bag, results)
    findings = all_findings(results, context)
    if arguments.format == "json":
        write_lines(json.dumps([to_json(finding) for finding in findings], indent=2).split("\n"))
    else:
        print_findings(findings, texts, sys.stdout)
        if texts:
            write_line(summary(findings, files=len(texts)))
    sys.stdout.flush()
    for error in unreadable:
        write_line(str(error), sys.stderr)
    has_error = any(finding.severity is Severity.ERROR for finding in findings)
    return EXIT_ERROR if has_error or unreadable else 0


def _read(paths: Iterable[Path]) -> tuple[dict[str, str], Sequence[RuleFileError]]:
    """The text of each file by its path, each once, and why others cannot be read."""
    texts: dict[Path, tuple[str, str]] = {}
    failures: list[RuleFileError] = []
    for path in dict.fromkeys(paths):
        for file in _try(partial(find_rule_files, [path]), failures) or ():
            text = _try(partial(read_rule_text, file), failures)
            if text is not None:
                texts.setdefault(file.resolve(), (str(file), text))
    return dict(texts.values()), failures


def _try(read: Callable[[], _T], failures: list[RuleFileError]) -> _T | None:
    try:
        return read()
    except RuleFileError as error:
        failures.append(error)
        return None


def _robot_topics(arguments: argparse.Namespace) -> Mapping[str, str] | None:
    """The topics and types of a robot, if one is named."""
    options = connect_options(arguments)
    if options is None:
        return None
    if arguments.bag is not None:
        raise UsageError("topics come from one place", place="--bag", remedy="leave out --bag or --connect")
    from smarttestudo.link.zenoh import open_link_robots  # noqa: PLC0415  most checks ask no robot

    with stop_signals() as stopped, open_link_robots(options, warn) as robots:
        return topics_of_robot(robots, arguments.robot, stopped)


def _with_recording(context: CheckContext, bag: Path, results: Sequence[ParseResult]) -> CheckContext:
    """``context`` with topics and types of a recording, and the values in it of what the rules read."""
    from smarttestudo.bags.message_types import MessageTypes, observed_values  # noqa: PLC0415  as the next
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  needs packages a robot lacks
    from smarttestudo.bags.type_definitions import recorded_types  # noqa: PLC0415  as above
    from smarttestudo.cli.bag_options import print_notices  # noqa: PLC0415  loads what tables need
    from smarttestudo.domain.recording import robots_own  # noqa: PLC0415  as above

    with open_recording(bag) as recording:
        found = recorded_types(robots_own(recording.channels))
        types = known_types(found, context.profile)
        blocks = resolve_rules([result.file for result in results], resolve_topic, types).blocks
        signals = {check.signal for block in blocks for check in block.checks}
        observed = observed_values(recording, signals, context.profile)
        # Damage of what no rule reads is met only where it is read, too.
        deque(recording.sizes(), maxlen=0)
        undecodable = MessageTypes().notices(recording.channels, "checks of its fields stay unknown")
        notices = (*recording.notices(), *undecodable)
        context = replace(context, bag_topics=found.topics, types=types, observed=observed)
    print_notices(notices)
    return context


def _profile_of(path: Path) -> Profile:
    from smarttestudo.rules.profile_file import load_profile  # noqa: PLC0415  it loads a parser of TOML

    return load_profile(path)

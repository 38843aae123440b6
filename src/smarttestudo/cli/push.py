# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo push``: rules to a running robot, tried, kept and written in the stages of the Ruler's page."""

from __future__ import annotations

import argparse
import select
import sys
import time

from smarttestudo.cli.arguments import add_timeout, file_path
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.link_options import add_connect
from smarttestudo.cli.output import write_line, write_lines, write_styled
from smarttestudo.cli.robots import STATUS_WITHIN_S, ChosenRobot, add_any_robot, open_chosen_robot
from smarttestudo.domain.errors import RosError, RuleFileError
from smarttestudo.domain.status import RulesOrigin
from smarttestudo.language.parser import parse
from smarttestudo.robot import rule_push
from smarttestudo.robot.rule_manager import CONFIRM_WITHIN_S
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import read_rule_text
from smarttestudo.rules.rule_sets import FaultyRulesError, has_tiers, load_rules

EXIT_ERROR = 1
_LOOK = "see with testudo top which rules it follows"


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Let a running robot follow the rules of a file for ten seconds, and for good where you keep them. "
        "The robot checks them first; rules that cut you off are taken back by themselves."
    )
    parser.add_argument("file", metavar="FILE", type=file_path, help="the rule file")
    parser.add_argument(
        "--profile",
        metavar="FILE",
        type=file_path,
        help="what is known about the topics (TOML): levels are sent as the rates that it gives them",
    )
    parser.add_argument(
        "--keep",
        action="store_true",
        help="keep the rules once the robot says that it follows them (default: ask on a terminal, else "
        "have them taken back after the trial)",
    )
    parser.add_argument(
        "--write",
        action="store_true",
        help="keep them, and have the robot write them to its rule file (testudo run --allow-writing-rules)",
    )
    add_any_robot(parser)
    add_timeout(parser, "how long to wait for the robot")
    add_connect(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Push; 1 where the rules have errors, the robot refuses them, or it is not heard."""
    try:
        text = _text_to_send(arguments)
    except FaultyRulesError as error:
        print_findings(error.rules.errors, error.rules.texts, sys.stderr)
        return EXIT_ERROR
    name = str(arguments.file)
    with open_chosen_robot(arguments, "testudo_push") as robot:
        change = rule_push.preview(robot, robot.robot_id, text, name)
        origin = robot.status().rules.origin
        if change.same and origin is RulesOrigin.WAITING:
            # Who comes late is told the last status, which may be of before they were kept.
            origin = robot.next_status().rules.origin
        if change.same and origin is not RulesOrigin.WAITING:
            write_line(f"{robot.robot_id} follows these rules already, hash {change.robot_hash}")
            if arguments.write and origin is RulesOrigin.PUSHED:
                _write(robot, change.robot_hash)
            return 0
        if arguments.write:
            _require_writable(robot)
        write_lines(f"  {difference}" for difference in change.differences)
        staged = rule_push.push(robot, robot.robot_id, change, name)
        _await_trial(robot, staged.hash)
        write_line(f"{robot.robot_id} follows them, for {staged.confirm_within_s:g} s unless they are kept")
        sys.stdout.flush()
        if not (arguments.keep or arguments.write or _is_kept_by_hand(robot, staged.hash)):
            return _await_end_of_trial(robot, staged.hash)
        rule_push.confirm(robot, robot.robot_id, staged.hash)
        lasting = rule_push.lasting(robot, robot.robot_id)
        until = "its runtime ends or its rule file changes" if lasting.files else "its runtime ends"
        write_line(f"kept until {until}, hash {staged.hash}")
        if arguments.write:
            _write(robot, staged.hash)
    return 0


def _text_to_send(arguments: argparse.Namespace) -> str:
    """The text of the file, with numbers for levels. Raises ``RuleFileError`` for what has errors."""
    profile = None if arguments.profile is None else load_profile(arguments.profile)
    if arguments.file.is_dir():
        cause = "it is a folder, and what is pushed is one text"
        raise RuleFileError(cause, place=str(arguments.file), remedy="name one of its files")
    load_rules([arguments.file], profile=profile).refuse_errors()
    text = read_rule_text(arguments.file)
    if profile is None or not has_tiers([parse(text, str(arguments.file)).file]):
        return text
    from smarttestudo.rules.optimize import OptimizeCommand, optimize  # noqa: PLC0415  needs a solver

    outcome = optimize(OptimizeCommand(rules=arguments.file, profile=arguments.profile))
    if outcome.rewritten is None:
        raise RuleFileError(outcome.infeasible[0].message, place=str(arguments.file))
    return outcome.rewritten


def _require_writable(robot: ChosenRobot) -> None:
    lasting = rule_push.lasting(robot, robot.robot_id)
    if not lasting.writable_file:
        raise RosError(
            f"kept rules cannot be written to its file. {lasting.why_not}",
            place=robot.robot_id,
            remedy="push with --keep in place of --write",
        )


def _is_on_trial(robot: ChosenRobot, sha256: str) -> bool:
    rules = robot.status().rules
    return rules.sha256 == sha256 and rules.origin is RulesOrigin.WAITING


def _await_trial(robot: ChosenRobot, sha256: str) -> None:
    """Wait for a status by which the robot follows the rules: so it is still heard under them."""
    end_s = time.monotonic() + STATUS_WITHIN_S
    while not _is_on_trial(robot, sha256):
        if robot.stopped() or time.monotonic() > end_s:
            cause = "it took the rules, and no status under them was received; it takes them back by itself"
            raise RosError(cause, place=robot.robot_id, remedy=_LOOK)
        robot.wait()


def _is_kept_by_hand(robot: ChosenRobot, sha256: str) -> bool:
    """Whether somebody at the terminal says so during the trial."""
    if not sys.stdin.isatty():
        return False
    write_styled("Keep these rules? [y/N] ")
    sys.stdout.flush()
    while _is_on_trial(robot, sha256) and not robot.stopped():
        robot.wait()
        if select.select([sys.stdin], [], [], 0)[0]:
            return sys.stdin.readline().strip().lower() in ("y", "yes")
    write_line()
    return False


def _await_end_of_trial(robot: ChosenRobot, sha256: str) -> int:
    """Wait until the rules before are in force again, and say so."""
    end_s = time.monotonic() + CONFIRM_WITHIN_S + STATUS_WITHIN_S
    while _is_on_trial(robot, sha256):
        if robot.stopped() or time.monotonic() > end_s:
            raise RosError(
                "no status was received by which it took the rules back", place=robot.robot_id, remedy=_LOOK
            )
        robot.wait()
    rules = robot.status().rules
    if rules.sha256 == sha256:
        write_line(f"kept by somebody else, hash {sha256}")
    else:
        write_line(f"taken back: {robot.robot_id} follows other rules again, hash {rules.sha256}")
    return 0


def _write(robot: ChosenRobot, sha256: str) -> None:
    written = rule_push.write(robot, robot.robot_id, sha256)
    write_line(f"written to {written.file}; what it held is in {written.previous_file}")

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run``: the runtime beside a robot's ROS graph."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from smarttestudo.adapters.files.decision_log import growing_decision_log
from smarttestudo.adapters.files.profile import load_profile
from smarttestudo.adapters.ros import open_robot
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.loop_options import add_ros_arguments, add_rules
from smarttestudo.cli.stop_signals import stop_signals
from smarttestudo.composition.live_decisions import Decided
from smarttestudo.composition.rule_sets import load_rules
from smarttestudo.composition.run import DEFAULT_OUTPUT_TOPIC, RunRequest, run_live
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.robot import Robot
from smarttestudo.pacing.sample import WhenSlow

EXIT_ERROR = 1


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``run`` to the subcommands."""
    parser = commands.add_parser(
        "run",
        help="relay a running robot's topics at the rates that your rules give them now",
        description="Relay the topics of a ROS 2 robot, each at the rate that your rules give it now. "
        "Ends on SIGINT (Ctrl-C) and SIGTERM.",
    )
    add_rules(parser)
    _add_options(parser)
    parser.set_defaults(run=run)


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--output-topic",
        metavar="NAME",
        default=DEFAULT_OUTPUT_TOPIC,
        help="names of the relayed topics (default: %(default)s)",
    )
    parser.add_argument(
        "--topic-prefix",
        metavar="NAME",
        type=topic_prefix,
        default="",
        help="what to put before every topic of the rules and the profile, as in /tb3_0",
    )
    parser.add_argument(
        "--decisions", metavar="FILE", type=Path, help="append the decisions to a file (JSON Lines)"
    )
    add_ros_arguments(parser)


def topic_prefix(text: str) -> str:
    """A prefix from the command line; ``ArgumentTypeError`` for what begins no full topic name."""
    if text and not (text.startswith("/") and is_topic_name(text)):
        raise argparse.ArgumentTypeError(f"a prefix is written as in /tb3_0, not {text!r}")
    return text


def run(arguments: argparse.Namespace) -> int:
    """Relay until a signal comes; 1 if the rules have an error."""
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        robot = opened.enter_context(open_robot(arguments.ros_args))
        request = _request(arguments, robot, opened)
        if request is None:
            return EXIT_ERROR
        run_live(request, robot, stopped)
    return 0


def _request(arguments: argparse.Namespace, robot: Robot, opened: ExitStack) -> RunRequest | None:
    resolve = partial(_resolved, robot.resolve, arguments.topic_prefix)
    profile = None if arguments.profile is None else load_profile(arguments.profile).resolved(resolve)
    rules = load_rules(arguments.rules, profile=profile, resolve=resolve)
    if rules.errors:
        print_findings(rules.errors, rules.texts, sys.stderr)
        return None
    decided: list[Decided] = []
    if arguments.decisions is not None:
        decided.append(opened.enter_context(growing_decision_log(arguments.decisions)))
    return RunRequest(
        rule_set=rules.rule_set,
        rules=rules.in_force,
        profile=profile or Profile(),
        when_slow=WhenSlow(arguments.when_slow),
        output_topic=arguments.output_topic,
        budget_kb_per_s=arguments.budget,
        decided=decided,
    )


def _resolved(resolve: Callable[[str], str], prefix: str, topic: str) -> str:
    return f"{prefix}{resolve(topic)}"

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run``: the runtime beside a robot's ROS graph."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from pathlib import Path

from smarttestudo.adapters.files.decision_log import growing_decision_log
from smarttestudo.adapters.files.input_log import input_log
from smarttestudo.adapters.ros import open_robot
from smarttestudo.cli.loop_options import add_ros_arguments, add_rules
from smarttestudo.cli.stop_signals import stop_signals
from smarttestudo.composition.live_decisions import Decided
from smarttestudo.composition.monitored_topics import DEFAULT_OUTPUT_TOPIC
from smarttestudo.composition.run import run_live
from smarttestudo.composition.run_parameters import RunParameters
from smarttestudo.domain.names import is_topic_prefix
from smarttestudo.domain.parameter import ParameterValue


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``run`` to the subcommands."""
    parser = commands.add_parser(
        "run",
        help="relay a running robot's topics at the rates that your rules give them now",
        description="Relay the topics of a ROS 2 robot, each at the rate that your rules give it now. "
        "Ends on SIGINT (Ctrl-C) and SIGTERM.",
    )
    add_rules(parser, required=False)
    _add_options(parser)
    # What is not given here may be a parameter of the node.
    parser.set_defaults(run=run, when_slow=None)


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--output-topic",
        metavar="NAME",
        help=f"names of the relayed topics (default: {DEFAULT_OUTPUT_TOPIC})",
    )
    parser.add_argument(
        "--topic-prefix",
        metavar="NAME",
        type=topic_prefix,
        help="what to put before every topic of the rules and the profile, as in /tb3_0",
    )
    parser.add_argument(
        "--decisions", metavar="FILE", type=Path, help="append the decisions to a file (JSON Lines)"
    )
    parser.add_argument(
        "--record-inputs",
        metavar="DIR",
        type=Path,
        help="record what the loop sees into a new folder; 'testudo replay DIR' decides the same from it",
    )
    add_ros_arguments(parser)


def topic_prefix(text: str) -> str:
    """A prefix from the command line; ``ArgumentTypeError`` for what begins no full topic name."""
    if not is_topic_prefix(text):
        raise argparse.ArgumentTypeError(f"a prefix is written as in /tb3_0, not {text!r}")
    return text


def run(arguments: argparse.Namespace) -> int:
    """Relay until a signal comes."""
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        robot = opened.enter_context(open_robot(arguments.ros_args))
        parameters = RunParameters(robot, _given(arguments))
        decided: list[Decided] = []
        if parameters.request.decisions is not None:
            decided.append(opened.enter_context(growing_decision_log(parameters.request.decisions)))
        note = None
        if parameters.request.record_inputs is not None:
            note = opened.enter_context(input_log(parameters.request.record_inputs))
        run_live(parameters, robot, stopped, decided, note)
    return 0


def _given(arguments: argparse.Namespace) -> dict[str, ParameterValue]:
    """Parameters of the node by name, of which those that are not ``None`` win over the node's own."""
    return {
        "rules_file": None if arguments.rules is None else tuple(map(str, arguments.rules)),
        "profile_file": None if arguments.profile is None else str(arguments.profile),
        "output_topic": arguments.output_topic,
        "topic_prefix": arguments.topic_prefix,
        "when_slow": arguments.when_slow,
        "budget_kb_per_s": arguments.budget,
        "decisions_file": None if arguments.decisions is None else str(arguments.decisions),
        "record_inputs": None if arguments.record_inputs is None else str(arguments.record_inputs),
    }

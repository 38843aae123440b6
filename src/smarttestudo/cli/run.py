# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run``: the runtime beside a robot's ROS graph."""

from __future__ import annotations

import argparse
import platform
import re
from contextlib import ExitStack

from smarttestudo.cli.command_parser import CommandParser
from smarttestudo.cli.link_options import add_link, link_options, warn
from smarttestudo.cli.loop_options import (
    add_output_domain,
    add_ros_arguments,
    add_rules,
    max_gb,
    memory_mb,
    output_domain,
)
from smarttestudo.cli.metrics_options import add_openmetrics, served_metrics
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.domain.command import command_topics
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB, DEFAULT_INCIDENT_RING_MAX_GB
from smarttestudo.domain.names import TOPIC_PLACEHOLDER, is_topic_prefix
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.robot import DataPathKind
from smarttestudo.files.outputs import require_separate
from smarttestudo.link.zenoh import open_robot_end
from smarttestudo.loop.decision_log import growing_decision_log
from smarttestudo.loop.input_log import INPUTS_FILE, input_log
from smarttestudo.robot.decisions import Decided
from smarttestudo.robot.output_topics import DEFAULT_OUTPUT_TOPIC
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.run import run_live
from smarttestudo.robot.run_metrics import RunMetrics
from smarttestudo.robot.run_parameters import RunParameters, RunRequest
from smarttestudo.rules.rule_files import rule_files_named


def add_arguments(parser: CommandParser) -> None:
    """Add the arguments of ``testudo run``."""
    parser.description = (
        "Relay the topics of a ROS 2 robot, each at the rate that your rules give it now. "
        "Ends on SIGINT (Ctrl-C) and SIGTERM."
    )
    add_rules(parser, required=False)
    _add_options(parser)
    # What is not given here may be a parameter of the node.
    parser.set_defaults(run=run, when_slow=None)


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--allow-writing-rules",
        action="store_true",
        help="let pushed rules be written to the rule file, once they are confirmed",
    )
    parser.add_argument(
        "--output-topic",
        metavar="NAME",
        help=f"names of the relayed topics (default: {DEFAULT_OUTPUT_TOPIC})",
    )
    add_output_domain(parser)
    parser.add_argument(
        "--topic-prefix",
        metavar="NAME",
        type=topic_prefix,
        help="what to put before every topic of the rules and the profile, as in /tb3_0",
    )
    parser.add_argument(
        "--decisions", metavar="FILE", type=file_path, help="append the decisions to a file (JSON Lines)"
    )
    parser.add_argument(
        "--data-path",
        choices=[kind.value for kind in DataPathKind],
        default=DataPathKind.AUTO.value,
        help="how messages are taken and published: through librcl at the least cost, or through rclpy "
        "(default: librcl if it works here)",
    )
    parser.add_argument(
        "--record-inputs",
        metavar="DIR",
        type=file_path,
        help="record the inputs of the loop in a new folder; 'testudo replay DIR' repeats the decisions",
    )
    parser.add_argument(
        "--incidents",
        metavar="DIR",
        type=file_path,
        help="write what the rules record (Record) into this folder, a folder for each incident",
    )
    parser.add_argument(
        "--incident-memory",
        metavar="MB",
        type=memory_mb,
        help=f"memory for what came before an incident (default: {DEFAULT_INCIDENT_MEMORY_MB})",
    )
    parser.add_argument(
        "--incident-ring",
        metavar="DIR",
        type=file_path,
        help="folder on disk for what came before an incident and does not fit into memory",
    )
    parser.add_argument(
        "--incident-ring-max-gb",
        metavar="GB",
        type=max_gb,
        help=f"GB of disk that --incident-ring may take (default: {DEFAULT_INCIDENT_RING_MAX_GB})",
    )
    parser.add_argument(
        "--incidents-max-gb",
        metavar="GB",
        type=max_gb,
        help="disk that all incidents may take: old ones are deleted, those that were read first",
    )
    parser.add_argument(
        "--catch-up",
        action="store_true",
        help="with --link and --incidents: keep there, too, what operators miss in outages of the link, for "
        "'testudo receive --catch-up'",
    )
    add_openmetrics(parser)
    add_link(parser)
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
        watched = RunMetrics(_robot_name(arguments.robot))
        opened.enter_context(served_metrics(arguments.openmetrics, watched.metrics))
        options = link_options(arguments, command_topics(arguments.accept, "--accept"))
        link = None
        if options is not None:
            link = opened.enter_context(open_robot_end(_robot_name(arguments.robot), options, warn))
        robot = opened.enter_context(
            open_robot(
                arguments.ros_args,
                data_path=DataPathKind(arguments.data_path),
                output_domain=output_domain(arguments),
                link=link,
                is_local=_is_local(arguments),
            )
        )
        parameters = RunParameters(robot, _given(arguments))
        _require_catch_up(parameters.request, arguments)
        _require_separate(parameters.request)
        decided: list[Decided] = [watched.note_decisions]
        if parameters.request.decisions is not None:
            decided.append(opened.enter_context(growing_decision_log(parameters.request.decisions)))
        note = None
        if parameters.request.record_inputs is not None:
            note = opened.enter_context(input_log(parameters.request.record_inputs))
        run_live(
            parameters,
            robot,
            stopped,
            decided,
            note=note,
            link=link,
            commands=None if link is None else link.commands,
            told=watched.note_status,
            catches_up=arguments.catch_up,
        )
    return 0


def _robot_name(given: str | None) -> str:
    return given or re.sub(r"[^A-Za-z0-9_]", "_", platform.node()) or "robot"


def _is_local(arguments: argparse.Namespace) -> bool:
    """Whether the ROS graph gets what is relayed."""
    has_link = bool(arguments.link or arguments.link_listen)
    return not has_link or arguments.output_topic is not None or arguments.output_domain is not None


def _require_catch_up(request: RunRequest, arguments: argparse.Namespace) -> None:
    if arguments.catch_up and not (arguments.link or arguments.link_listen):
        raise UsageError("it needs a link", place="--catch-up", remedy="add --link or --link-listen")
    if arguments.catch_up and request.incidents.folder is None:
        raise UsageError(
            "it needs a folder to keep messages in", place="--catch-up", remedy="add --incidents DIR"
        )


def _require_separate(request: RunRequest) -> None:
    recorded = request.record_inputs
    require_separate(
        {
            "--decisions": request.decisions,
            "--record-inputs": None if recorded is None else recorded / INPUTS_FILE,
            "--incidents": request.incidents.folder,
            "--incident-ring": request.incidents.ring,
        },
        (request.profile, *rule_files_named(request.rules)),
    )


def _given(arguments: argparse.Namespace) -> dict[str, ParameterValue]:
    """Parameters of the node by name, of which those that are not ``None`` win over the node's own."""
    return {
        "rules_file": None if arguments.rules is None else tuple(map(str, arguments.rules)),
        "allow_writing_rules": arguments.allow_writing_rules or None,
        "profile_file": None if arguments.profile is None else str(arguments.profile),
        # Over a link topics keep their names: nobody mistakes them for their sources there.
        "output_topic": arguments.output_topic if _is_local(arguments) else TOPIC_PLACEHOLDER,
        "topic_prefix": arguments.topic_prefix,
        "when_slow": arguments.when_slow,
        "budget_kb_per_s": arguments.budget,
        "decisions_file": None if arguments.decisions is None else str(arguments.decisions),
        "record_inputs": None if arguments.record_inputs is None else str(arguments.record_inputs),
        "incidents": None if arguments.incidents is None else str(arguments.incidents),
        "incident_memory_mb": arguments.incident_memory,
        "incident_ring": None if arguments.incident_ring is None else str(arguments.incident_ring),
        "incident_ring_max_gb": arguments.incident_ring_max_gb,
        "incidents_max_gb": arguments.incidents_max_gb,
    }

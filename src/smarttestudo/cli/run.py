# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run``: the runtime beside a robot's ROS graph."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from functools import partial

from smarttestudo.actions.part_kind import ACTIONS_PART, RESTORE_FILE
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.link_options import LinkWarnings, add_openmetrics, open_link, served_run
from smarttestudo.cli.loop_options import (
    add_option,
    add_output_domain,
    add_ros_arguments,
    add_rules,
    output_domain,
    settings_of,
)
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.names import TOPIC_PLACEHOLDER
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.robot import DataPathKind
from smarttestudo.files.outputs import require_separate
from smarttestudo.incidents.part_kinds import CATCH_UP, INCIDENT_RING, INCIDENTS, INCIDENTS_PART, OUTAGES_PART
from smarttestudo.link.parts import COMMANDS_PART, LINK_PART
from smarttestudo.link.parts.options import LINK, LINK_LISTEN, LINK_OPTIONS, has_link, robot_name
from smarttestudo.loop.decision_log import growing_decision_log
from smarttestudo.loop.input_log import INPUTS_FILE, input_log
from smarttestudo.robot.decisions import Decided
from smarttestudo.robot.low_priority import long_lived
from smarttestudo.robot.option import AnyOption, Settings, given_as
from smarttestudo.robot.part import PartKind
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.run import options_of, run_live
from smarttestudo.robot.run_options import (
    DECISIONS,
    OUTPUT_TOPIC,
    PROFILE,
    RECORD_INPUTS,
    RULES,
    RUN_OPTIONS,
    RunParameters,
)
from smarttestudo.robot.vitals import vitals_part
from smarttestudo.rules.rule_files import rule_files_named
from smarttestudo.rules.rule_sets import FaultyRulesError

EXIT_ERROR = 1
PART_KINDS = (INCIDENTS_PART, OUTAGES_PART, LINK_PART, COMMANDS_PART, ACTIONS_PART, vitals_part(INCIDENTS))
"""What stands beside the loop of every run."""


def add_arguments(parser: CommandParser, kinds: Sequence[PartKind] = PART_KINDS) -> None:
    parser.description = (
        "Relay the topics of a ROS 2 robot, each at the rate that your rules give it now. "
        "Ends on SIGINT (Ctrl-C) and SIGTERM."
    )
    add_rules(parser, required=False)
    _add_options(parser, RUN_OPTIONS)
    add_output_domain(parser)
    parser.add_argument(
        "--data-path",
        choices=[kind.value for kind in DataPathKind],
        default=DataPathKind.AUTO.value,
        help="how messages are taken and published: fast, which is without Python where nothing needs them, "
        "through librcl, or through rclpy (default: the first of these that works here)",
    )
    add_openmetrics(parser)
    for kind in kinds:
        _add_options(parser if kind.title is None else parser.add_argument_group(kind.title), kind.options)
    add_ros_arguments(parser)
    # What is not given here may be a parameter of the node.
    parser.set_defaults(run=partial(run, kinds=kinds), when_slow=None)


def run(arguments: argparse.Namespace, kinds: Sequence[PartKind] = PART_KINDS) -> int:
    """Relay until a signal comes."""
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        of_link = settings_of(arguments, LINK_OPTIONS)
        metrics = opened.enter_context(served_run(arguments.openmetrics, robot_name(of_link)))
        warnings = LinkWarnings()
        link = opened.enter_context(open_link(of_link, warnings))
        with long_lived():
            robot = opened.enter_context(
                open_robot(
                    arguments.ros_args,
                    data_path=DataPathKind(arguments.data_path),
                    output_domain=output_domain(arguments),
                    link=link,
                    is_local=_is_local(arguments),
                    sends_large=True,
                )
            )
        opened.enter_context(warnings.logged(robot.log))
        parameters = RunParameters(robot, options_of(kinds), _all_given(arguments, kinds))
        settings = parameters.settings
        _require_catch_up(settings, has_link=link is not None)
        _require_separate(settings)
        decided: list[Decided] = []
        if (decisions := settings[DECISIONS]) is not None:
            decided.append(opened.enter_context(growing_decision_log(decisions)))
        note = None
        if (recorded := settings[RECORD_INPUTS]) is not None:
            note = opened.enter_context(input_log(recorded))
        try:
            run_live(
                parameters,
                robot,
                stopped,
                (*kinds, *metrics),
                decided,
                note=note,
                link=link,
                commands=None if link is None else link.commands,
            )
        except FaultyRulesError as error:
            print_findings(error.rules.errors, error.rules.texts, sys.stderr)
            return EXIT_ERROR
    return 0


def _add_options(parser: argparse._ActionsContainer, options: Sequence[AnyOption]) -> None:
    for option in options:
        if option.flag is not None and not option.is_shared:
            add_option(parser, option.flag, option)


def _is_local(arguments: argparse.Namespace) -> bool:
    """Whether the ROS graph gets what is relayed."""
    if not has_link(settings_of(arguments, (LINK, LINK_LISTEN))):
        return True
    return getattr(arguments, OUTPUT_TOPIC.key) is not None or arguments.output_domain is not None


def _require_catch_up(settings: Settings, *, has_link: bool) -> None:
    if settings[CATCH_UP] and not has_link:
        raise UsageError("it needs a link", place="--catch-up", remedy="add --link or --link-listen")
    if settings[CATCH_UP] and settings[INCIDENTS] is None:
        raise UsageError(
            "it needs a folder to keep messages in", place="--catch-up", remedy="add --incidents DIR"
        )


def _require_separate(settings: Settings) -> None:
    recorded = settings[RECORD_INPUTS]
    require_separate(
        {
            "--decisions": settings[DECISIONS],
            "--record-inputs": None if recorded is None else recorded / INPUTS_FILE,
            "--incidents": settings[INCIDENTS],
            "--incident-ring": settings[INCIDENT_RING],
            "--restore-file": settings[RESTORE_FILE],
        },
        (settings[PROFILE], *rule_files_named(settings[RULES])),
    )


def _all_given(arguments: argparse.Namespace, kinds: Sequence[PartKind]) -> dict[str, ParameterValue]:
    """Values of options by key, of which those that are not ``None`` win over the node's own."""
    given = {
        option.key: given_as(getattr(arguments, option.attribute))
        for option in options_of(kinds)
        if option.flag is not None
    }
    if _is_local(arguments):
        return given
    # Over a link topics keep their names: nobody mistakes them for their sources there.
    return {**given, OUTPUT_TOPIC.key: TOPIC_PLACEHOLDER}

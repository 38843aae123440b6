# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options that commands with a loop or a simulated robot share."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable
from functools import partial

from smarttestudo.cli.arguments import budget_kb_per_s, file_path, number_type, whole_number_type
from smarttestudo.domain.errors import Extra, MissingPackageError, UsageError, how_to_install
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.robot import LAST_DOMAIN, DiscoveryRange, OutputDomain
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.robot.option import AnyOption, Settings, given_as

_ROBOTS = ("waffle", "quadrotor")


def add_physics(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--physics",
        action="store_true",
        help="a robot with masses, wheels that slip, odometry that drifts and a battery; it obeys /cmd_vel "
        "(needs the extra physics)",
    )
    parser.add_argument(
        "--robot", choices=_ROBOTS, help="with --physics: a TurtleBot3 Waffle (default), or one that flies"
    )
    parser.add_argument(
        "--teleop", action="store_true", help="with --physics: drive by keys in this terminal, as w a s d x"
    )
    parser.add_argument(
        "--battery",
        metavar="PERCENT",
        type=number_type(lambda number: 0 <= number <= 100, refusal="{} is not a percentage from 0 to 100"),
        help="with --physics: what is left in the battery at the start (default: 100)",
    )
    parser.add_argument(
        "--cover-lidar",
        metavar="S",
        type=number_type(
            lambda number: 0 <= number < math.inf, refusal="{} is not a number of seconds of 0 or more"
        ),
        help="with --physics: after so many seconds something covers the LiDAR",
    )


def require_physics(arguments: argparse.Namespace, *, is_terminal: bool) -> None:
    """Refuse options that go with others only, with a ``UsageError``."""
    given = {
        "--robot": arguments.robot is not None,
        "--teleop": arguments.teleop,
        "--battery": arguments.battery is not None,
        "--cover-lidar": arguments.cover_lidar is not None,
    }
    for option, is_given in given.items():
        if is_given and not arguments.physics:
            raise UsageError("only a robot with physics has that", place=option, remedy="add --physics")
    if arguments.robot == "quadrotor" and given["--cover-lidar"]:
        raise UsageError("the quadrotor has no LiDAR", place="--cover-lidar", remedy="leave it out")
    if arguments.teleop and arguments.mission is not None:
        raise UsageError("keys and a mission cannot both drive", place="--teleop", remedy="leave one out")
    if arguments.teleop and not is_terminal:
        raise UsageError(
            "standard input is no terminal", place="--teleop", remedy="publish on /cmd_vel instead"
        )


def load_physics() -> None:
    """Have MuJoCo loaded, or say in one line what lacks, before a node is seen that would not come to drive.

    Raises:
        MissingPackageError: it, or what it needs, is not installed.
        PhysicsError: it does not load.
    """
    try:
        from smarttestudo.simulation.physics.engine import load_mujoco  # noqa: PLC0415  needs the extra
    except ModuleNotFoundError as error:
        cause = f"--physics needs the package {error.name}"
        raise MissingPackageError(cause, remedy=how_to_install(Extra.PHYSICS)) from error
    load_mujoco()


def add_rules(parser: argparse.ArgumentParser, *, required: bool = True) -> None:
    parser.add_argument(
        "--rules",
        metavar="FILE",
        nargs="+",
        action="extend",
        type=file_path,
        required=required,
        help="rule files, or folders of them; several form one set",
    )
    parser.add_argument(
        "--profile", metavar="FILE", type=file_path, help="what is known about the topics (TOML)"
    )
    parser.add_argument(
        "--budget",
        metavar="N",
        type=budget_kb_per_s,
        help="KB/s that all relayed topics together may take; rates are cut by priority, not below floors",
    )
    add_when_slow(parser)


def add_when_slow(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--when-slow",
        choices=[mode.value for mode in WhenSlow],
        default=WhenSlow.PASS.value,
        help="what to do where a target is above its source: pass what comes (default), or repeat the newest",
    )


def add_option(parser: argparse._ActionsContainer, flag: str, option: AnyOption) -> None:
    """Add ``option`` of a run under ``flag``; what is not given is ``None``."""
    default = option.default
    if default is False:
        parser.add_argument(flag, action="store_const", const=True, dest=option.key, help=option.help)
        return
    if option.is_list:
        parser.add_argument(
            flag,
            metavar=option.metavar,
            nargs=option.nargs,
            action="append" if option.nargs is None else "extend",
            dest=option.key,
            help=option.help,
        )
        return
    shown = f" (default: {f'{default:g}' if isinstance(default, float) else default})" if default else ""
    parser.add_argument(
        flag,
        metavar=option.metavar,
        dest=option.key,
        type=partial(given_value, option),
        help=f"{option.help}{shown}",
    )


def settings_of(arguments: argparse.Namespace, options: Iterable[AnyOption]) -> Settings:
    """The values that the command line has for ``options``. Raises ``UsageError``."""
    known = [one for one in options if one.flag is not None]
    return Settings(known, {one.key: given_as(getattr(arguments, one.attribute)) for one in known})


def given_value(option: AnyOption, text: str) -> ParameterValue:
    """Value that a parameter would hold; ``ArgumentTypeError`` for a text that the option cannot have."""
    try:
        return given_as(option.from_text(text))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def add_ros_arguments(parser: argparse.ArgumentParser) -> None:
    """Add ``--ros-args``, which takes all that follows."""
    parser.add_argument(
        "--ros-args",
        metavar="ARG",
        nargs=argparse.REMAINDER,
        default=[],
        help="all that follows goes to ROS, as in --ros-args -r __ns:=/tb3_0 -p use_sim_time:=true",
    )


seconds = number_type(
    lambda number: 1 <= number <= 86_400, refusal="{} is not a number of seconds from 1 to 86400"
)


def add_simulation(
    parser: argparse.ArgumentParser, *, full_images_help: str, medium_images_help: str | None = None
) -> None:
    """Add ``--seed`` and ``--full-images``, and where they have a help ``--medium-images``."""
    parser.add_argument(
        "--seed",
        metavar="N",
        type=whole_number_type(0, math.inf, refusal="{} is not a whole number of 0 or more"),
        default=0,
        help="fixes all noise (default: %(default)s)",
    )
    images = parser.add_mutually_exclusive_group()
    images.add_argument("--full-images", action="store_true", help=full_images_help)
    if medium_images_help is not None:
        images.add_argument("--medium-images", action="store_true", help=medium_images_help)


def add_mission(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--mission",
        metavar="FILE",
        type=file_path,
        help="drive this tour (TOML, as examples/errands.mission.toml), instead of the patrol of the thesis",
    )


def add_output_domain(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--output-domain",
        metavar="N",
        type=whole_number_type(
            0, LAST_DOMAIN, refusal=f"a ROS domain is a number from 0 to {LAST_DOMAIN}, not {{}}"
        ),
        help="publish into ROS domain N, so that the radio carries nothing but what is relayed",
    )
    parser.add_argument(
        "--output-discovery",
        choices=[discovery.value for discovery in DiscoveryRange],
        help="how far that domain reaches (default: as ROS_AUTOMATIC_DISCOVERY_RANGE says)",
    )


def output_domain(arguments: argparse.Namespace) -> OutputDomain | None:
    """The domain that the command line names; ``UsageError`` for a discovery range without one."""
    discovery = None if arguments.output_discovery is None else DiscoveryRange(arguments.output_discovery)
    if arguments.output_domain is not None:
        return OutputDomain(number=arguments.output_domain, discovery=discovery)
    if discovery is not None:
        raise UsageError(
            "it needs an output domain", place="--output-discovery", remedy="add --output-domain N"
        )
    return None

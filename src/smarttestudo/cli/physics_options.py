# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The options of a robot with physics."""

from __future__ import annotations

import argparse
import math

from smarttestudo.domain.errors import Extra, MissingPackageError, UsageError, how_to_install

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
        type=_percent,
        help="with --physics: what is left in the battery at the start (default: 100)",
    )
    parser.add_argument(
        "--cover-lidar",
        metavar="S",
        type=_after_s,
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


def _percent(text: str) -> float:
    number = _number(text)
    if not 0 <= number <= 100:
        raise argparse.ArgumentTypeError(f"{text!r} is not a percentage from 0 to 100")
    return number


def _after_s(text: str) -> float:
    number = _number(text)
    if not 0 <= number < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds of 0 or more")
    return number


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan

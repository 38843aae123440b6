# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo simulate``: a robot for those who have none at hand."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from contextlib import nullcontext
from typing import TYPE_CHECKING

from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.loop_options import (
    add_mission,
    add_physics,
    add_ros_arguments,
    add_simulation,
    load_physics,
    require_physics,
    seconds,
)
from smarttestudo.cli.terminal import key_presses, stop_signals
from smarttestudo.robot.ros import open_robot

if TYPE_CHECKING:
    from smarttestudo.domain.robot import Robot
    from smarttestudo.simulation.camera import FrameSize


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Simulate a TurtleBot3 that patrols a warehouse in real time, as a ROS 2 node. "
        "Ends on SIGINT (Ctrl-C) and SIGTERM."
    )
    parser.add_argument("--seconds", metavar="S", type=seconds, help="length of the drive (default: endless)")
    add_simulation(
        parser,
        full_images_help="publish the raw camera, and whole compressed frames: about 190 MB each second",
        medium_images_help="compressed frames of 960 x 540 pixels, about 100 KB each",
    )
    add_mission(parser)
    add_physics(parser)
    add_ros_arguments(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Drive until done or a signal comes."""
    require_physics(arguments, is_terminal=sys.stdin.isatty())
    node = "quadrotor" if arguments.robot == "quadrotor" else "turtlebot3"
    with stop_signals() as stopped:
        if arguments.physics:
            load_physics()
        ros_arguments = ["-r", f"__node:={node}", *arguments.ros_args]
        with open_robot(ros_arguments, sends_large=True) as robot:
            # This needs packages that a robot lacks.
            from smarttestudo.simulation.camera import FrameSize  # noqa: PLC0415

            frames = FrameSize.FULL if arguments.full_images else FrameSize.SMALL
            if arguments.medium_images:
                frames = FrameSize.MEDIUM
            drive = _drive_with_physics if arguments.physics else _drive
            drive(arguments, frames, robot, stopped)
    return 0


def _drive(
    arguments: argparse.Namespace, frames: FrameSize, robot: Robot, stopped: Callable[[], bool]
) -> None:
    from smarttestudo.simulation.simulate import SimulateRequest, simulate  # noqa: PLC0415  see run

    simulate(
        SimulateRequest(
            seconds=arguments.seconds, seed=arguments.seed, mission=arguments.mission, frames=frames
        ),
        robot,
        stopped,
    )


def _drive_with_physics(
    arguments: argparse.Namespace, frames: FrameSize, robot: Robot, stopped: Callable[[], bool]
) -> None:
    from smarttestudo.simulation.physics.drive import RobotKind, Teleop  # noqa: PLC0415  see run
    from smarttestudo.simulation.simulate import SimulatePhysicsRequest, simulate_physics  # noqa: PLC0415

    kind = RobotKind(arguments.robot or RobotKind.WAFFLE.value)
    teleop = Teleop(kind) if arguments.teleop else None
    # A process in the background that asks for keys is stopped.
    with nullcontext(str) if teleop is None else key_presses() as keys:
        if teleop is not None:
            robot.log.info(f"Keys: {teleop.keys}")
        simulate_physics(
            SimulatePhysicsRequest(
                kind=kind,
                seconds=arguments.seconds,
                seed=arguments.seed,
                frames=frames,
                battery_percent=100.0 if arguments.battery is None else arguments.battery,
                cover_s=arguments.cover_lidar,
                mission=arguments.mission,
                teleop=teleop,
                keys=keys,
            ),
            robot,
            stopped,
        )

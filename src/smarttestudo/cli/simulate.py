# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo simulate``: a robot for those who have none at hand."""

from __future__ import annotations

import argparse

from smarttestudo.adapters.ros import open_robot
from smarttestudo.cli.command_parser import CommandParser
from smarttestudo.cli.loop_options import add_mission, add_ros_arguments, add_simulation, seconds
from smarttestudo.cli.terminal import stop_signals

NODE = ("-r", "__node:=turtlebot3")


def add_arguments(parser: CommandParser) -> None:
    """Add the arguments of ``testudo simulate``."""
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
    add_ros_arguments(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Drive until done or a signal comes."""
    with stop_signals() as stopped, open_robot([*NODE, *arguments.ros_args]) as robot:
        # These need packages that a robot lacks.
        from smarttestudo.simulation.camera import FrameSize  # noqa: PLC0415
        from smarttestudo.use_cases.demo.simulate import SimulateRequest, simulate  # noqa: PLC0415

        frames = FrameSize.FULL if arguments.full_images else FrameSize.SMALL
        simulate(
            SimulateRequest(
                seconds=arguments.seconds,
                seed=arguments.seed,
                mission=arguments.mission,
                frames=FrameSize.MEDIUM if arguments.medium_images else frames,
            ),
            robot,
            stopped,
        )
    return 0

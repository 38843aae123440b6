# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo profile``: sizes, rates and a first proposal of tiers, measured."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.cli.arguments import add_timeout, duration_s, file_path
from smarttestudo.cli.bag_options import add_topics
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.output import progress, write_file_text, write_line
from smarttestudo.domain.errors import ProfileError, UsageError
from smarttestudo.files.outputs import require_separate
from smarttestudo.files.whole_file import whole_file
from smarttestudo.robot.profile import profile_of_robot
from smarttestudo.robot.ros import open_robot
from smarttestudo.rules.profile_file import load_profile, profile_schema

if TYPE_CHECKING:
    from smarttestudo.domain.profile import Profile
    from smarttestudo.optimizer.profiling import TierProposal


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Measure message sizes, rates and jitter in a recording or of a running robot, and write "
        "them as a profile with proposed levels. Without -o it goes to standard output. With --schema: "
        "write what editors need to check profiles and to explain their keys."
    )
    measured = parser.add_mutually_exclusive_group(required=True)
    measured.add_argument(
        "--bag", metavar="BAG", type=file_path, help="a rosbag2 folder, a .db3 or an .mcap file"
    )
    measured.add_argument(
        "--seconds", metavar="N", type=duration_s, help="measure the topics of a running robot for N seconds"
    )
    measured.add_argument(
        "--schema", action="store_true", help="write the JSON schema of profiles, and measure nothing"
    )
    add_timeout(parser, "with --seconds: how long to wait for the first topic")
    add_topics(parser)
    parser.add_argument(
        "--from-curve",
        action="store_true",
        help="with --bag: propose levels where the loss at each rate bends, as `bag loss BAG` shows it",
    )
    parser.add_argument(
        "--accuracies-of",
        metavar="PROFILE",
        type=file_path,
        help="measure what the tiers_m, tiers_deg and tiers_rad of this profile need, not proposed ones",
    )
    parser.add_argument("-o", "--output", metavar="FILE", type=file_path, help="where to write the profile")
    parser.add_argument(
        "--ros-args",
        metavar="ARG",
        nargs=argparse.REMAINDER,
        default=[],
        help="with --seconds: all that follows goes to ROS, as in --ros-args -p use_sim_time:=true",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure and write; an existing profile is never overwritten, because tiers are chosen by hand."""
    output: Path | None = arguments.output
    if output is not None and output.exists():
        raise ProfileError("the file exists already", place=str(output), remedy="give another name")
    if arguments.from_curve and arguments.bag is None:
        raise UsageError("a curve needs a recording", place="--from-curve", remedy="give one with --bag")
    require_separate({"--output": output}, (arguments.bag, arguments.accuracies_of))
    levels = None if arguments.accuracies_of is None else load_profile(arguments.accuracies_of)
    if arguments.schema:
        text = json.dumps(profile_schema(), indent=2, ensure_ascii=False) + "\n"
    else:
        text = _of_robot(arguments, levels) if arguments.bag is None else _of_recording(arguments, levels)
    if output is None:
        write_file_text(text)
        return 0
    with whole_file(output, "the profile", must_be_new=True) as write:
        write(text)
    return 0


def _of_recording(arguments: argparse.Namespace, levels: Profile | None) -> str:
    from smarttestudo.bags.profile import profile_notices, profile_of_recording  # noqa: PLC0415
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  needs packages a robot lacks

    proposals = _breakpoints(arguments.bag) if arguments.from_curve else None
    with open_recording(arguments.bag) as recording:
        text = profile_of_recording(
            recording, name=arguments.bag.name, patterns=arguments.topics, proposals=proposals, levels=levels
        )
        notices = [*profile_notices(recording), *recording.notices()]
    _note(notices)
    return text


def _of_robot(arguments: argparse.Namespace, levels: Profile | None) -> str:
    name = f"testudo_profile_{os.getpid()}"
    with open_robot(arguments.ros_args, name=name) as robot, progress("Measuring") as report:
        measured = profile_of_robot(
            robot,
            seconds=arguments.seconds,
            timeout_s=arguments.timeout,
            patterns=arguments.topics,
            levels=levels,
            steady_s=time.monotonic,
            report=report,
        )
    _note(measured.notices)
    return measured.text


def _note(notices: Iterable[str]) -> None:
    for notice in notices:
        write_line(f"note: {notice}", sys.stderr)


def _breakpoints(bag: Path) -> dict[str, TierProposal]:
    from smarttestudo.accuracy.curve import measure_curves  # noqa: PLC0415  see _of_recording

    with progress(f"Reading {bag}") as report:
        curves = measure_curves(bag, report=report).curves
    return {curve.topic: curve.breakpoints for curve in curves if curve.breakpoints}

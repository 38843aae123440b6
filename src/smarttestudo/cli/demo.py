# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo demo``: a warehouse mission with and without adaptive monitoring, no robot needed."""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.cli.arguments import file_path
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.loop_options import add_mission, add_simulation, add_when_slow, load_physics, seconds
from smarttestudo.cli.output import progress, write_line, write_lines
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.robot import DiscoveryRange, Robot
from smarttestudo.files.outputs import require_separate
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.report.comparison_tables import bandwidth_table, frequency_table
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.discovery import discovery_variables

if TYPE_CHECKING:
    from smarttestudo.accuracy.comparison import AccuracyComparison
    from smarttestudo.accuracy.loss_report import LossReport
    from smarttestudo.simulation.demo.demo import DemoOutcome

_DEFAULT_OUT = Path("demo-out")
_DEFAULT_SECONDS = 200.0


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Simulate a TurtleBot3 that patrols a warehouse with three security zones, record it, "
        "replay the recording under rules, and compare the two. The same seed gives the same messages."
    )
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=file_path,
        default=_DEFAULT_OUT,
        help="output folder; replaces the files of an earlier demo there, but keeps and uses rules "
        "that you edited (default: %(default)s)",
    )
    parser.add_argument(
        "--seconds",
        metavar="S",
        type=seconds,
        default=_DEFAULT_SECONDS,
        help="length of the mission; a round takes about 200 s (default: %(default)g)",
    )
    parser.add_argument(
        "--live",
        action="store_true",
        help="in real time over a real ROS graph: the robot, the runtime and a recorder as processes",
    )
    parser.add_argument(
        "--physics",
        action="store_true",
        help="with --live: the robot has masses, wheels that slip and odometry that drifts (needs the extra "
        "physics)",
    )
    add_simulation(
        parser,
        full_images_help="write whole camera frames (about 0.2 GB a second) instead of small ones with "
        "declared sizes",
    )
    add_mission(parser)
    add_when_slow(parser)
    parser.add_argument(
        "--thesis",
        action="store_true",
        help="also write the tables and figures of the thesis's evaluation; where --when-slow is not given, "
        "it is repeat then, as in the thesis",
    )
    parser.set_defaults(run=run, when_slow=None)


def run(arguments: argparse.Namespace) -> int:
    """Run the demo and print what came of it."""
    from smarttestudo.simulation.demo.demo import run_demo  # noqa: PLC0415  needs packages a robot lacks
    from smarttestudo.simulation.demo.folder import DemoRequest  # noqa: PLC0415

    require_separate({"--out": arguments.out})
    if arguments.physics and not arguments.live:
        raise UsageError("a robot with physics drives in real time", place="--physics", remedy="add --live")
    if arguments.when_slow is None:
        arguments.when_slow = (WhenSlow.REPEAT if arguments.thesis else WhenSlow.PASS).value
    with ExitStack() as opened:
        if arguments.physics:
            load_physics()
        robot = _recorder(opened) if arguments.live else None
        outcome = run_demo(
            DemoRequest(
                out=arguments.out,
                seconds=arguments.seconds,
                seed=arguments.seed,
                full_images=arguments.full_images,
                when_slow=WhenSlow(arguments.when_slow),
                progress=progress,
                robot=robot,
                mission=arguments.mission,
                physics=arguments.physics,
                with_thesis=arguments.thesis,
            )
        )
    _print(outcome, arguments.out, with_thesis=arguments.thesis)
    return 0


def _recorder(opened: ExitStack) -> Robot:
    """The node that records a live demo; visible on this machine only, unless the environment says more."""
    for name, value in discovery_variables(DiscoveryRange.LOCALHOST).items():
        os.environ.setdefault(name, value)
    return opened.enter_context(open_robot(["-r", "__node:=recorder"]))


def _print(outcome: DemoOutcome, out: Path, *, with_thesis: bool) -> None:
    from smarttestudo.report.summary import declared_sentence  # noqa: PLC0415
    from smarttestudo.simulation.demo import folder  # noqa: PLC0415  see run

    for table in (frequency_table(outcome.report.comparison), bandwidth_table(outcome.report.comparison)):
        print_table(table)
        write_line()
    _print_loss(outcome.report.loss)
    _print_accuracy(outcome.report.accuracy)
    write_lines([declared_sentence(outcome.report.comparison), ""])
    for notice in outcome.notices:
        write_line(f"note: {notice}", sys.stderr)
    bounding = {
        folder.WITHIN: "rules that keep the operator's picture within bounds",
        folder.PREDICTED: "the same for an operator's end that shows dead reckoning",
        folder.ACCURACY: "how far the picture is off under each of them",
    }
    written = {
        folder.BASELINE: "what the robot published (rosbag2)",
        folder.ADAPTIVE: "what the operator received (rosbag2)",
        folder.DECISIONS: f"every change of a rate, with its reason: {outcome.decisions} decisions",
        folder.RULES: "the rules",
        **(bounding if outcome.report.accuracy else {}),
        folder.REPORT: "all of it in one page: map, decisions, rates, bandwidth, losses",
        **(
            {folder.THESIS: "tables 7.1 and 7.2 of the thesis, a figure of each topic, zones"}
            if with_thesis
            else {}
        ),
    }
    width = max(len(str(out / name)) for name in written)
    for name, meaning in written.items():
        write_line(f"{out / name!s:<{width}}  {meaning}")
    baseline, rules, report = (
        shlex.quote(str(out / name)) for name in (folder.BASELINE, folder.RULES, folder.REPORT)
    )
    write_lines(
        (
            "",
            f"Open {report} in a browser. Then edit {rules} and see what the operator gets:",
            f"  {_own_command()} replay {baseline} --rules {rules} "
            "--output my-recording --report my-report.html",
        )
    )


def _own_command() -> str:
    """How this very testudo is typed here; the shell need not find it by its name."""
    called = Path(sys.argv[0])
    if called.stem != "testudo":
        return f"{shlex.quote(sys.executable)} -m smarttestudo"
    found = shutil.which(called.stem)
    return called.stem if found and Path(found).samefile(called) else shlex.quote(str(called))


def _print_loss(loss: LossReport | None) -> None:
    from smarttestudo.report.summary import loss_sentences  # noqa: PLC0415  see run

    for sentence in () if loss is None else (*loss_sentences(loss), ""):
        write_line(sentence)


def _print_accuracy(accuracy: AccuracyComparison | None) -> None:
    from smarttestudo.report.accuracy_tables import accuracy_sentences, accuracy_tables  # noqa: PLC0415  see run

    if accuracy is None:
        return
    for table in accuracy_tables(accuracy):
        print_table(table)
    sentences = tuple(accuracy_sentences(accuracy))
    for line in ("", *sentences, "") if sentences else ("",):
        write_line(line)

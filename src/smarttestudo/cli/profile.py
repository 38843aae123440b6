# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo profile``: sizes, rates and a first proposal of tiers, measured."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.cli.progress import progress
from smarttestudo.domain.errors import ProfileError

if TYPE_CHECKING:
    from smarttestudo.optimizer.profiling.proposal import TierProposal


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``profile`` to the subcommands."""
    parser = commands.add_parser(
        "profile",
        help="measure sizes and rates, and propose tiers",
        description="Measure message sizes, rates and jitter in a recording, and write them as a profile "
        "with proposed tiers. Without -o it goes to standard output.",
    )
    parser.add_argument(
        "--bag", metavar="BAG", type=Path, required=True, help="a rosbag2 folder, a .db3 or an .mcap file"
    )
    parser.add_argument(
        "--from-curve",
        action="store_true",
        help="propose tiers where the loss at each rate bends, as `bag loss BAG` shows it",
    )
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help="where to write the profile")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure and write; an existing profile is never overwritten, because tiers are chosen by hand."""
    from smarttestudo.adapters.rosbag import open_recording  # noqa: PLC0415  needs packages a robot lacks
    from smarttestudo.composition.profile_recording import profile_of_recording  # noqa: PLC0415

    output: Path | None = arguments.output
    if output is not None and output.exists():
        raise ProfileError("the file exists already", place=str(output), remedy="give another name")
    proposals = _breakpoints(arguments.bag) if arguments.from_curve else None
    with open_recording(arguments.bag) as recording:
        text = profile_of_recording(recording, name=arguments.bag.name, proposals=proposals)
        for notice in recording.notices():
            print(f"note: {notice}", file=sys.stderr)  # noqa: T201
    if output is None:
        sys.stdout.write(text)
        return 0
    try:
        with output.open("x", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        cause = f"the profile cannot be written: {error.strerror}"
        raise ProfileError(cause, place=str(output), remedy="check the folder") from error
    return 0


def _breakpoints(bag: Path) -> dict[str, TierProposal]:
    from smarttestudo.composition.bag_curves import measure_curves  # noqa: PLC0415  see run

    with progress(f"Reading {bag}") as report:
        curves = measure_curves(bag, report=report).curves
    return {curve.topic: curve.breakpoints for curve in curves if curve.breakpoints}

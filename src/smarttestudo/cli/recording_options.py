# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options of commands over recordings: those that are named, and the executor of several."""

from __future__ import annotations

import argparse

from smarttestudo.bags.remote_path import DEFAULT_TIMEOUT_S
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.terminal import duration_s

RECORDINGS_HELP = (
    "a rosbag2 folder, a .db3 or an .mcap file, or its URL (s3://bucket/a.mcap); any other folder, or a "
    "quoted pattern ('bags/*.mcap'), stands for all recordings in it"
)


def recording_name(text: str) -> str:
    """Recordings from the command line; ``ArgumentTypeError`` for an empty name."""
    if not text:
        raise argparse.ArgumentTypeError("the name of a file or folder is not empty")
    return text


def add_recordings(action: argparse.ArgumentParser, *, or_else: str = "") -> None:
    """Add one recording or more; ``or_else`` is what may be named instead."""
    action.add_argument(
        "bags",
        metavar="BAG",
        nargs="+",
        type=recording_name,
        help="; ".join(filter(None, (RECORDINGS_HELP, or_else))),
    )


def add_pair(action: argparse.ArgumentParser, *, a: str, b: str, is_b_optional: bool = False) -> None:
    """Add A and B, which are described by ``a`` and ``b``."""
    pairs = "several are paired by their names in the folders, or by what the patterns leave open"
    action.add_argument("a", metavar="A", type=recording_name, help=f"{a}: {RECORDINGS_HELP}")
    action.add_argument(
        "b", metavar="B", nargs="?" if is_b_optional else None, type=recording_name, help=f"{b}; {pairs}"
    )


def add_several(action: argparse.ArgumentParser) -> None:
    """Add who works on several recordings, and where the rows of all are gathered."""
    several = action.add_argument_group("several recordings")
    several.add_argument(
        "--workers",
        metavar="N",
        type=_positive,
        help="work on so many at once, each in a process (default: one for each core, and for every "
        "two recordings at most; 1: in this process)",
    )
    several.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="work on them on the Dask cluster of this scheduler, as in tcp://10.0.0.2:8786 (needs the "
        "extra fleet)",
    )

    several.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=duration_s,
        default=DEFAULT_TIMEOUT_S,
        help="how long a server of a URL may take for an answer (default: %(default)g)",
    )
    action.add_argument(
        "--parquet",
        metavar="DIR",
        type=file_path,
        help="also add rows of it to the Parquet tables in this folder (needs the extra fleet)",
    )


def _positive(text: str) -> int:
    number = int(text) if text.isascii() and text.isdigit() else 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of 1 or more")
    return number

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings, options and output that the ``bag`` commands share."""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smarttestudo.bags.incident_record import incident_text, record_beside
from smarttestudo.bags.remote_path import DEFAULT_TIMEOUT_S
from smarttestudo.cli.arguments import duration_s, file_path, whole_number_type
from smarttestudo.cli.output import write_file_text, write_line, write_lines
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.errors import RecordingError, UsageError
from smarttestudo.domain.json_text import json_text
from smarttestudo.report.table import Table

if TYPE_CHECKING:
    from smarttestudo.rules.rule_sets import LoadedRules


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
        type=whole_number_type(1, math.inf, refusal="{} is not a whole number of 1 or more"),
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


def add_topics(action: argparse.ArgumentParser) -> None:
    action.add_argument(
        "--topics",
        metavar="NAME",
        nargs="+",
        action="extend",
        type=topic_pattern,
        default=[],
        help="only these topics, by name or pattern ('/camera/*')",
    )


def add_topics_and_form(action: argparse.ArgumentParser) -> None:
    add_topics(action)
    add_form(action)


def add_form(action: argparse.ArgumentParser, *, instead_of: str = "tables") -> None:
    form = action.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help=f"print one JSON object instead of {instead_of}")
    form.add_argument(
        "--csv", action="store_true", help=f"print comma-separated values instead of {instead_of}"
    )


def add_map(action: argparse.ArgumentParser) -> None:
    action.add_argument(
        "--map",
        metavar="/a=/b",
        action="append",
        default=[],
        type=_topic_pair,
        help="pair A's /a with B's /b; may be given several times",
    )


def add_predict(action: argparse.ArgumentParser) -> None:
    action.add_argument(
        "--predict",
        metavar="TOPIC",
        nargs="+",
        action="extend",
        default=[],
        help="judge the bounds of these topics by dead reckoning, which B's receiver shows; of all others "
        "the last message received is held",
    )


def require_bounded(topics: Collection[str], rules: LoadedRules | None) -> None:
    """Raise ``UsageError`` for a topic to predict that no rule bounds."""
    from smarttestudo.accuracy.bounds import bounded_topics  # noqa: PLC0415 - most commands have no rules

    bounded = bounded_topics(rules.rule_set) if rules else frozenset()
    for topic in topics:
        if topic not in bounded and not (rules and rules.rule_set.patterns):
            raise UsageError(
                f"no rule bounds {topic}", place="--predict", remedy="name topics of a KeepWithin in --rules"
            )


def topic_mapping(pairs: Sequence[tuple[str, str]]) -> dict[str, str]:
    """Mapping that ``--map`` gives; ``UsageError`` for a topic that is paired twice."""
    mapping = dict(pairs)
    if len(mapping) < len(pairs) or len(set(mapping.values())) < len(mapping):
        raise UsageError("a topic is paired twice", place="--map", remedy="give each topic once")
    return mapping


def topic_pattern(text: str) -> str:
    """A name or pattern from the command line; ``ArgumentTypeError`` for an empty one."""
    if not text:
        raise argparse.ArgumentTypeError("the name of a topic is not empty; leave the option out for all")
    return text


def _topic_pair(text: str) -> tuple[str, str]:
    a, separator, b = text.partition("=")
    if not (a and separator and b):
        raise argparse.ArgumentTypeError(f"two topics are paired as in /a=/b, not {text!r}")
    return a, b


def print_incident(recording: Path) -> None:
    """Print a line on the incident that a recording is; nothing for any other recording."""
    try:
        record = record_beside(recording)
    except RecordingError as error:
        print_notices([f"what happened is not known: {error}"])
        return
    if record is not None:
        write_lines([f"incident {incident_text(record)}", ""])


def print_tables(tables: Iterable[Table[Any]]) -> None:
    for number, table in enumerate(tables):
        if number:
            write_line()
        print_table(table)


def print_json(value: object) -> None:
    write_line(json_text(value))


class _FileText:
    """Standard output as a file that ``csv`` writes."""

    write = staticmethod(write_file_text)


class CsvPrinter:
    """Prints rows with the same keys, under one line of them."""

    def __init__(self) -> None:
        self._writer: csv.DictWriter[str] | None = None

    def print_rows(self, rows: Iterable[Mapping[str, object]]) -> None:
        for row in rows:
            if self._writer is None:
                self._writer = csv.DictWriter(_FileText(), fieldnames=list(row), lineterminator="\n")
                self._writer.writeheader()
            self._writer.writerow(row)


def print_notices(notices: Iterable[str]) -> None:
    """Print what was lost or odd on standard error, after what was printed."""
    for notice in notices:
        print_notice(notice)


def print_notice(notice: str) -> None:
    """Print a notice on standard error, after what was printed."""
    sys.stdout.flush()
    write_line(f"note: {notice}", sys.stderr)

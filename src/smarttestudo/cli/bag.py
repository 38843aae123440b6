# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag``: the content of recordings, how fast and how much, and one against another."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from smarttestudo.bags.bag_summary import BagSummary, RecordedTopicRow
from smarttestudo.bags.comparison import BagComparison, ComparisonRow, compare_bags
from smarttestudo.bags.incident_record import incident_subtitles
from smarttestudo.bags.topic_selection import is_selected, select_topics
from smarttestudo.cli import bag_figures
from smarttestudo.cli.bag_options import (
    add_map,
    add_pair,
    add_recordings,
    add_several,
    add_topics_and_form,
    print_tables,
    topic_mapping,
)
from smarttestudo.cli.commands import CommandParser, add_lazy
from smarttestudo.cli.output import Progress, write_line, write_lines
from smarttestudo.cli.recordings import Asked, RecordingCommand, each_recording, pairs_asked, recordings_asked
from smarttestudo.domain.record import column_types
from smarttestudo.domain.units import BYTES_PER_MB, NS_PER_S, counted, grouped
from smarttestudo.report import bag_tables, comparison_tables
from smarttestudo.report.table import Table

_TABLES: Mapping[str, tuple[str, Callable[[BagSummary], Table[Any]]]] = {
    "info": ("when a recording was made, and its topics with type, size and QoS", bag_tables.info_table),
    "rates": ("the rate and the jitter of each topic", bag_tables.rates_table),
    "bandwidth": ("the bandwidth of each topic, and the sum", bag_tables.bandwidth_table),
}

_LAZY = {
    "loss": "what the operator lost: errors, ages, crossings, images",
    "accuracy": "how far the operator's picture is off, at fixed rates and under your rules",
    "report": "one HTML file: rates, bandwidth, decisions, path and loss, for any browser and for paper",
}

_DRAWN = {"rates": bag_figures.Drawn.RATES, "bandwidth": bag_figures.Drawn.BANDWIDTH}


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Measure and compare recordings, one or many. Only `loss`, `accuracy` and `report` read payloads."
    )
    actions = parser.add_commands("actions")
    for name, (purpose, table) in _TABLES.items():
        action = actions.add_parser(name, help=purpose, description=f"Show {purpose}.")
        add_recordings(action)
        add_topics_and_form(action)
        if name == "rates":
            action.add_argument(
                "--latency",
                action="store_true",
                help="also the latency of each topic: receive time minus header.stamp "
                "(reads the beginning of every message)",
            )
        action.set_defaults(run=_run_summary, table=table, latency=False, figures=None)
        if name in _DRAWN:
            bag_figures.add_figures(action, _DRAWN[name])
        add_several(action)
    purpose = "the rates and the bandwidth of two recordings, and how much they differ"
    actions.add_parser("compare", help=purpose, fill=_add_compare_arguments)
    for name, purpose in _LAZY.items():
        add_lazy(actions, name, f"smarttestudo.cli.bag_{name}", purpose)


def _run_summary(arguments: argparse.Namespace) -> int:
    asked: Sequence[Asked] = recordings_asked(arguments)
    if arguments.figures is not None:
        asked = bag_figures.with_figures(asked, arguments.figures)
    summaries = _Summaries(arguments.table, arguments.topics, is_only=len(asked) == 1)
    code = each_recording(arguments, asked, summaries)
    summaries.require_topics()
    return code


class _Summaries(RecordingCommand[BagSummary]):
    """``info``, ``rates`` and ``bandwidth`` of recordings, and the sum of all."""

    table = "topics"
    is_named_by_text = True

    def __init__(
        self, table: Callable[[BagSummary], Table[Any]], patterns: Sequence[str], *, is_only: bool
    ) -> None:
        self._table = table
        self._patterns = patterns
        self._is_only = is_only
        self._names: list[str] = []
        self._topics: set[str] = set()
        self._messages = self._size_bytes = 0
        self._duration_s = 0.0

    @staticmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> BagSummary:
        return measured(arguments.bag, progress, with_latency=arguments.latency)

    def shown(self, result: BagSummary) -> BagSummary:
        """The topics that are asked for; of several recordings, not each need have one."""
        result = result.naming(self._patterns)
        if self._patterns and self._is_only:
            result = result.only(select_topics(self._patterns, result.statistics, place=result.name))
        elif self._patterns:
            self._names.append(result.name)
            self._topics.update(result.statistics)
            result = result.only([one for one in result.statistics if is_selected(one, self._patterns)])
        self._messages += result.total.messages
        self._size_bytes += result.total.size_bytes
        self._duration_s += result.span.duration_s
        return result

    def columns(self) -> Mapping[str, Any]:
        """The columns of a topic."""
        return {"bag": str, "recorded_at": datetime, **column_types(RecordedTopicRow)}

    def print_text(self, result: BagSummary) -> None:
        print_tables([self._table(result)])

    def rows(self, result: BagSummary) -> Iterator[Mapping[str, object]]:
        """The rows of the summary, with the time of the recording."""
        span = result.span
        recorded_at = (
            None if span.is_empty else datetime.fromtimestamp(span.start_ns // NS_PER_S, tz=timezone.utc)
        )
        return ({**row, "recorded_at": recorded_at} for row in result.rows())

    def finish(self, arguments: argparse.Namespace) -> None:
        if arguments.figures is not None:
            bag_figures.draw_pair(arguments, arguments.bag, None, mapping={}, folder=arguments.figures)

    def sum(self) -> str:
        return (
            f"{counted(self._messages, 'message')}, {grouped(self._size_bytes / BYTES_PER_MB, 1)} MB in "
            f"{grouped(self._duration_s, 1)} s of recording"
        )

    def require_topics(self) -> None:
        """Raise ``RecordingError`` for a pattern that names no topic of any recording that was read."""
        if self._names:
            first, *others = self._names
            place = f"{first} and {counted(len(others), 'other')}" if others else first
            select_topics(self._patterns, self._topics, place=place)


def measured(path: Path, progress: Progress, *, with_latency: bool = False) -> BagSummary:
    from smarttestudo.bags.measure import measure_bag  # noqa: PLC0415  needs packages a robot lacks

    with progress(f"Reading {path}") as report:
        return measure_bag(path, report, with_latency=with_latency)


def _add_compare_arguments(action: CommandParser) -> None:
    action.description = (
        "Show the rates and the bandwidth of two recordings, and how much they differ. With A's /odom pairs "
        "B's /testudo/odom or /odom_receive, else its /odom."
    )
    add_pair(action, a="the recording to compare with", b="the recording to compare")
    add_map(action)
    add_topics_and_form(action)
    bag_figures.add_figures(action, bag_figures.Drawn.BOTH)
    add_several(action)
    action.set_defaults(run=_run_compare)


def _run_compare(arguments: argparse.Namespace) -> int:
    """Compare and print; 1 if a recording could not be read."""
    topic_mapping(arguments.map)
    asked = pairs_asked(arguments)
    if arguments.figures is not None:
        asked = bag_figures.with_figures(asked, arguments.figures)
    return each_recording(arguments, asked, _Comparisons())


class _Comparisons(RecordingCommand[BagComparison]):
    """``compare`` of pairs of recordings."""

    table = "comparisons"
    is_named_by_text = True

    @staticmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> BagComparison:
        mapping = topic_mapping(arguments.map)
        a, b = (measured(one, progress).naming(arguments.topics) for one in (arguments.a, arguments.b))
        select_topics(tuple(mapping), a.statistics, place=a.name)
        select_topics(tuple(mapping.values()), b.statistics, place=b.name)
        compared = compare_bags(a, b, mapping)
        if not arguments.topics:
            return compared
        place = f"{a.name}, {b.name}"
        return compared.only(select_topics(arguments.topics, compared.names, place=place))

    def columns(self) -> Mapping[str, Any]:
        """The columns of a topic."""
        return column_types(ComparisonRow)

    def print_text(self, result: BagComparison) -> None:
        for letter, bag in (("A", result.a), ("B", result.b)):
            write_lines([f"{letter}: {bag.name}", *incident_subtitles(bag.incident)])
        write_line()
        names = comparison_tables.RunNames(before="A", after="B")
        builds = (comparison_tables.frequency_table, comparison_tables.bandwidth_table)
        print_tables([build(result.comparison, names) for build in builds])

    def finish(self, arguments: argparse.Namespace) -> None:
        if arguments.figures is not None:
            mapping = topic_mapping(arguments.map)
            bag_figures.draw_pair(
                arguments, arguments.a, arguments.b, mapping=mapping, folder=arguments.figures
            )

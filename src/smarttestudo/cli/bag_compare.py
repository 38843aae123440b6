# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag compare``: the rates and the bandwidth of two recordings beside each other."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any

from smarttestudo.bags.bag_comparison import BagComparison, ComparisonRow, compare_bags
from smarttestudo.bags.incident_mark import incident_subtitles
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.cli import bag_figures
from smarttestudo.cli.bag import measured
from smarttestudo.cli.bag_options import add_map, add_topics_and_form, print_tables, topic_mapping
from smarttestudo.cli.command_parser import CommandParser
from smarttestudo.cli.output import write_line, write_lines
from smarttestudo.cli.progress import Progress
from smarttestudo.cli.recording_options import add_pair, add_several
from smarttestudo.cli.recordings import RecordingCommand, each_recording, pairs_asked
from smarttestudo.domain.record import column_types
from smarttestudo.report import comparison_tables
from smarttestudo.report.table import Table


def add_arguments(action: CommandParser) -> None:
    action.description = (
        "Show the rates and the bandwidth of two recordings, and how much they differ. With A's /odom pairs "
        "B's /testudo/odom or /odom_receive, else its /odom."
    )
    add_pair(action, a="the recording to compare with", b="the recording to compare")
    add_map(action)
    add_topics_and_form(action)
    bag_figures.add_figures(action, bag_figures.Drawn.BOTH)
    add_several(action)
    action.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
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
        a, b = measured(arguments.a, progress), measured(arguments.b, progress)
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
        print_tables(_compare_tables(result))

    def finish(self, arguments: argparse.Namespace) -> None:
        if arguments.figures is not None:
            mapping = topic_mapping(arguments.map)
            bag_figures.draw_pair(
                arguments, arguments.a, arguments.b, mapping=mapping, folder=arguments.figures
            )


def _compare_tables(compared: BagComparison) -> list[Table[Any]]:
    names = comparison_tables.RunNames(before="A", after="B")
    tables = (comparison_tables.frequency_table, comparison_tables.bandwidth_table)
    return [build(compared.comparison, names) for build in tables]

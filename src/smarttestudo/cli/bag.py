# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag``: what is in recordings, how fast and how much, and one against another."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.bags.bag_comparison import BagComparison, compare_bags
from smarttestudo.bags.incident_mark import incident_subtitle
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.cli import bag_figures
from smarttestudo.cli.bag_options import (
    add_map,
    add_topics_and_form,
    print_csv,
    print_json,
    print_notices,
    print_tables,
    topic_mapping,
)
from smarttestudo.cli.command_parser import CommandParser, add_lazy
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.progress import progress
from smarttestudo.files.outputs import require_separate
from smarttestudo.report import bag_tables, comparison_tables
from smarttestudo.report.table import Table

if TYPE_CHECKING:
    from smarttestudo.bags.bag_summary import BagSummary
    from smarttestudo.cli.command_parser import Subcommands

_TABLES: Mapping[str, tuple[str, Callable[[BagSummary], Table]]] = {
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
    """Add the arguments of ``testudo bag``."""
    parser.description = "Measure and compare recordings. Only `loss`, `accuracy` and `report` read payloads."
    actions = parser.add_commands("actions")
    for name, (purpose, table) in _TABLES.items():
        action = actions.add_parser(name, help=purpose, description=f"Show {purpose}.")
        action.add_argument(
            "bags", metavar="BAG", nargs="+", type=file_path, help="a rosbag2 folder, a .db3 or an .mcap file"
        )
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
    _add_compare(actions)
    for name, purpose in _LAZY.items():
        add_lazy(actions, name, f"smarttestudo.cli.bag_{name}", purpose)


def _add_compare(actions: Subcommands) -> None:
    purpose = "the rates and the bandwidth of two recordings, and how much they differ"
    action = actions.add_parser(
        "compare",
        help=purpose,
        description=f"Show {purpose}. With A's /odom pairs B's /testudo/odom or /odom_receive, "
        "else its /odom.",
    )
    action.add_argument("a", metavar="A", type=file_path, help="the recording to compare with")
    action.add_argument("b", metavar="B", type=file_path, help="the recording to compare")
    add_map(action)
    add_topics_and_form(action)
    bag_figures.add_figures(action, bag_figures.Drawn.BOTH)
    action.set_defaults(run=_run_compare)


def _run_summary(arguments: argparse.Namespace) -> int:
    bag_figures.require_separate_figures(arguments.figures, arguments.bags)
    summaries = [_measure(path, with_latency=arguments.latency) for path in arguments.bags]
    if arguments.topics:
        known = {topic.name for summary in summaries for topic in summary.topics}
        place = ", ".join(summary.name for summary in summaries)
        chosen = select_topics(arguments.topics, known, place=place)
        summaries = [summary.only(chosen) for summary in summaries]
    if arguments.json:
        objects = [summary.to_json() for summary in summaries]
        print_json(objects[0] if len(objects) == 1 else {"bags": objects})
    elif arguments.csv:
        print_csv(row for summary in summaries for row in summary.rows())
    else:
        print_tables([arguments.table(summary) for summary in summaries])
    print_notices(notice for summary in summaries for notice in summary.notices)
    if arguments.figures is not None:
        bag_figures.draw_each(arguments)
    return 0


def _run_compare(arguments: argparse.Namespace) -> int:
    mapping = topic_mapping(arguments.map)
    if arguments.figures is not None:
        bags = (arguments.a, arguments.b)
        require_separate({"--figures": bag_figures.figure_files(arguments.figures)}, bags)
    a, b = _measure(arguments.a), _measure(arguments.b)
    select_topics(tuple(mapping), a.statistics, place=a.name)
    select_topics(tuple(mapping.values()), b.statistics, place=b.name)
    compared = compare_bags(a, b, mapping)
    if arguments.topics:
        place = f"{a.name}, {b.name}"
        compared = compared.only(select_topics(arguments.topics, compared.names, place=place))
    if arguments.json:
        print_json(compared.to_json())
    elif arguments.csv:
        print_csv(compared.rows())
    else:
        for letter, bag in (("A", a), ("B", b)):
            print(f"{letter}: {bag.name}{incident_subtitle(bag.incident)}")  # noqa: T201
        print()  # noqa: T201
        print_tables(_compare_tables(compared))
    print_notices((*a.notices, *b.notices))
    if arguments.figures is not None:
        bag_figures.draw_pair(arguments, arguments.a, arguments.b, mapping=mapping, folder=arguments.figures)
    return 0


def _compare_tables(compared: BagComparison) -> list[Table]:
    names = comparison_tables.RunNames(before="A", after="B")
    tables = (comparison_tables.frequency_table, comparison_tables.bandwidth_table)
    return [build(compared.comparison, names) for build in tables]


def _measure(path: Path, *, with_latency: bool = False) -> BagSummary:
    from smarttestudo.bags.measure import measure_bag  # noqa: PLC0415  needs packages a robot lacks

    with progress(f"Reading {path}") as report:
        return measure_bag(path, report, with_latency=with_latency)

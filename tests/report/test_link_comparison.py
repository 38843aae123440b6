# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the demo over a link prints of its contenders."""

from __future__ import annotations

from pathlib import Path

from report.golden_files import assert_reads_as
from smarttestudo.demo.link_side import zenoh_priorities
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.report.link_comparison import (
    LinkArrivals,
    TopicArrivals,
    arrival_ages_table,
    arrival_rates_table,
)
from smarttestudo.report.table import plain_table

GOLDEN = Path(__file__).parent / "golden"
ODOM = TopicArrivals(published_hz=25.5, received_hz=10.0, ages_s=[0.01 * age for age in range(1, 101)])
NONE = TopicArrivals(published_hz=28.0, received_hz=0.0, ages_s=[])
ARRIVALS = (
    LinkArrivals(name="SmartTestudo", used=0.931, topics={"/odom": ODOM, "/image": NONE}),
    LinkArrivals(name="Zenoh", used=0.98, topics={"/odom": ODOM}),
)


def test_the_tables_read_as_in_the_golden_file() -> None:
    """The ages are the median, the 95th percentile and the greatest."""
    tables = (arrival_rates_table(ARRIVALS), arrival_ages_table(ARRIVALS))
    assert_reads_as(GOLDEN / "link-comparison.txt", "\n\n".join(map(plain_table, tables)) + "\n")


def test_zenoh_s_priorities_are_in_the_order_of_the_profile() -> None:
    priorities = {"/odom": 5.0, "/scan": 4.0, "/tf": 5.0, **{f"/t{number}": -number for number in range(9)}}
    profile = Profile(topics={topic: TopicProfile(priority=one) for topic, one in priorities.items()})
    classes = zenoh_priorities(list(priorities), profile)
    assert classes["/odom"] == classes["/tf"] == "INTERACTIVE_HIGH"
    assert classes["/scan"] == "INTERACTIVE_LOW"
    assert classes["/t8"] == "BACKGROUND"

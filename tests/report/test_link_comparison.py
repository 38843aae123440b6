# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the demo over a link prints of its contenders."""

from __future__ import annotations

from smarttestudo.demo.link_side import zenoh_priorities
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.report.link_comparison import (
    LinkArrivals,
    TopicArrivals,
    arrival_ages_table,
    arrival_rates_table,
)
from smarttestudo.report.table import plain_table

ODOM = TopicArrivals(published_hz=25.5, received_hz=10.0, ages_s=[0.01 * age for age in range(1, 101)])
NONE = TopicArrivals(published_hz=28.0, received_hz=0.0, ages_s=[])
ARRIVALS = (
    LinkArrivals(name="SmartTestudo", used=0.931, topics={"/odom": ODOM, "/image": NONE}),
    LinkArrivals(name="Zenoh", used=0.98, topics={"/odom": ODOM}),
)


def lines(text: str) -> list[list[str]]:
    return [line.split() for line in text.splitlines() if line and "─" not in line]


def test_rates_are_beside_each_other_and_the_share_of_the_link_below() -> None:
    assert lines(plain_table(arrival_rates_table(ARRIVALS))) == [
        ["Rate", "at", "the", "operator"],
        ["Topic", "Published", "SmartTestudo", "Zenoh"],
        ["Hz", "Hz", "Hz"],
        ["/image", "28.00", "0.00", "–"],
        ["/odom", "25.50", "10.00", "10.00"],
        ["Share", "of", "the", "link", "used", "–", "93%", "98%"],
    ]


def test_ages_are_the_median_the_95th_percentile_and_the_greatest() -> None:
    assert lines(plain_table(arrival_ages_table(ARRIVALS)))[3:5] == [
        ["/image", "–", "–"],
        ["/odom", "0.51", "0.96", "1.00", "0.51", "0.96", "1.00"],
    ]


def test_zenoh_s_priorities_are_in_the_order_of_the_profile() -> None:
    priorities = {"/odom": 5.0, "/scan": 4.0, "/tf": 5.0, **{f"/t{number}": -number for number in range(9)}}
    profile = Profile(topics={topic: TopicProfile(priority=one) for topic, one in priorities.items()})
    classes = zenoh_priorities(list(priorities), profile)
    assert classes["/odom"] == classes["/tf"] == "INTERACTIVE_HIGH"
    assert classes["/scan"] == "INTERACTIVE_LOW"
    assert classes["/t8"] == "BACKGROUND"

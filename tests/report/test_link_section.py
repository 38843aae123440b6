# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a report says of the link, from the statuses that a robot sent over it."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from report.demo_like_report import demo_like_report
from report.golden_files import assert_reads_as, page_lines
from report.test_report import GOLDEN, LARGEST_BYTES, bare_report
from robot.status.statuses import RELAYED, STATUS
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.link import LinkState, StreamCounts, TopicOnLink
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.record import to_json
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.report.document import render_report
from smarttestudo.report.link import (
    MAX_TOPICS,
    LinkHistoryBuilder,
    age_charts,
    has_statuses,
    link_chart,
    link_history,
    link_table,
)
from smarttestudo.report.run_report import LinkHistory
from smarttestudo.report.table import plain_table
from smarttestudo.report.time_chart import Run

START_NS = 1_767_600_000 * NS_PER_S


def status(
    ages_ms: dict[str, float | None], sent: int = 0, *, link: LinkState | None = None, hz: float = 1.0
) -> RuntimeStatus:
    counts = StreamCounts(sent=sent, replaced=sent // 4, overflowed=sent // 20)
    return replace(
        STATUS,
        status_hz=hz,
        budget_kb_per_s=200.0,
        link=link or LinkState(is_connected=True, capacity_kb_per_s=250.0, round_trip_ms=3.0),
        topics={
            topic: replace(RELAYED, on_link=TopicOnLink(counts=counts, age_ms=age_ms))
            for topic, age_ms in ages_ms.items()
        },
    )


def told(statuses: Iterable[tuple[float, RuntimeStatus]]) -> LinkHistory:
    builder = LinkHistoryBuilder(START_NS)
    for t_s, one in statuses:
        builder.on_status(START_NS + round(t_s * NS_PER_S), one)
    history = builder.history()
    assert history is not None
    return history


def restarted() -> LinkHistory:
    """The link of a robot that was started again, and then counts from 0."""
    return told(
        [
            (1, status({"/odom": 30.0, "/imu": None, "/<b>": 700.0}, 5)),
            (2, status({"/odom": 90.0, "/imu": None, "/<b>": 700.0}, 20)),
            (3, status({"/odom": 10.0}, 5)),
        ]
    )


def test_ages_are_as_told_and_counts_go_on_through_a_restart() -> None:
    _, imu, odom = restarted().topics
    assert odom.sorted_ages_ms == (10.0, 30.0, 90.0)
    # What the robot had sent before the first status is in no recording that begins with it.
    assert imu.counts == StreamCounts(sent=15, replaced=4, overflowed=1)
    assert odom.counts == StreamCounts(sent=20, replaced=5, overflowed=1)


def test_a_topic_of_which_nothing_more_is_sent_is_counted_once() -> None:
    (odom,) = told((t_s, status({"/odom": 1.0}, sent)) for t_s, sent in ((1, 20), (2, 60), (3, 60))).topics
    assert odom.counts == StreamCounts(sent=40, replaced=10, overflowed=2)


def test_the_page_of_a_link_reads_as_in_the_golden_file() -> None:
    assert_reads_as(GOLDEN / "page-link.html", page_lines(render_report(bare_report(link=restarted()))))


def test_an_outage_is_where_no_status_arrived_or_one_said_so() -> None:
    gone = LinkState(is_connected=False, capacity_kb_per_s=250.0, outages=1)
    back = LinkState(is_connected=True, capacity_kb_per_s=100.0, outages=1)
    history = told(
        [
            *((t_s, status({})) for t_s in (0, 1, 2)),
            *((t_s, status({}, link=back)) for t_s in (12, 13)),
            (14, status({}, link=gone)),
            (15, status({}, link=back)),
        ]
    )
    assert history.silences == ((2.0, 12.0), (14.0, 15.0))
    assert history.outages == 1
    chart = link_chart(history, (), 20.0)
    assert [(span.start_s, span.end_s) for span in chart.tints] == [(2.0, 12.0), (14.0, 15.0)]
    assert [line.run for line in chart.lines] == [Run.BEFORE, Run.BUDGET]
    assert [point.mean for point in chart.lines[0].points] == [250, 250, 250, 100, 100, 250, 100]


def test_outages_before_the_recording_are_not_counted() -> None:
    def after(outages: int) -> RuntimeStatus:
        return status({}, link=LinkState(is_connected=True, outages=outages))

    assert told([(1, after(7)), (2, after(7))]).outages == 0
    # The robot is started again after two of them, and counts from 0.
    assert told([(1, after(7)), (2, after(9)), (3, after(0)), (4, after(1))]).outages == 3


def test_a_status_once_a_minute_is_no_outage() -> None:
    assert told((60 * number, status({}, hz=1 / 60)) for number in range(4)).silences == ()


@given(st.lists(st.floats() | st.integers(-5, 10**30), max_size=8))
def test_numbers_of_a_stranger_leave_a_chart_that_can_be_drawn(values: list[float]) -> None:
    history = told(
        (
            number,
            status(
                {"/odom": value},
                int(value) if math.isfinite(value) else 0,
                link=LinkState(is_connected=True, capacity_kb_per_s=value, outages=10**30),
            ),
        )
        for number, value in enumerate([*values, 1.0])
    )
    for chart in (link_chart(history, (), 10.0), *age_charts(history, 10.0)):
        assert 0 < chart.top < math.inf
    assert plain_table(link_table(history))


@pytest.mark.full
def test_a_long_recording_with_many_topics_stays_bounded() -> None:
    names = [f"/t{number}" for number in range(MAX_TOPICS + 50)]
    many = [(float(number), status(dict.fromkeys(names, 5.0), number)) for number in range(30)]
    long = [(float(number), status({"/t0": number % 100}, number)) for number in range(30, 60_000)]
    history = told([*many, *long])
    assert len(history.topics) == MAX_TOPICS
    assert len(history.capacity) <= 2000
    assert history.topics[0].sorted_ages_ms[-1] > 95
    report = replace(demo_like_report(), link=history, duration_s=60_000.0)
    assert len(render_report(report)) < LARGEST_BYTES


def text(said: str) -> bytes:
    data = said.encode() + b"\0"
    return b"\x00\x01\x00\x00" + struct.pack("<I", len(data)) + data


@pytest.mark.parametrize("type_name", ["std_msgs/msg/String", "std_msgs/msg/UInt8"])
def test_statuses_are_read_from_a_recording_and_those_that_are_none_are_counted(
    tmp_path: Path, type_name: str
) -> None:
    channel = Channel(topic=STATUS_TOPIC, type_name=type_name)
    said = [json.dumps(to_json(status({"/odom": 20.0}, 4))), "{}", "no JSON"]
    with create_recording(tmp_path / "bag") as recording:
        for number, one in enumerate(said):
            recording.write(channel, START_NS + number * NS_PER_S, text(one))
    is_text = type_name.endswith("String")
    assert has_statuses([channel]) is is_text
    history, notices = link_history(tmp_path / "bag", START_NS, lambda _share: None)
    if not is_text:
        assert (history, notices) == (None, ())
        return
    assert history is not None
    assert [topic.topic for topic in history.topics] == ["/odom"]
    assert notices == ("2 messages on /testudo/status could not be understood",)

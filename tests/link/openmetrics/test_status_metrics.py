# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a status is in metrics: names and units of Prometheus, all in base units."""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import replace

import pytest

from robot.status.statuses import RELAYED, STATUS
from smarttestudo.domain.link import LinkState, StreamCounts, TopicOnLink
from smarttestudo.domain.metric import MetricKind, MetricName
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.link.openmetrics.run_metrics import DECISIONS, RunMetrics
from smarttestudo.link.openmetrics.status import STATUS_METRICS, status_metrics
from smarttestudo.link.receive.reception_metrics import RECEPTION_METRICS

UNITS = {"seconds", "bytes", "bytes_per_second", "hertz", "ratio"}
COUNTED = {"messages", "chunks", "events", "statuses", "topics", "outages", "decisions", "incidents"}
ALL = (*STATUS_METRICS, *RECEPTION_METRICS, DECISIONS)
ON_LINK = TopicOnLink(
    counts=StreamCounts(sent=480, replaced=20, overflowed=3, queued_bytes=1200), age_ms=41.25
)
LINKED = replace(
    STATUS,
    link=LinkState(is_connected=True, capacity_kb_per_s=231.5, round_trip_ms=24.0, outages=2),
    topics={"/imu": replace(RELAYED, on_link=ON_LINK), "/estop": STATUS.topics["/estop"]},
)


def numbers(status: RuntimeStatus = LINKED) -> dict[tuple[str, ...], float]:
    found: dict[tuple[str, ...], float] = {}
    for metric in status_metrics({"ada": status}):
        assert {len(labels) for labels, _ in metric.samples} <= {len(metric.name.labels)}
        found |= {(metric.name.sample_name, *labels): number for labels, number in metric.samples}
    return found


@pytest.mark.parametrize("name", ALL, ids=lambda name: name.sample_name)
def test_each_metric_has_a_help_and_a_unit_by_the_rules_of_prometheus(name: MetricName) -> None:
    assert re.fullmatch(r"testudo(_[a-z]+\d*)*", name.sample_name)
    assert re.fullmatch(r"[^.]+[.]", name.help)
    is_state = name.help.startswith("1 ") or name.help.startswith("0 ")
    if name.kind is MetricKind.INFO:
        assert name.unit == ""
    elif is_state:
        assert (name.unit, name.kind) == ("", MetricKind.GAUGE)
    else:
        assert name.unit in UNITS | COUNTED


def test_no_two_metrics_have_one_name() -> None:
    assert [name for name, count in Counter(name.sample_name for name in ALL).items() if count > 1] == []


def test_numbers_are_in_base_units() -> None:
    found = numbers()
    expected = {
        ("testudo_budget_bytes_per_second", "ada"): 1_000_000.0,
        ("testudo_memory_bytes", "ada"): 71.3e6,
        ("testudo_cpu_ratio", "ada"): 0.042,
        ("testudo_link_connected", "ada"): 1.0,
        ("testudo_link_capacity_bytes_per_second", "ada"): 231_500.0,
        ("testudo_link_round_trip_seconds", "ada"): 0.024,
        ("testudo_link_outages_total", "ada"): 2.0,
        ("testudo_rules_info", "ada", "/smarttestudo", "ab" * 32, "waiting"): 1.0,
        ("testudo_topic_target_hertz", "ada", "/imu"): 50.0,
        ("testudo_topic_output_bytes_per_second", "ada", "/imu"): 16_000.0,
        ("testudo_topic_dropped_messages", "ada", "/imu"): 1450.0,
        ("testudo_topic_link_age_seconds", "ada", "/imu"): 0.04125,
        ("testudo_topic_link_replaced_messages_total", "ada", "/imu"): 20.0,
        ("testudo_topic_link_overflowed_messages_total", "ada", "/imu"): 3.0,
        ("testudo_topic_link_queued_bytes", "ada", "/imu"): 1200.0,
        ("testudo_topic_silent", "ada", "/estop", "no publisher"): 1.0,
    }
    assert {key: found[key] for key in expected} == pytest.approx(expected)


def test_lost_messages_are_counted_where_they_are_numbered() -> None:
    imu = STATUS.topics["/imu"]
    lost = replace(STATUS, topics={"/imu": replace(imu, counts=replace(imu.counts, lost=12))})
    name = "testudo_topic_lost_messages_total"
    assert {key: number for key, number in numbers(lost).items() if key[0] == name} == {
        (name, "ada", "/imu"): 12.0
    }
    assert {key for key in numbers(STATUS) if key[0] == name} == set()


def test_full_is_infinite_and_what_is_not_known_has_no_number() -> None:
    found = numbers()
    assert found["testudo_topic_target_hertz", "ada", "/estop"] == math.inf
    assert ("testudo_topic_actual_hertz", "ada", "/estop") not in found
    assert {key[0] for key in numbers(STATUS) if "link" in key[0]} == set()


def test_a_run_has_its_decisions_before_it_has_a_status() -> None:
    metrics = RunMetrics("ada")
    assert [(metric.name, metric.samples) for metric in metrics.metrics()] == [(DECISIONS, [(("ada",), 0.0)])]
    metrics.on_status(LINKED)
    assert {metric.name for metric in metrics.metrics()} == {DECISIONS, *STATUS_METRICS}

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What Prometheus gets at the operator's end, whatever robots send there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.receive.test_reception import MS, message, presence, steady
from link.zenoh.ends import ODOM
from robot.status.statuses import RELAYED, STATUS
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.link import ReceivedMessage
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.record import to_json
from smarttestudo.domain.status import TopicCounts
from smarttestudo.link.protocol.keys import Boot
from smarttestudo.link.protocol.receiver import ReceiverCounts
from smarttestudo.link.receive.reception import Reception
from smarttestudo.link.receive.reception_metrics import MAX_TOPICS, ReceptionMetrics, StatusSink
from smarttestudo.link.zenoh.arrivals import StreamSaid
from smarttestudo.pacing.cdr import string_message

STATUSES = replace(ODOM, topic=STATUS_TOPIC, type_name="std_msgs/msg/String")


class End:
    """An operator's end that counted so much."""

    unknown = 3
    dropped = 1

    def counts(self) -> dict[Boot, ReceiverCounts]:
        first, second = Boot("ada", "0" * 16), Boot("ada", "1" * 16)
        return {first: ReceiverCounts(messages=5, malformed=1), second: ReceiverCounts(messages=2)}


def status_message(text: str, robot: str = "ada") -> ReceivedMessage:
    payload = string_message(text)
    return ReceivedMessage(robot=robot, stream=STATUSES, payload=payload, offered_ns=1, age_ns=None)


def numbers(reception: Reception, statuses: StatusSink) -> dict[tuple[str, ...], float]:
    metrics = ReceptionMetrics(statuses)
    assert metrics.metrics() == []
    end: Any = End()
    metrics.update(reception, end)
    return {
        (metric.name.sample_name, *labels): number
        for metric in metrics.metrics()
        for labels, number in metric.samples
    }


def test_rates_ages_bytes_presence_and_what_went_wrong_are_there() -> None:
    reception, statuses = Reception([]), StatusSink(STATUS_TOPIC)
    reception.handle(presence(), 0)
    reception.handle(presence("bob", is_present=False), 0)
    steady(reception, hz=20, seconds=5)
    reception.handle(message(age_ns=35 * MS, size_bytes=1000), 5_000_000_000)
    found = numbers(reception, statuses)
    expected = {
        ("connected", "ada"): 1.0,
        ("connected", "bob"): 0.0,
        ("topic_hertz", "ada", "/odom"): 20.0,
        ("topic_bytes_per_second", "ada", "/odom"): 20_000.0,
        ("topic_age_seconds", "ada", "/odom"): 0.035,
        ("topic_messages_total", "ada", "/odom"): 102.0,
        ("topic_bytes_total", "ada", "/odom"): 102_000.0,
        ("delivered_messages_total", "ada"): 7.0,
        ("garbage_chunks_total", "ada"): 1.0,
        ("stray_chunks_total",): 3.0,
        ("dropped_events_total",): 1.0,
        ("unreadable_statuses_total",): 0.0,
        ("left_out_topics",): 0.0,
    }
    named = {(f"testudo_receive_{name}", *labels): number for (name, *labels), number in expected.items()}
    assert {key: found[key] for key in named} == pytest.approx(named)


def test_the_counts_of_a_robot_that_is_away_stay() -> None:
    metrics, reception = ReceptionMetrics(StatusSink(STATUS_TOPIC)), Reception([])
    before: Any = End()
    away: Any = End()
    away.counts = dict
    metrics.update(reception, before)
    metrics.update(reception, away)
    found = {metric.name.sample_name: metric.samples for metric in metrics.metrics()}
    assert found["testudo_receive_delivered_messages_total"] == [(("ada",), 7.0)]


def test_a_robots_own_status_is_told_under_the_names_that_it_has_there() -> None:
    statuses = StatusSink(STATUS_TOPIC)
    reception = Reception([statuses])
    reception.handle(presence(), 0)
    reception.handle(status_message("{"), 0)
    reception.handle(status_message(json_text(to_json(STATUS))), 0)
    reception.handle(message(), 0)
    found = numbers(reception, statuses)
    assert found["testudo_topic_target_hertz", "ada", "/imu"] == 50.0
    assert found["testudo_receive_unreadable_statuses_total",] == 0.0


def test_a_status_is_told_while_the_run_that_said_it_is_connected() -> None:
    statuses = StatusSink(STATUS_TOPIC)
    reception = Reception([statuses])

    def is_told() -> bool:
        return ("testudo_topic_target_hertz", "ada", "/imu") in numbers(reception, statuses)

    reception.handle(presence(), 0)
    reception.handle(StreamSaid(robot="ada", boot="0", number=1, info=STATUSES), 0)
    reception.handle(status_message(json_text(to_json(STATUS))), 0)
    assert is_told()
    reception.handle(presence(is_present=False), 0)
    assert not is_told()
    reception.handle(presence(), 0)
    assert is_told()
    reception.handle(presence(is_present=False), 0)
    reception.handle(presence(boot="1"), 0)
    assert not is_told()
    reception.handle(status_message(json_text(to_json(STATUS))), 0)
    assert is_told()


@pytest.mark.parametrize(
    "status",
    [
        replace(STATUS, node="/a b"),
        replace(STATUS, rules=replace(STATUS.rules, sha256="ab" * 100)),
        replace(STATUS, topics={"/a\ud800": RELAYED}),
        replace(STATUS, topics={"/imu": replace(RELAYED, counts=TopicCounts(received=10**400))}),
    ],
)
def test_a_status_that_no_robot_has_costs_itself_and_is_counted(status: Any) -> None:
    statuses = StatusSink(STATUS_TOPIC)
    statuses.write(status_message(json_text(to_json(STATUS))))
    assert statuses.statuses() == {"ada": STATUS}
    statuses.write(status_message(json_text(to_json(status))))
    assert statuses.statuses() == {"ada": STATUS}
    assert statuses.unreadable == 1


@given(st.binary(max_size=200))
def test_any_bytes_as_a_status_are_taken(payload: bytes) -> None:
    statuses = StatusSink(STATUS_TOPIC)
    statuses.write(replace(status_message(""), payload=payload))
    assert (statuses.statuses(), statuses.unreadable) == ({}, 1)


def test_topics_beyond_what_is_reasonable_have_no_metrics_and_are_counted() -> None:
    reception = Reception([])
    for number in range(MAX_TOPICS + 5):
        reception.handle(message(replace(ODOM, topic=f"/t{number}")), 0)
    found = numbers(reception, StatusSink(STATUS_TOPIC))
    assert sum(key[0] == "testudo_receive_topic_messages_total" for key in found) == MAX_TOPICS
    assert found["testudo_receive_left_out_topics",] == 5.0

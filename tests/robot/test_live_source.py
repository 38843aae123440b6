# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is offered to operators follows from what the publishers have in common."""

from __future__ import annotations

from smarttestudo.domain.robot import Endpoint, Qos
from smarttestudo.robot.source import LiveSource, live_source, suits

IMU = "sensor_msgs/msg/Imu"


def endpoint(*, type_name: str = IMU, reliable: bool = True, transient_local: bool = False) -> Endpoint:
    return Endpoint(node="/driver", type_name=type_name, reliable=reliable, transient_local=transient_local)


def source_of(*endpoints: Endpoint, before: LiveSource | None = None) -> LiveSource:
    source = live_source(endpoints, before)
    assert source is not None
    return source


def test_a_topic_that_nobody_ever_published_is_no_source() -> None:
    assert live_source([], None) is None


def test_one_best_effort_publisher_makes_the_output_best_effort() -> None:
    assert source_of(endpoint(), endpoint()).qos.reliable
    assert not source_of(endpoint(), endpoint(reliable=False)).qos.reliable


def test_one_volatile_publisher_makes_the_output_volatile() -> None:
    latched = endpoint(transient_local=True)
    assert source_of(latched, latched).qos.transient_local
    assert not source_of(latched, endpoint()).qos.transient_local


def test_a_latched_output_holds_two_messages_of_each_publisher_and_at_least_ten() -> None:
    latched = endpoint(transient_local=True)
    assert source_of(latched).qos.depth == 10
    assert source_of(*[latched] * 7).qos.depth == 14
    assert source_of(*[endpoint()] * 7).qos.depth == 10


def test_a_subscription_has_room_for_all_that_several_publishers_latched() -> None:
    latched = endpoint(transient_local=True)
    assert source_of(latched, latched).subscription_qos == Qos(reliable=True, transient_local=True, depth=100)
    assert source_of(*[latched] * 70).subscription_qos.depth == 140
    assert source_of(endpoint()).subscription_qos == source_of(endpoint()).qos


def test_a_source_without_publishers_stays_what_it_was() -> None:
    before = source_of(endpoint(reliable=False))
    gone = source_of(before=before)
    assert gone.publishers == 0
    assert suits(before, gone)
    assert suits(gone, source_of(endpoint(reliable=False), before=gone))


def test_a_second_type_does_not_displace_the_first() -> None:
    before = source_of(endpoint())
    both = source_of(endpoint(type_name="a_msgs/msg/A"), endpoint(), before=before)
    assert (both.type_name, both.publishers, both.other_types) == (IMU, 1, ("a_msgs/msg/A",))
    after = source_of(endpoint(type_name="a_msgs/msg/A"), before=both)
    assert after.type_name == "a_msgs/msg/A"
    assert not suits(both, after)


def test_fewer_publishers_do_not_cost_late_subscribers_what_is_held() -> None:
    latched = endpoint(transient_local=True)
    many, one = source_of(*[latched] * 7), source_of(latched)
    assert suits(many, one)
    assert not suits(one, many)
    assert one.qos == Qos(reliable=True, transient_local=True, depth=10)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the loop decides, told as small stories."""

from __future__ import annotations

import math

from loop.loop_driver import MS, ODOMETRY, SECOND, LoopDriver, odometry
from smarttestudo.domain.observation import Undecodable
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.signal import Signal
from smarttestudo.loop.inputs import MessageInput, WakeInput

WAREHOUSE = """
begin
SetFrequency /odom 10
SetFrequency /cmd_vel 7
SetFrequency /scan 3
SetFrequency /camera/image_raw/compressed 3
SetFrequency /imu 10
// Warehouse Corridor
If(CheckValue /odom pose_y > 1 AND CheckValue /odom pose_y < 5.4
AND CheckValue /odom pose_x < 6 AND CheckValue /odom pose_x > -13)Then
    SetFrequency /odom 4
    SetFrequency /cmd_vel 4
    SetFrequency /scan 4
// Scaffolding
If(CheckValue /odom pose_y > 6 AND CheckValue /odom pose_y < 25.5
AND CheckValue /odom pose_x < 6 AND CheckValue /odom pose_x > -13)Then
    SetFrequency /odom 10
    SetFrequency /cmd_vel 10
    SetFrequency /scan 10
    SetFrequency /camera/image_raw/compressed 10
end
"""
ZONE = """
begin
SetFrequency /scan 2
Rule "zone" If CheckValue /odom pose_x > 5 Then SetFrequency /scan 8 EndIf
end
"""


def test_a_robot_that_just_started_is_monitored_for_the_worst_case_until_odometry_says_where_it_is() -> None:
    driver = LoopDriver(WAREHOUSE)
    assert driver.rates() == {
        "/odom": 10,
        "/cmd_vel": 10,
        "/scan": 10,
        "/camera/image_raw/compressed": 10,
        "/imu": 10,
    }
    assert [(one.topic, one.planned.reason.value, one.planned.rule) for one in driver.decisions] == [
        ("/odom", "default", None),
        ("/cmd_vel", "unknown", "Scaffolding"),
        ("/scan", "unknown", "Scaffolding"),
        ("/camera/image_raw/compressed", "unknown", "Scaffolding"),
        ("/imu", "default", None),
    ]
    assert driver.decisions[1].values == {"/odom pose_x": None, "/odom pose_y": None}
    assert all(one.from_rate is None for one in driver.decisions)

    driver.decisions.clear()
    driver.drive(100 * MS, 0.0, 0.0)
    driver.wait_until(600 * MS - 1)
    assert driver.decisions == []
    driver.wait_until(600 * MS)
    assert driver.log() == [
        (0.6, "/cmd_vel", 7, "default", None),
        (0.6, "/scan", 3, "default", None),
        (0.6, "/camera/image_raw/compressed", 3, "default", None),
    ]
    assert driver.rates() == {
        "/odom": 10,
        "/cmd_vel": 7,
        "/scan": 3,
        "/camera/image_raw/compressed": 3,
        "/imu": 10,
    }


def test_a_decision_names_the_block_its_line_and_what_it_read() -> None:
    driver = LoopDriver(WAREHOUSE)
    driver.drive(0, 0.0, 0.0)
    driver.wait_until(SECOND)
    driver.decisions.clear()
    driver.drive(2 * SECOND, 2.1, 3.0)
    scan = next(one for one in driver.decisions if one.topic == "/scan")
    assert scan.to_json() == {
        "t": 2.0,
        "stamp_ns": 2 * SECOND,
        "topic": "/scan",
        "from_hz": 3.0,
        "to_hz": 4.0,
        "reason": "block",
        "rule": "Warehouse Corridor",
        "line": 9,
        "values": {"/odom pose_x": 2.1, "/odom pose_y": 3.0},
    }


def test_a_robot_on_the_edge_of_a_zone_neither_flickers_nor_floods_the_log() -> None:
    driver = LoopDriver(ZONE)
    driver.drive(0, 0.0, 0.0)
    driver.wait_until(SECOND)
    driver.decisions.clear()
    for step in range(100):
        driver.drive(SECOND + step * 100 * MS, 5.0 + 0.01 * (-1) ** step, 0.0)
    assert driver.log() == [(1.0, "/scan", 8, "block", "zone")]
    driver.wait_until(20 * SECOND)
    assert driver.log()[1] == (10.9 + 0.5, "/scan", 2, "default", None)


def test_a_settle_time_of_zero_lowers_at_once() -> None:
    driver = LoopDriver(ZONE, Profile(settle_s=0.0))
    driver.drive(SECOND, 6.0, 0.0)
    driver.drive(2 * SECOND, 4.0, 0.0)
    assert driver.log()[-1] == (2.0, "/scan", 2, "default", None)


def test_odometry_that_falls_silent_makes_its_zone_unknown_and_the_rate_rises() -> None:
    driver = LoopDriver(ZONE)
    for step in range(100):
        driver.drive(step * 40 * MS, 0.0, 0.0)
    last_ns = 99 * 40 * MS
    driver.decisions.clear()
    driver.wait_until(last_ns + 2 * SECOND)
    assert driver.decisions == []
    driver.wait_until(last_ns + 2 * SECOND + 1)
    assert [(one.stamp_ns, one.planned.reason.value) for one in driver.decisions] == [
        (last_ns + 2 * SECOND + 1, "unknown")
    ]
    assert driver.decisions[0].values == {"/odom pose_x": None}


def test_a_profile_says_when_a_topic_is_stale_and_a_latched_topic_never_is() -> None:
    impatient = LoopDriver(ZONE, Profile(topics={"/odom": TopicProfile(stale_after_s=0.1)}))
    latched = LoopDriver(ZONE)
    latched.source("/odom", transient_local=True)
    for driver in (impatient, latched):
        for step in range(10):
            driver.drive(step * 40 * MS, 0.0, 0.0)
        driver.wait_until(100 * SECOND)
    assert impatient.rates() == {"/scan": 8}
    assert latched.rates() == {"/scan": 2}


def test_when_the_last_publisher_leaves_its_fields_are_unknown_until_one_is_back_and_sent() -> None:
    driver = LoopDriver(ZONE, Profile(settle_s=0.0))
    driver.drive(SECOND, 0.0, 0.0)
    assert driver.rates() == {"/scan": 2}
    driver.source("/odom", publishers=0)
    assert driver.rates() == {"/scan": 8}
    driver.source("/odom", publishers=1)
    assert driver.rates() == {"/scan": 8}
    driver.drive(2 * SECOND, 0.0, 0.0)
    assert driver.rates() == {"/scan": 2}


def test_a_message_that_overtakes_the_news_of_its_publisher_counts_once_the_news_is_there() -> None:
    driver = LoopDriver(ZONE, Profile(settle_s=0.0))
    driver.source("/odom", publishers=0)
    driver.drive(SECOND, 0.0, 0.0)
    assert driver.rates() == {"/scan": 8}
    driver.source("/odom", publishers=1)
    assert driver.rates() == {"/scan": 2}


def test_nan_and_undecodable_messages_are_unknown_and_counted() -> None:
    driver = LoopDriver(ZONE, Profile(settle_s=0.0))
    driver.drive(SECOND, 0.0, 0.0)
    driver.drive(2 * SECOND, math.nan, 0.0)
    assert driver.log()[-1] == (2.0, "/scan", 8, "unknown", "zone")
    driver.drive(3 * SECOND, 0.0, 0.0)
    driver.send("/odom", 4 * SECOND, message=Undecodable())
    assert driver.log()[-1] == (4.0, "/scan", 8, "unknown", "zone")
    assert driver.loop.knowledge.unknown_values == {Signal("/odom", "pose_x"): 1}
    assert driver.loop.knowledge.undecodable == {"/odom": 1}


def test_a_property_name_is_read_once_the_type_is_known() -> None:
    driver = LoopDriver(ZONE.replace("/odom", "/late_odom"), Profile(settle_s=0.0))
    driver.send("/late_odom", SECOND, message=odometry(0.0, 0.0))
    assert driver.rates() == {"/scan": 8}
    driver.source("/late_odom", type_name=ODOMETRY)
    driver.send("/late_odom", 2 * SECOND, message=odometry(0.0, 0.0))
    assert driver.rates() == {"/scan": 2}


def test_an_age_acts_at_the_nanosecond_and_counts_from_the_start_where_nothing_came() -> None:
    driver = LoopDriver(
        """
        begin
        SetFrequency /scan 2
        Rule "above" If CheckValue /beat age > 1.1 Then SetFrequency /scan 8 EndIf
        SetFrequency /imu 2
        Rule "at" If CheckValue /beat age >= 1.1 Then SetFrequency /imu 8 EndIf
        end
        """
    )
    assert not driver.loop.knowledge.reads("/beat")
    driver.decisions.clear()
    driver.wait_until(3 * SECOND)
    assert [(one.stamp_ns, one.topic) for one in driver.decisions] == [
        (1_100_000_000, "/imu"),
        (1_100_000_001, "/scan"),
    ]
    driver.send("/beat", 3 * SECOND)
    driver.wait_until(4 * SECOND)
    assert driver.rates() == {"/scan": 2, "/imu": 2}
    driver.wait_until(4 * SECOND + 100 * MS)
    assert driver.rates() == {"/scan": 2, "/imu": 8}


def test_rate_and_bandwidth_fall_when_messages_leave_the_window() -> None:
    driver = LoopDriver(
        """
        begin
        SetFrequency /scan 2
        Rule "busy" If CheckValue /beat rate >= 2 Then SetFrequency /scan 8 EndIf
        SetFrequency /imu 2
        Rule "heavy" If CheckValue /beat bandwidth > 1.5 Then SetFrequency /imu 8 EndIf
        end
        """,
        Profile(settle_s=0.0),
    )
    for step in range(4):
        driver.send("/beat", step * 100 * MS, size_bytes=1000)
    assert driver.rates() == {"/scan": 8, "/imu": 8}
    driver.wait_until(2 * SECOND - 1)
    assert driver.rates() == {"/scan": 8, "/imu": 8}
    driver.wait_until(2 * SECOND)
    assert driver.rates() == {"/scan": 2, "/imu": 2}


def test_a_flood_of_messages_that_changes_no_check_asks_for_few_wakes() -> None:
    driver = LoopDriver(
        "begin SetFrequency /scan 2 If CheckValue /beat rate > 10 Then SetFrequency /scan 8 EndIf end"
    )
    wakes = 0
    for step in range(1000):
        at_ns = step * 10 * MS
        while (wake_ns := driver.loop.next_wake_ns) is not None and wake_ns <= at_ns:
            driver.loop.handle(WakeInput(stamp_ns=wake_ns))
            wakes += 1
        driver.loop.handle(MessageInput(at_ns, "/beat", b"", 1))
    assert wakes < 20


def test_a_clock_that_jumps_back_stands_still_for_the_plan() -> None:
    driver = LoopDriver(ZONE)
    for step in range(100):
        driver.drive(100 * SECOND + step * 40 * MS, 6.0, 0.0)
    driver.drive(104 * SECOND, 4.0, 0.0)
    driver.decisions.clear()
    driver.now_ns = SECOND
    driver.send("/other", SECOND)
    driver.wait_until(SECOND + 500 * MS)
    assert [(one.t_s, one.stamp_ns) for one in driver.decisions] == [(104.5, SECOND + 500 * MS)]
    assert driver.rates() == {"/scan": 2}

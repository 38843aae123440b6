# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live run says of itself, in virtual time."""

from __future__ import annotations

import json
import math

import pytest

from loop.loop_driver import SECOND
from pacing.test_stream_reader import tf_message
from robot.status.status_driver import StatusDriver
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.record import to_json
from smarttestudo.domain.robot import Endpoint, Qos
from smarttestudo.domain.status import LossBeforeRelay, Silence, status_from_text
from smarttestudo.loop.inputs import MessageInput
from smarttestudo.robot.losses import SourceLoss
from smarttestudo.robot.source import not_offered

IMU_10 = "begin SetFrequency /imu 10 end"
OFF_LATER = (
    "begin SetFrequency /imu 50 If (CheckValue /imu age < 100 AND CheckValue /late age > 20) "
    "Then SetFrequency /imu Off EndIf end"
)
TF = "tf2_msgs/msg/TFMessage"


def test_a_relayed_topic_has_its_rates_and_bandwidths() -> None:
    topic = StatusDriver(rules=IMU_10, source_hz={"/imu": 195}).status_at(15).topics["/imu"]
    assert topic.source_hz == pytest.approx(195)
    assert (topic.target_hz, topic.expected_hz) == (10, 10)
    assert topic.actual_hz is not None
    assert topic.actual_hz == pytest.approx(10, rel=0.01)
    assert topic.error_percent == pytest.approx(100 * (topic.actual_hz / 10 - 1))
    assert topic.in_kb_per_s == pytest.approx(97.5, rel=0.01)
    assert topic.out_kb_per_s == pytest.approx(5, rel=0.01)
    assert (topic.silence, topic.keeps_rate, topic.reason) == (None, True, Reason.DEFAULT)
    assert topic.counts.dropped == topic.counts.received - topic.counts.relayed > 2000


def test_a_target_above_the_source_expects_what_the_source_sends() -> None:
    topic = StatusDriver(rules=IMU_10, source_hz={"/imu": 4}).status_at(15).topics["/imu"]
    assert topic.expected_hz == pytest.approx(4)
    assert topic.error_percent == pytest.approx(0)


def test_full_expects_the_source_itself() -> None:
    full = StatusDriver(rules="begin SetFrequency /imu Full end", source_hz={"/imu": 30})
    topic = full.status_at(15).topics["/imu"]
    assert topic.target_hz == math.inf
    assert topic.expected_hz == topic.source_hz == pytest.approx(30, rel=1e-6)


def test_the_actual_rate_is_that_since_the_target_changed() -> None:
    rules = (
        "begin SetFrequency /imu 5 "
        'Rule "Slow" If (CheckValue /imu age < 100 AND CheckValue /late age > 20) '
        "Then SetFrequency /imu 50 EndIf end"
    )
    driver = StatusDriver(rules=rules, source_hz={"/imu": 200})
    assert driver.status_at(19).topics["/imu"].actual_hz == pytest.approx(5, rel=0.02)
    after = driver.status_at(23).topics["/imu"]
    assert (after.rule, after.reason) == ("Slow", Reason.BLOCK)
    assert after.actual_hz == pytest.approx(50, rel=0.01)
    assert after.error_percent is None
    assert driver.status_at(29).topics["/imu"].error_percent == pytest.approx(0, abs=1)


def test_the_output_has_its_bandwidth_while_its_target_changes_with_each_look() -> None:
    driver = StatusDriver(rules="begin SetFrequency /imu Full end", source_hz={"/imu": 200})
    driver.status_at(15)
    for second, budget_kb_per_s in enumerate((50, 52, 48, 51, 49) * 4, 16):
        driver.driver.budget(budget_kb_per_s)
        topic = driver.status_at(second).topics["/imu"]
        assert topic.actual_hz is None
    assert topic.out_kb_per_s == pytest.approx(50, rel=0.05)


def test_what_nobody_receives_takes_no_bandwidth_out() -> None:
    alone: dict[str, object] = {"subscribers": 0}
    deaf: dict[str, object] = {"subscribers": 1, "unserved": 1}
    rules = "begin SetFrequency /imu 10 SetFrequency /scan 5 SetFrequency /odom 5 end"
    driver = StatusDriver(
        rules=rules, source_hz={"/imu": 30, "/scan": 30, "/odom": 30}, links={"/imu": alone, "/scan": deaf}
    )
    status = driver.status_at(10)
    assert [status.topics[topic].out_kb_per_s for topic in ("/imu", "/scan")] == [0, 0]
    assert status.topics["/imu"].in_kb_per_s > 0
    assert status.out_kb_per_s == status.topics["/odom"].out_kb_per_s > 0


def test_a_topic_that_is_off_takes_no_bandwidth() -> None:
    driver = StatusDriver(rules=OFF_LATER, source_hz={"/imu": 200})
    assert driver.status_at(19).topics["/imu"].out_kb_per_s == pytest.approx(25, rel=0.05)
    topic = driver.status_at(23).topics["/imu"]
    assert (topic.target_hz, topic.out_kb_per_s) == (0, 0)


@pytest.mark.parametrize(
    ("rules", "source_hz", "link", "silence"),
    [
        ("begin SetFrequency /imu Off end", 30, {"publishers": 0, "subscribers": 0}, Silence.OFF),
        (IMU_10, None, {"publishers": 0, "subscribers": 0}, Silence.NO_PUBLISHER),
        (IMU_10, None, {"problem": "not installed", "subscribers": 0}, Silence.CANNOT_RELAY),
        (IMU_10, 30, {"subscribers": 0}, Silence.NO_SUBSCRIBER),
        (IMU_10, 30, {"subscribers": 2, "unserved": 2}, Silence.INCOMPATIBLE_QOS),
        (IMU_10, None, {}, Silence.NO_MESSAGE),
        (IMU_10, 30, {}, None),
        (IMU_10, 30, {"subscribers": 2, "unserved": 1}, None),
    ],
)
def test_a_silent_topic_says_why(
    rules: str, source_hz: float | None, link: dict[str, object], silence: Silence | None
) -> None:
    sources = {} if source_hz is None else {"/imu": source_hz}
    status = StatusDriver(rules=rules, source_hz=sources, links={"/imu": link}).status_at(3)
    assert status.topics["/imu"].silence is silence


def test_a_source_that_stops_is_silent() -> None:
    driver = StatusDriver(rules=IMU_10, source_hz={"/imu": 30})
    driver.status_at(12)
    driver.due_ns.clear()
    topic = driver.status_at(20).topics["/imu"]
    assert topic.silence is Silence.SOURCE_SILENT
    assert (topic.source_hz, topic.actual_hz, topic.error_percent) == (0, 0, None)


def test_the_rate_of_a_source_that_is_not_subscribed_to_is_unknown() -> None:
    driver = StatusDriver(rules=IMU_10, source_hz={"/imu": 30})
    driver.status_at(12)
    due_ns = driver.due_ns.pop("/imu")
    driver.links["/imu"] = {"is_subscribed": False, "subscribers": 0}
    for second in (13, 30):
        topic = driver.status_at(second).topics["/imu"]
        assert (topic.source_hz, topic.expected_hz, topic.actual_hz) == (None, None, None)
        assert topic.silence is Silence.NO_SUBSCRIBER
    driver.links.clear()
    driver.due_ns["/imu"] = due_ns + 18 * SECOND
    assert driver.status_at(33).topics["/imu"].source_hz == pytest.approx(30)


def test_a_source_is_measured_anew_where_it_was_not_subscribed_to_for_a_second() -> None:
    driver = StatusDriver(rules=IMU_10, source_hz={"/imu": 30})
    driver.status_at(12)
    driver.links["/imu"] = {"is_subscribed": False}
    driver.due_ns["/imu"] += SECOND
    driver.status_at(13)
    driver.links.clear()
    assert driver.status_at(16).topics["/imu"].source_hz == pytest.approx(30)


@pytest.mark.parametrize("rules", [IMU_10, "begin SetFrequency /imu Full end"])
def test_the_rate_of_a_relay_is_kept_though_nobody_subscribed_for_a_second(rules: str) -> None:
    driver = StatusDriver(rules=rules, source_hz={"/imu": 30})
    driver.status_at(12)
    driver.links["/imu"] = {"is_subscribed": False, "subscribers": 0}
    driver.due_ns["/imu"] += SECOND
    driver.status_at(13)
    driver.links["/imu"] = {"subscriptions": 1}
    for second in range(14, 24):
        topic = driver.status_at(second).topics["/imu"]
        assert topic.keeps_rate
    assert topic.actual_hz == pytest.approx(topic.expected_hz, rel=0.02)
    assert topic.error_percent == pytest.approx(0, abs=2)


def test_looks_that_are_five_seconds_apart_measure_the_same() -> None:
    often, seldom = (StatusDriver(rules=IMU_10, source_hz={"/imu": 30}) for _ in range(2))
    for second in range(5, 41, 5):
        seldom.send_until(second)
        status, other = often.status_at(second).topics["/imu"], seldom.look().topics["/imu"]
    for measured in ("source_hz", "actual_hz", "expected_hz"):
        assert getattr(other, measured) == pytest.approx(getattr(status, measured), rel=0.01)
    assert (other.silence, other.keeps_rate, other.counts) == (None, True, status.counts)
    often.due_ns.clear()
    seldom.due_ns.clear()
    seldom.send_until(45)
    for later in (seldom.look(), often.status_at(45)):
        assert later.topics["/imu"].silence is Silence.SOURCE_SILENT


def test_what_came_while_a_source_was_not_subscribed_to_between_two_looks_is_unknown() -> None:
    driver = StatusDriver(rules=IMU_10, source_hz={"/imu": 30})
    driver.status_at(12)
    driver.due_ns["/imu"] += 3 * SECOND
    driver.links["/imu"] = {"subscriptions": 1}
    driver.send_until(17)
    driver.look()
    assert driver.status_at(20).topics["/imu"].source_hz == pytest.approx(30)


def test_after_another_target_for_some_seconds_between_two_looks_the_rate_is_measured_anew() -> None:
    driver = StatusDriver(rules=IMU_10, source_hz={"/imu": 30})
    driver.status_at(12)
    for seconds, rate in ((14, 2), (17, 10)):
        driver.driver.reload(f"begin SetFrequency /imu {rate} end")
        driver.send_until(seconds)
    driver.look()
    topic = driver.status_at(24).topics["/imu"]
    assert topic.actual_hz == pytest.approx(10, rel=0.02)
    assert topic.keeps_rate


def test_the_profile_says_from_when_on_a_source_is_silent() -> None:
    profile = Profile(topics={"/imu": TopicProfile(stale_after_s=30)})
    driver = StatusDriver(rules=IMU_10, source_hz={"/imu": 30}, profile=profile)
    driver.status_at(12)
    driver.due_ns.clear()
    assert driver.status_at(40).topics["/imu"].silence is None
    assert driver.status_at(45).topics["/imu"].silence is Silence.SOURCE_SILENT


def test_a_latched_topic_that_passes_whole_is_not_off_its_rate() -> None:
    rules = "begin SetFrequency /map 0.5 end"
    driver = StatusDriver(rules=rules, source_hz={"/map": 0.9}, links={"/map": {"transient_local": True}})
    driver.driver.source("/map", transient_local=True)
    topic = driver.status_at(40).topics["/map"]
    assert topic.actual_hz == pytest.approx(0.9)
    assert (topic.error_percent, topic.keeps_rate) == (None, True)


def test_of_a_latched_topic_that_is_thinned_the_error_of_its_first_seconds_is_explained() -> None:
    rules = "begin SetFrequency /switch/_service_event 2 end"
    link: dict[str, dict[str, object]] = {"/switch/_service_event": {"transient_local": True}}
    driver = StatusDriver(rules=rules, source_hz={"/switch/_service_event": 20}, links=link)
    driver.driver.source("/switch/_service_event", transient_local=True)
    at_first = driver.status_at(7).topics["/switch/_service_event"]
    assert at_first.error_percent is not None
    assert at_first.error_percent > 100
    assert at_first.keeps_rate
    topic = driver.status_at(30).topics["/switch/_service_event"]
    assert topic.error_percent == pytest.approx(0, abs=1)


def test_two_publishers_with_a_rate_each_are_not_off_their_rate() -> None:
    driver = StatusDriver(rules=IMU_10, source_hz={}, links={"/imu": {"publishers": 2}})
    for second in range(1, 20):
        for message in range(100):
            at_ns = second * SECOND + message * SECOND // 100
            given = MessageInput(at_ns, "/imu", b"", 100, publisher=message % 2)
            driver.driver.keep(driver.driver.loop.handle(given))
        driver.driver.now_ns = (second + 1) * SECOND - 1
        topic = driver.look().topics["/imu"]
    assert topic.actual_hz == pytest.approx(20, rel=0.05)
    assert (topic.error_percent, topic.keeps_rate) == (None, True)


def test_a_relay_that_loses_messages_is_off_its_rate() -> None:
    driver = StatusDriver(rules=IMU_10, source_hz={"/imu": 30})
    driver.status_at(5)
    # Messages that a stalled machine hands over in one go, after longer than is made up for.
    for second in range(6, 60, 5):
        for _ in range(150):
            driver.driver.send("/imu", second * SECOND, b"", 100)
        topic = driver.look().topics["/imu"]
    assert topic.error_percent is not None
    assert topic.error_percent < -40
    assert not topic.keeps_rate


def test_a_topic_has_the_number_of_its_lost_messages_where_that_is_known() -> None:
    rules = "begin SetFrequency /imu 10 SetFrequency /scan 5 end"
    driver = StatusDriver(
        rules=rules, source_hz={"/imu": 30, "/scan": 10}, lost={"/imu": SourceLoss(messages=12)}
    )
    topics = driver.status_at(5).topics
    assert (topics["/imu"].counts.lost, topics["/scan"].counts.lost) == (12, None)


@pytest.mark.parametrize(
    ("target", "expected_hz", "error_percent"), [("Full", 15, -60), ("10", 10, -40), ("5", 5, 0), ("1", 1, 0)]
)
def test_the_error_is_against_what_the_source_sent_lost_messages_included(
    target: str, expected_hz: float, error_percent: float
) -> None:
    """Of 15 images a second six come."""
    loss = LossBeforeRelay(percent=60, remedy="start /camera with more")
    driver = StatusDriver(
        rules=f"begin SetFrequency /image {target} end",
        source_hz={"/image": 6},
        lost={"/image": SourceLoss(messages=90, share=0.6, state=loss)},
    )
    image = driver.status_at(20).topics["/image"]
    assert (image.source_hz, image.expected_hz) == pytest.approx((15, expected_hz), rel=0.01)
    one_message_percent = 100 / (expected_hz * 10)
    assert image.error_percent == pytest.approx(error_percent, abs=one_message_percent)
    assert image.loss == loss


def test_an_output_that_stops_while_its_source_goes_on_is_off_its_rate() -> None:
    profile = Profile(topics={"/info": TopicProfile(paced_with="/image")})
    rules = "begin SetFrequency /image 10 SetFrequency /info 10 end"
    driver = StatusDriver(rules=rules, source_hz={"/image": 30, "/info": 30}, profile=profile)
    assert driver.status_at(10).topics["/info"].keeps_rate
    del driver.due_ns["/image"]
    info = driver.status_at(20).topics["/info"]
    assert [info.source_hz, info.actual_hz] == pytest.approx([30, 0])
    assert (info.error_percent, info.keeps_rate) == (-100, False)


def test_floors_above_the_budget_are_said_while_they_are() -> None:
    rules = "begin KeepAtLeast /imu 20 SetFrequency /imu 50 end"
    tight = StatusDriver(rules=rules, source_hz={"/imu": 100}, budget_kb_per_s=3).status_at(15)
    assert tight.floors_break_budget
    assert (tight.topics["/imu"].target_hz, tight.topics["/imu"].reason) == (20, Reason.BUDGET)
    assert tight.budget_kb_per_s == 3
    assert tight.out_kb_per_s > 3
    wide = StatusDriver(rules=rules, source_hz={"/imu": 100}, budget_kb_per_s=300).status_at(15)
    assert not wide.floors_break_budget


def test_the_runtime_counts_itself() -> None:
    status = StatusDriver(rules=IMU_10, source_hz={"/imu": 30}).status_at(7)
    assert (status.node, status.uptime_s, status.memory_mb) == ("/smarttestudo", 7, 64)
    assert status.cpu_percent == pytest.approx(4)
    assert status.rules.sha256 == "0" * 64


def test_a_subscriber_may_ask_for_less_than_is_offered_but_not_for_more() -> None:
    def asked(*, reliable: bool, transient_local: bool) -> Endpoint:
        return Endpoint(node="/rviz", type_name="", reliable=reliable, transient_local=transient_local)

    best, least = Qos(reliable=True, transient_local=True), Qos(reliable=False, transient_local=False)
    assert not not_offered(best, asked(reliable=True, transient_local=True))
    assert not not_offered(best, asked(reliable=False, transient_local=False))
    assert not not_offered(least, asked(reliable=False, transient_local=False))
    assert not_offered(least, asked(reliable=True, transient_local=False))
    assert not_offered(least, asked(reliable=False, transient_local=True))


def test_the_rates_of_transforms_are_those_of_each_frame() -> None:
    driver = StatusDriver(
        rules="begin SetFrequency /tf 10 end",
        source_hz={},
        links={"/tf": {"type_name": TF, "publishers": 3}},
    )
    driver.driver.source("/tf", publishers=3, type_name=TF)
    for step in range(30 * 20):
        for frame in ("base", "arm", "wheel"):
            driver.driver.send(
                "/tf", step * SECOND // 20, tf_message([("odom", frame)], 0, little_endian=True), 100
            )
        if step % 20 == 19:
            tf = driver.look().topics["/tf"]
    assert (tf.frames, tf.target_hz) == (3, 10)
    assert tf.source_hz == pytest.approx(20, rel=0.01)
    assert tf.actual_hz == pytest.approx(10, rel=0.01)
    assert tf.error_percent == pytest.approx(0, abs=1)
    assert tf.keeps_rate
    assert status_from_text(json.dumps(to_json(driver.look()))).topics["/tf"].frames == 3

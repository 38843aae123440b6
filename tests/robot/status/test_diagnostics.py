# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a runtime says on /diagnostics."""

from __future__ import annotations

from dataclasses import replace

import pytest

from robot.status.statuses import ONE_OF_EACH, RELAYED, STATUS, WELL
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.link import LinkState, StreamCounts, TopicOnLink
from smarttestudo.domain.metric import metered_fields
from smarttestudo.domain.robot import Diagnostic, DiagnosticLevel
from smarttestudo.domain.status import (
    Fallback,
    LossBeforeRelay,
    RulesInForce,
    RulesOrigin,
    RuntimeStatus,
    TopicStatus,
)
from smarttestudo.robot.diagnostics import diagnostics, recording_text


def named(name: str, status: RuntimeStatus = STATUS) -> Diagnostic:
    (found,) = (one for one in diagnostics(status) if one.name == name)
    return found


def test_there_is_one_for_the_node_and_one_for_each_output() -> None:
    names = [one.name for one in diagnostics(STATUS)]
    assert names == ["smarttestudo", *(f"/testudo{source}" for source in ONE_OF_EACH)]
    assert {one.hardware_id for one in diagnostics(STATUS)} == {"/smarttestudo"}


def test_a_topic_has_the_keys_that_greenwave_reads() -> None:
    values = named("/testudo/imu").values
    assert values["frame_rate_node"] == "49.990"
    assert values["frame_rate_msg"] == "50.001"
    assert values["current_delay_from_realtime_ms"] == "3.250"
    assert values["expected_frequency"] == "50.000"
    assert values["tolerance"] == "5.000"


def test_what_is_not_known_is_said_as_greenwave_says_it() -> None:
    values = named("/testudo/estop").values
    assert values["frame_rate_node"] == values["expected_frequency"] == "N/A"
    assert values["target"] == "Full"


def test_messages_that_were_lost_are_counted_where_they_are_numbered() -> None:
    imu = STATUS.topics["/imu"]
    lost = replace(STATUS, topics={"/imu": replace(imu, counts=replace(imu.counts, lost=12))})
    assert named("/testudo/imu", lost).values["lost"] == "12"
    assert named("/testudo/imu").values["lost"] == "N/A"


@pytest.mark.parametrize(
    ("name", "level", "message"),
    [
        ("/testudo/imu", DiagnosticLevel.OK, "OK"),
        ("/testudo/cmd_vel", DiagnosticLevel.OK, "Off"),
        ("/testudo/odom", DiagnosticLevel.OK, "no subscriber"),
        ("/testudo/estop", DiagnosticLevel.STALE, "no publisher"),
        ("/testudo/scan", DiagnosticLevel.STALE, "source is silent"),
        ("/testudo/map", DiagnosticLevel.WARN, "incompatible QoS: /rviz"),
        ("/testudo/camera/image_raw/compressed", DiagnosticLevel.WARN, "rate off: -30.0 %"),
        (
            "/testudo/lidar",
            DiagnosticLevel.ERROR,
            "cannot be relayed: the message type lidar_msgs/msg/Packet is not installed",
        ),
    ],
)
def test_the_level_says_how_bad_it_is(name: str, level: DiagnosticLevel, message: str) -> None:
    assert (named(name).level, named(name).message) == (level, message)


def test_a_rate_that_is_off_by_nobody_knows_how_much_is_off() -> None:
    # Another robot's status may say so.
    topic = replace(STATUS.topics["/imu"], keeps_rate=False, error_percent=None)
    found = named("/testudo/imu", replace(STATUS, topics={"/imu": topic}))
    assert (found.level, found.message) == (DiagnosticLevel.WARN, "rate off")


def test_the_node_says_what_is_worst_of_it_and_its_topics() -> None:
    node = named("smarttestudo")
    assert (node.level, node.message) == (
        DiagnosticLevel.ERROR,
        "cannot be relayed: /lidar",
    )
    well = named("smarttestudo", WELL)
    assert (well.level, well.message) == (DiagnosticLevel.OK, "relaying 1 topic")
    assert node.values["rules"] == "/etc/testudo/warehouse.adirf"
    assert node.values["rules_sha256"] == "ab" * 32
    assert node.values["budget_kb_per_s"] == "1000.000"
    assert node.values["out_kb_per_s"] == "946.000"


def test_a_number_of_the_status_that_is_a_metric_is_in_the_diagnostics_too() -> None:
    node, topic = named("smarttestudo"), named("/testudo/imu")
    own = [
        (one, of) for of in (RuntimeStatus, TopicStatus) for one in metered_fields(of) if len(one.keys) == 1
    ]
    assert len(own) == 20
    for field, of in own:
        assert field.keys[0] in (node if of is RuntimeStatus else topic).values
    assert (node.values["fallback"], node.values["uptime_s"]) == ("false", f"{STATUS.uptime_s:.3f}")


def test_floors_above_the_budget_are_an_error_of_the_node() -> None:
    node = named("smarttestudo", replace(STATUS, floors_break_budget=True))
    assert (node.level, node.message) == (
        DiagnosticLevel.ERROR,
        "the floors alone are more than the budget",
    )


@pytest.mark.parametrize(
    ("fallback", "relayed"),
    [
        (None, "everything is relayed at full rate"),
        (Fallback.FULL, "everything is relayed at full rate"),
        (
            Fallback.READABLE,
            "topics have the rates that can be read, at least 1 Hz, and all others 1 Hz",
        ),
        (Fallback.OFF, "nothing is relayed"),
    ],
)
def test_a_fallback_is_an_error_of_the_node_also_while_it_knows_no_topic(
    fallback: Fallback | None, relayed: str
) -> None:
    rules = RulesInForce(origin=RulesOrigin.FALLBACK, fallback=fallback)
    node = named("smarttestudo", replace(STATUS, topics={}, rules=rules))
    assert node.level is DiagnosticLevel.ERROR
    assert node.message == f"no valid rules: {relayed}; mend the rule files, or push rules"


def test_two_robots_are_told_apart() -> None:
    assert named("tb3_0/smarttestudo", replace(STATUS, node="/tb3_0/smarttestudo")).values


ON_LINK = TopicOnLink(counts=StreamCounts(sent=480, replaced=20, queued_bytes=1200), age_ms=41.25)
LINKED = replace(
    WELL,
    link=LinkState(is_connected=True, capacity_kb_per_s=231.5, round_trip_ms=24.0, outages=2),
    topics={"/imu": replace(RELAYED, on_link=ON_LINK)},
)


def test_the_node_says_how_its_link_does() -> None:
    node = named("smarttestudo", LINKED)
    assert (node.level, node.message) == (DiagnosticLevel.OK, "relaying 1 topic")
    assert {name: value for name, value in node.values.items() if name.startswith("link_")} == {
        "link_connected": "true",
        "link_capacity_kb_per_s": "231.500",
        "link_round_trip_ms": "24.000",
        "link_outages": "2",
        "link_datagrams": "false",
        "link_lost_percent": "N/A",
        "link_sent_bytes": "0",
        "link_report_bytes": "0",
    }


def test_the_node_says_what_recording_costs_and_that_it_fails() -> None:
    state = IncidentState(held_bytes=12_340_000, memory_bytes=256_000_000, topics=5, open=1, recorded=3)
    node = named("smarttestudo", replace(STATUS, incidents=state))
    assert {name: value for name, value in node.values.items() if name.startswith("incident")} == {
        "incidents_held_bytes": "12340000",
        "incidents_memory_bytes": "256000000",
        "incidents_topics": "5",
        "incidents_open": "1",
        "incidents_recorded": "3",
        "incidents_failed": "0",
        "incidents_problem": "N/A",
        "incidents_ring_bytes": "0",
        "incidents_ring_max_bytes": "N/A",
    }
    flickering = replace(state, further_moments=49)
    values = named("smarttestudo", replace(STATUS, incidents=flickering)).values
    assert values["incidents_further_moments"] == "49"
    assert "incidents: 1 open, 3 recorded, 49 further moments" in recording_text(flickering)
    with_ring = replace(state, ring_bytes=40_120_000, ring_max_bytes=5_000_000_000)
    values = named("smarttestudo", replace(STATUS, incidents=with_ring)).values
    assert values["incidents_ring_bytes"] == "40120000"
    failed = named("smarttestudo", replace(WELL, incidents=replace(state, problem="the disk is full")))
    assert (failed.level, failed.message) == (
        DiagnosticLevel.WARN,
        "incidents cannot be written: the disk is full",
    )


def test_a_link_without_an_operator_is_a_warning_and_what_it_carries_is_not_known() -> None:
    node = named("smarttestudo", replace(LINKED, link=LinkState()))
    assert (node.level, node.message) == (DiagnosticLevel.WARN, "no operator is connected over the link")
    assert (node.values["link_connected"], node.values["link_capacity_kb_per_s"]) == ("false", "N/A")


def test_a_topic_says_how_it_does_on_the_link() -> None:
    imu = named("/testudo/imu", LINKED)
    assert (imu.level, imu.message) == (DiagnosticLevel.OK, "OK")
    assert {name: value for name, value in imu.values.items() if name.startswith("link_")} == {
        "link_age_ms": "41.250",
        "link_sent": "480",
        "link_replaced": "20",
        "link_overflowed": "0",
        "link_queued_bytes": "1200",
        "link_repaired": "0",
        "link_lost_replaced": "0",
        "link_lost_late": "0",
        "link_sent_bytes": "0",
        "link_repair_bytes": "0",
    }


def test_a_topic_of_which_much_is_lost_before_relay_is_a_warning_with_what_to_do() -> None:
    loss = LossBeforeRelay(percent=61.8, remedy="start /camera with more")
    image = replace(RELAYED, loss=loss, keeps_rate=False, error_percent=-61.8)
    found = named("/testudo/imu", replace(STATUS, topics={"/imu": image}))
    assert (found.level, found.message) == (
        DiagnosticLevel.WARN,
        "lost before relay: 62 %; start /camera with more",
    )


def test_lost_messages_of_a_topic_that_must_not_lose_any_are_a_warning_of_the_topic() -> None:
    for is_losing, said in (
        (True, (DiagnosticLevel.WARN, "lost on the link: 3 messages since the start")),
        (False, (DiagnosticLevel.OK, "OK")),
    ):
        lost = replace(ON_LINK, counts=replace(ON_LINK.counts, overflowed=3, is_losing=is_losing))
        imu = named("/testudo/imu", replace(LINKED, topics={"/imu": replace(RELAYED, on_link=lost)}))
        assert (imu.level, imu.message) == said
        assert imu.values["link_overflowed"] == "3"


def test_a_robot_without_a_link_says_nothing_of_one() -> None:
    said = {name for one in diagnostics(STATUS) for name in one.values}
    assert {name for name in said if name.startswith("link")} == set()

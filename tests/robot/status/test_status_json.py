# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A status survives the way to another process, and nonsense does not get through."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.status.statuses import RELAYED, STATUS
from smarttestudo.domain.decision import BoundReason, Reason
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.link import CommandTopic
from smarttestudo.domain.record import to_json
from smarttestudo.domain.status import (
    MOST_UPTIME_S,
    LossBeforeRelay,
    RulesOrigin,
    Silence,
    TopicStatus,
    status_from_json,
    status_from_text,
)

TEXT = json.dumps(to_json(STATUS))
RECORD = json.loads(TEXT)
json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.sampled_from([*Reason, *Silence]).map(lambda one: one.value),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)
TOPIC = RECORD["topics"]["/imu"]
SMALL_RECORD = {**RECORD, "topics": {}}


def is_text(value: object) -> bool:
    return isinstance(value, str)


def is_flag(value: object) -> bool:
    return isinstance(value, bool)


def is_integer(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def is_number(value: object) -> bool:
    return is_integer(value) or isinstance(value, float)


def is_duration(value: object) -> bool:
    return isinstance(value, int | float) and is_number(value) and abs(value) <= MOST_UPTIME_S


def is_none_or_text(value: object) -> bool:
    return value is None or is_text(value)


def is_none_or_number(value: object) -> bool:
    return value is None or is_number(value)


ENTRIES: dict[str, Callable[[object], bool]] = {
    "node": is_text,
    "stamp_ns": is_integer,
    "uptime_s": is_duration,
    "status_hz": is_none_or_number,
    "budget_kb_per_s": is_none_or_number,
    "floors_break_budget": is_flag,
    "cpu_percent": is_none_or_number,
    "memory_mb": is_none_or_number,
}
TOPIC_ENTRIES: dict[str, Callable[[object], bool]] = {
    "output": is_text,
    "type": is_none_or_text,
    "source_hz": is_none_or_number,
    "target_hz": is_none_or_number,
    "expected_hz": is_none_or_number,
    "actual_hz": is_none_or_number,
    "error_percent": is_none_or_number,
    "keeps_rate": is_flag,
    "stamped_hz": is_none_or_number,
    "delay_ms": is_none_or_number,
    "in_kb_per_s": is_number,
    "out_kb_per_s": is_number,
    "reason": lambda value: value in [one.value for one in Reason],
    "rule": is_none_or_text,
    "line": lambda value: value is None or is_integer(value),
    "publishers": is_integer,
    "subscribers": is_integer,
    "problem": is_none_or_text,
    "silent": lambda value: value in [None, *(one.value for one in Silence)],
    "received": is_integer,
    "relayed": is_integer,
    "repeated": is_integer,
    "discarded": is_integer,
    "undecodable": is_integer,
}


def test_what_is_written_is_read() -> None:
    assert status_from_text(TEXT) == STATUS


def test_messages_lost_have_an_entry_where_they_are_numbered() -> None:
    imu = STATUS.topics["/imu"]
    lost = replace(STATUS, topics={"/imu": replace(imu, counts=replace(imu.counts, lost=12))})
    record = to_json(lost)
    assert status_from_json(record) == lost
    topics = record["topics"]
    assert isinstance(topics, dict)
    assert topics["/imu"]["lost"] == 12
    assert "lost" not in RECORD["topics"]["/imu"]


def test_what_is_lost_before_relay_has_an_entry_while_it_is_too_much() -> None:
    loss = LossBeforeRelay(percent=61.8, remedy="start /camera with more")
    losing = replace(STATUS, topics={"/imu": replace(STATUS.topics["/imu"], loss=loss)})
    record: Any = to_json(losing)
    assert status_from_json(record) == losing
    assert record["topics"]["/imu"]["loss"] == {"percent": 61.8, "remedy": "start /camera with more"}
    assert "loss" not in RECORD["topics"]["/imu"]


def test_topics_are_by_name_and_full_is_null_as_in_decisions() -> None:
    assert RECORD["topics"]["/estop"]["target_hz"] is None
    assert RECORD["topics"]["/cmd_vel"]["target_hz"] == 0
    assert RECORD["topics"]["/cmd_vel"]["silent"] == "Off"
    assert RECORD["topics"]["/imu"]["dropped"] == 1450
    assert RECORD["out_kb_per_s"] == 946


ACCEPTED = (
    CommandTopic(
        topic="/joy",
        type_name="sensor_msgs/msg/Joy",
        received=9,
        delivered=6,
        too_old=2,
        refused=1,
        age_ms=44.5,
    ),
    CommandTopic(topic="/goal_pose", problem="two types"),
)


def test_what_is_accepted_of_operators_is_read_and_left_out_where_nothing_is() -> None:
    status = replace(STATUS, accepted=ACCEPTED)
    assert status_from_text(json.dumps(to_json(status))) == status
    assert "accepted" not in RECORD


def test_bounds_and_what_decided_them_are_read_and_left_out_where_there_are_none() -> None:
    reasons = {
        "position": BoundReason(reason=Reason.DEFAULT),
        "orientation": BoundReason(reason=Reason.UNKNOWN, rule="Docking", line=7),
    }
    topics = {"/imu": replace(RELAYED, within={"position": 0.05}, bound_reasons=reasons)}
    status = replace(STATUS, topics=topics)
    assert status_from_text(json.dumps(to_json(status))) == status
    assert not {"within", "bound_reasons"} & RECORD["topics"]["/imu"].keys()


@given(value=json_values)
def test_bounds_are_read_or_refused_whatever_they_are(value: object) -> None:
    for name in ("within", "bound_reasons"):
        for entry in (value, {"position": value}, {"position": {"reason": value, "rule": value}}):
            with suppress(ValueError):
                status_from_text(json.dumps({**SMALL_RECORD, "topics": {"/imu": {**TOPIC, name: entry}}}))


def test_what_recording_costs_is_read_and_left_out_where_nothing_is_recorded() -> None:
    state = IncidentState(
        held_bytes=12, memory_bytes=256_000_000, topics=5, open=1, recorded=3, failed=2, problem="full"
    )
    with_ring = replace(state, ring_bytes=40_120_000, ring_max_bytes=5_000_000_000)
    for incidents in (state, replace(state, problem=None), with_ring, replace(state, further_moments=4)):
        status = replace(STATUS, incidents=incidents)
        assert status_from_text(json.dumps(to_json(status))) == status
    assert "incidents" not in RECORD


@given(json_values)
def test_what_is_accepted_is_read_or_refused_whatever_it_is(value: object) -> None:
    for accepted in (value, {"/joy": value}):
        try:
            status = status_from_text(json.dumps({**SMALL_RECORD, "accepted": accepted}))
        except ValueError:
            continue
        assert status.accepted == () or isinstance(value, dict)


def test_a_status_of_an_older_version_is_read() -> None:
    newer = {"status_hz", "blocks"}
    older = {name: value for name, value in RECORD.items() if name not in newer}
    older["rules"] = {name: RECORD["rules"][name] for name in ("files", "sha256")}
    status = status_from_text(json.dumps(older))
    assert (status.status_hz, status.blocks, status.rules.origin) == (1.0, (), RulesOrigin.FILES)
    assert status.topics == STATUS.topics


def test_what_a_newer_version_adds_is_left_out() -> None:
    newer = {**RECORD, "mood": "good", "rules": {**RECORD["rules"], "origin": "elsewhere", "mood": 1}}
    newer["blocks"] = [{"file": 0, "state": "maybe"}, None, *RECORD["blocks"]]
    status = status_from_text(json.dumps(newer))
    assert (status.blocks, status.rules.origin) == (STATUS.blocks, RulesOrigin.FILES)


@given(value=json_values)
def test_a_block_with_anything_in_it_is_read_or_left_out(value: object) -> None:
    for name in ("file", "line", "state", "checks"):
        block = {**RECORD["blocks"][0], name: value}
        status = status_from_text(json.dumps({**SMALL_RECORD, "blocks": [block, RECORD["blocks"][1]]}))
        assert len(status.blocks) in (1, 2)
        assert status.blocks[-1] == STATUS.blocks[1]
    block = {**RECORD["blocks"][0], "checks": [[1, 2, "true", value]]}
    [read] = status_from_text(json.dumps({**SMALL_RECORD, "blocks": [block]})).blocks
    assert (read.line, [check.line for check in read.checks]) == (14, [1])


def test_what_conditions_add_to_a_status_is_small() -> None:
    blocks = json.dumps(RECORD["blocks"][0])
    assert len(blocks) < 150


@pytest.mark.parametrize("uptime", ["Infinity", "-Infinity", "NaN", "1e300"])
def test_a_time_since_the_start_that_nobody_can_show_is_refused(uptime: str) -> None:
    text = json.dumps({**RECORD, "uptime_s": "@"}).replace('"@"', uptime)
    with pytest.raises(ValueError, match=r"uptime_s: .* out of range"):
        status_from_text(text)


@pytest.mark.parametrize("text", ["", "[]", "{}", "null", "[" * 100_000, '{"node": 1e999}', TEXT[:-5]])
def test_what_is_no_status_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        status_from_text(text)


@given(value=json_values)
def test_a_status_is_read_where_its_entries_are_of_their_kinds_and_refused_where_not(value: object) -> None:
    for name, is_of_kind in ENTRIES.items():
        text = json.dumps({**SMALL_RECORD, name: value})
        if is_of_kind(value):
            read = value or 1.0 if name == "status_hz" else value
            assert repr(getattr(status_from_text(text), name)) == repr(read)
        else:
            with pytest.raises(ValueError, match=name):
                status_from_text(text)


@given(value=json_values)
def test_a_topic_is_read_where_its_entries_are_of_their_kinds_and_refused_where_not(value: object) -> None:
    for name, is_of_kind in TOPIC_ENTRIES.items():
        text = json.dumps({**SMALL_RECORD, "topics": {"/imu": {**TOPIC, name: value}}})
        if is_of_kind(value):
            read = math.inf if name == "target_hz" and value is None else value
            assert repr(topic_entry(status_from_text(text).topics["/imu"], name)) == repr(read)
        else:
            with pytest.raises(ValueError, match=r"."):
                status_from_text(text)


@given(value=json_values)
def test_what_has_parts_is_refused_where_it_is_no_object(value: object) -> None:
    for record in ({"rules": value}, {"topics": value}, {"topics": {"/imu": value}}):
        if not isinstance(value, dict):
            with pytest.raises(ValueError, match="not an object"):
                status_from_text(json.dumps({**SMALL_RECORD, **record}))


def topic_entry(topic: TopicStatus, name: str) -> object:
    """An entry of a topic's record, as it was read."""
    match name:
        case "type":
            return topic.type_name
        case "reason":
            return topic.reason.value
        case "silent":
            return None if topic.silence is None else topic.silence.value
    return getattr(topic.counts if hasattr(topic.counts, name) else topic, name)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates of topics with several streams: frames, parts, groups of video."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_factory import (
    LATCHED,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
)
from pacing.bitstreams import IDR, NON_IDR_P, PPS, SPS, compressed_image, nal
from replays.replay_runs import replay_content
from smarttestudo.domain.record import to_json

SECOND_NS = 1_000_000_000
TF_TYPE = "tf2_msgs/msg/TFMessage"


def transforms(*children: str) -> bytes:
    one = "geometry_msgs/msg/TransformStamped"
    return cdr(TF_TYPE, message_of(TF_TYPE, transforms=[message_of(one, child_frame_id=c) for c in children]))


def test_the_rate_of_transforms_is_that_of_each_frame(tmp_path: Path) -> None:
    """Wheels in pairs at 30 Hz, the base at 20 Hz and a map at 5 Hz; each frame is to have 10."""
    sources = ((("left", "right"), 30), (("base",), 20), (("map",), 5))
    messages = [
        BagMessage("/tf", START_NS + number * SECOND_NS // hz, transforms(*frames))
        for frames, hz in sources
        for number in range(20 * hz + 1)
    ]
    content = BagContent((BagTopic("/tf", TF_TYPE),), tuple(sorted(messages, key=lambda one: one.stamp_ns)))
    tf = replay_content(content, "SetFrequency /tf 10", tmp_path).outcome.topics["/tf"]
    assert tf.frames == 4
    assert tf.source_hz == pytest.approx((30 + 30 + 20 + 5) / 4, rel=1e-3)
    assert tf.mean_hz == pytest.approx((10 + 10 + 10 + 5) / 4, rel=0.01)
    assert tf.error_percent == pytest.approx(0, abs=1)
    assert to_json(tf)["frames"] == 4


def test_a_budget_counts_each_stream_of_a_topic(tmp_path: Path) -> None:
    """Ten parts at 5 Hz each would take ten times what one does; 2 Hz for each fits."""
    type_name = "diagnostic_msgs/msg/DiagnosticArray"
    messages = tuple(
        BagMessage("/parts", START_NS + (10 * number + part) * SECOND_NS // 100, named(type_name, part))
        for number in range(400)
        for part in range(10)
    )
    kb = sum(len(message.payload) for message in messages) / len(messages) / 1000
    content = BagContent((BagTopic("/parts", type_name),), messages)
    run = replay_content(content, "SetFrequency /parts 5", tmp_path, budget_kb_per_s=20 * kb)
    parts = run.outcome.topics["/parts"]
    assert parts.out_kb == pytest.approx(40 * 20 * kb, rel=0.15)
    assert {message.payload for message in run.messages} == {message.payload for message in messages}


def named(type_name: str, part: int) -> bytes:
    """A message of one of several parts; joints come in another order each time."""
    if type_name == "diagnostic_msgs/msg/DiagnosticArray":
        parts = {"status": [message_of("diagnostic_msgs/msg/DiagnosticStatus", name=f"part {part}")]}
    elif type_name == "sensor_msgs/msg/JointState":
        parts = {"name": [f"joint {part}", "base"][:: (-1) ** part]}
    else:
        parts = {"markers": [message_of("visualization_msgs/msg/Marker", ns=f"ns {part % 2}", id=part // 2)]}
    return cdr(type_name, message_of(type_name, **parts))


@pytest.mark.parametrize("transient_local", [False, True])
@pytest.mark.parametrize(
    "type_name",
    [
        "diagnostic_msgs/msg/DiagnosticArray",
        "sensor_msgs/msg/JointState",
        "visualization_msgs/msg/MarkerArray",
    ],
)
@pytest.mark.parametrize(("parts", "burst_ns", "rate_hz"), [(10, SECOND_NS // 50, 1), (4, SECOND_NS, 1.5)])
def test_each_part_that_one_publisher_sends_in_turn_has_the_rate_for_itself(
    tmp_path: Path, type_name: str, parts: int, burst_ns: int, rate_hz: float, *, transient_local: bool
) -> None:
    """In bursts once a second, and one after the other at twice the rate for each."""
    round_ns = SECOND_NS if burst_ns < SECOND_NS else SECOND_NS // 3
    spread_ns = min(burst_ns, round_ns) // parts
    messages = tuple(
        BagMessage("/parts", START_NS + number * round_ns + part * spread_ns, named(type_name, part))
        for number in range(60)
        for part in range(parts)
    )
    durability = (LATCHED,) if transient_local else ()
    content = BagContent((BagTopic("/parts", type_name, durability),), messages)
    run = replay_content(content, f"SetFrequency /parts {rate_hz}", tmp_path)
    passed = Counter(message.payload for message in run.messages)
    assert run.outcome.topics["/parts"].frames == parts
    expected = 60 * round_ns * rate_hz / SECOND_NS
    for part in range(parts):
        latched = 2 * SECOND_NS // round_ns if transient_local else 0
        assert expected - 2 <= passed[named(type_name, part)] <= expected + latched + 2


def test_a_replay_says_what_its_rates_do_to_video_and_patches(tmp_path: Path) -> None:
    def messages(topic: str, payload: Callable[[int], bytes]) -> tuple[BagMessage, ...]:
        return tuple(BagMessage(topic, START_NS + i * SECOND_NS // 30, payload(i)) for i in range(90))

    def video(frame: int) -> bytes:
        return compressed_image(nal(NON_IDR_P) if frame % 30 else nal(SPS, PPS, IDR), "h264")

    topics = {
        "/h264": ("sensor_msgs/msg/CompressedImage", video),
        "/mpeg4": ("sensor_msgs/msg/CompressedImage", lambda _: compressed_image(b"\xff", "mpeg4")),
        "/updates": ("visualization_msgs/msg/InteractiveMarkerUpdate", lambda _: b"\0\1\0\0"),
    }
    content = BagContent(
        tuple(BagTopic(name, type_name) for name, (type_name, _) in topics.items()),
        tuple(
            sorted(
                (one for name, (_, payload) in topics.items() for one in messages(name, payload)),
                key=lambda message: message.stamp_ns,
            )
        ),
    )
    rules = "".join(f"SetFrequency {name} 10\n" for name in topics)
    run = replay_content(content, rules, tmp_path)
    assert run.outcome.notices == (
        "/h264: coded video: beginnings of its 3 groups pass, without 59 of 90 messages",
        "/mpeg4: no key frame found: its frames cannot be told apart, so all of the video passes, "
        "whatever its rate",
        "/updates: 59 of 90 messages: changes are left out: each message changes a part of those before, "
        "so what is shown stays wrong; write Full",
    )

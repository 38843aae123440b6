# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a status takes of a link.

``statuses-5hz.jsonl.xz`` is what ``testudo run --link`` published on ``/testudo/status`` beside ``testudo
simulate`` by the rules of ``examples/warehouse.adirf``: twenty seconds, five a second, with nine topics that
come and two that do not.
"""

from __future__ import annotations

import lzma
import math
from pathlib import Path

import pytest

from smarttestudo.domain.record import to_json
from smarttestudo.domain.status import (
    RuntimeStatus,
    compact_status,
    is_measured,
    status_from_json,
    status_from_text,
)
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.status_stream import StatusReceiver, StatusSender
from smarttestudo.link.zenoh.compression import compress, decompress

LINES = lzma.decompress((Path(__file__).parent / "statuses-5hz.jsonl.xz").read_bytes()).decode().splitlines()
STATUSES = [status_from_text(line) for line in LINES]
SPAN_S = (STATUSES[-1].stamp_ns - STATUSES[0].stamp_ns) / NS_PER_S


@pytest.fixture(scope="module")
def sent() -> list[bytes]:
    """What travels of each."""
    sender = StatusSender(is_measured, compress)
    return [sender.next(compact_status(to_json(status)), status.stamp_ns) for status in STATUSES]


def test_five_statuses_a_second_of_nine_topics_take_less_than_a_kilobyte_a_second(sent: list[bytes]) -> None:
    active = [topic for topic in STATUSES[-1].topics.values() if topic.counts.received]
    assert len(active) == 9
    assert len(STATUSES) / SPAN_S == pytest.approx(5, rel=0.02)
    assert sum(map(len, sent)) / SPAN_S / BYTES_PER_KB <= 1
    # That is what it took before.
    assert sum(map(len, LINES)) / SPAN_S / BYTES_PER_KB > 30


def test_what_decides_arrives_as_it_is_and_what_is_measured_to_four_digits(sent: list[bytes]) -> None:
    receiver = StatusReceiver(decompress)
    for number, (data, status) in enumerate(zip(sent, STATUSES, strict=True)):
        record = receiver.receive(data)
        assert record is not None
        received = status_from_json(record)
        assert decided(received) == decided(status)
        assert 0 <= status.stamp_ns - received.stamp_ns < NS_PER_MS
        if number == 0:
            for name, topic in status.topics.items():
                close(received.topics[name].source_hz, topic.source_hz)
                close(received.topics[name].actual_hz, topic.actual_hz)
                assert received.topics[name].counts == topic.counts


def decided(status: RuntimeStatus) -> object:
    topics = {
        name: (topic.target_hz, topic.reason, topic.rule, topic.line, topic.silence, topic.publishers)
        for name, topic in status.topics.items()
    }
    return status.robot_id, status.rules, status.blocks, status.status_hz, topics


def close(one: float | None, other: float | None) -> None:
    if one is None or other is None:
        assert one is other
    else:
        assert math.isclose(one, other, rel_tol=5e-4)

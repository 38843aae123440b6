# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.incidents.topic_ring import BlockPool, HeldMessages, SourceMessage, TopicRing

# A payload that comes so long after the one before, how long ago may be forgotten, the oldest to give up, or
# a question that is looked at in the end.
STEPS = st.lists(
    st.one_of(
        st.tuples(st.integers(0, 5), st.binary(max_size=40)),
        st.integers(0, 30),
        st.just("give up"),
        st.just("ask"),
    ),
    max_size=60,
)


@given(STEPS, st.sampled_from((1, 7, 64)))
def test_a_ring_holds_what_a_list_would_and_what_was_asked_stays_as_it_was(
    steps: list[tuple[int, bytes] | int | str], block_bytes: int
) -> None:
    ring = TopicRing("/scan", 0, BlockPool(block_bytes, 3))
    held: list[tuple[int, SourceMessage]] = []
    given_up: list[tuple[int, int]] = []
    asked: list[tuple[HeldMessages, list[SourceMessage]]] = []
    now_ns = number = 0
    for step in steps:
        if isinstance(step, tuple):
            now_ns, number = now_ns + step[0], number + 1
            message = SourceMessage(number, "/scan", now_ns + 1000, step[1])
            ring.add(message, now_ns)
            held.append((now_ns, message))
        elif isinstance(step, int):
            ring.forget_before(now_ns - step)
            held = [one for one in held if one[0] >= now_ns - step]
            given_up = [one for one in given_up if one[0] >= now_ns - step]
        elif step == "ask":
            from_ns = now_ns - 8
            wanted = [message for at_ns, message in held if at_ns >= from_ns]
            found = ring.held_since(from_ns)
            assert [one.number for one in ring.given_up_since(from_ns)] == [
                gone for at_ns, gone in given_up if at_ns >= from_ns
            ]
            asked.append((found, wanted))
        elif held:
            oldest = held.pop(0)
            assert ring.give_up_oldest() == oldest
            given_up.append((oldest[0], oldest[1].number))
        assert len(ring) == len(held)
        assert ring.held_bytes >= sum(len(message.payload) for _, message in held)
    for found, wanted in asked:
        assert [(one.number, one.topic, one.stamp_ns, one.payload) for one in found] == wanted


MEASURED = """
import heapq, os, resource, sys
from incidents.incident_runs import recorder_for, recording_rules, trigger

S = 1_000_000_000
# Hz and bytes: images fill the memory first, then give it up to all others.
TOPICS = {"/imu": (195, 324), "/odom": (25.5, 724), "/scan": (40, 2940), "/image": (20, 60_000)}
RULES = recording_rules(f'Record "one" {" ".join(TOPICS)} Before 120 s After 0 s')


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


recorder, sink = recorder_for(RULES, memory_bytes=int(sys.argv[1]), topics=tuple(TOPICS))
before = resident_bytes()
due = [(0.0, topic) for topic in TOPICS]
while due[0][0] < 150:
    at_s, topic = heapq.heappop(due)
    rate_hz, size_bytes = TOPICS[topic]
    heapq.heappush(due, (at_s + 1 / rate_hz, topic))
    recorder.on_message(topic, int(at_s * S), os.urandom(size_bytes))
taken = resident_bytes() - before
recorder.begin(trigger(RULES, 150 * S))
print(taken, sum(len(one.payload) for one in sink.kept[0].messages))
"""


@pytest.mark.full
@pytest.mark.parametrize("memory_bytes", [26_000_000, 160_000_000])
def test_what_is_resident_is_at_most_a_twentieth_more_than_the_memory(memory_bytes: int) -> None:
    command = [sys.executable, "-c", MEASURED, str(memory_bytes)]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    ran = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    taken_bytes, payload_bytes = map(int, ran.stdout.split())
    assert taken_bytes <= 1.05 * memory_bytes
    # Most of it is messages.
    assert payload_bytes >= 0.85 * memory_bytes

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Every source message of a window is in the incident once, or counted among what is missing.

A naive second opinion says which windows there are: a beginning extends the last one or opens another.
"""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from incidents.incident_runs import AMPLE_BYTES, Kept, recorder_for, recording_rules, trigger, windows
from smarttestudo.domain.incident import Missing, MissingReason
from smarttestudo.incidents.sink import Store
from smarttestudo.incidents.topic_ring import SourceMessage

RULES = recording_rules(
    'Record "both" /odom /scan Before 30 ms After 20 ms', 'Record "one" /scan Before 5 ms After 0 ms'
)
MS = 1_000_000
TRIGGER = None

# What happens, each after so many milliseconds: a message of some size, or a trigger.
EVENTS = st.lists(
    st.tuples(
        st.integers(0, 12),
        st.one_of(st.just(TRIGGER), st.tuples(st.sampled_from(("/odom", "/scan")), st.integers(0, 300))),
    ),
    max_size=60,
)


def run(
    events: list[tuple[int, tuple[str, int] | None]], memory_bytes: int, store: Store | None = None
) -> tuple[list[Kept], list[tuple[int, str, int]]]:
    """The incidents, and the messages that came: when, on which topic, their number.

    The incidents have the windows of the second opinion, with the same moments.
    """
    recorder, sink = recorder_for(RULES, memory_bytes=memory_bytes, store=store)
    came: list[tuple[int, str, int]] = []
    begun_ms: list[int] = []
    now_ms = 1000
    for pause_ms, event in events:
        now_ms += pause_ms
        if event is TRIGGER:
            begun_ms.append(now_ms)
            recorder.begin(trigger(RULES, now_ms * MS))
        else:
            topic, size = event
            recorder.on_message(topic, now_ms * MS, bytes(size))
            came.append((now_ms * MS, topic, len(came) + 1))
            assert recorder.held_bytes <= memory_bytes or not recorder.held_messages
    recorder.finish((now_ms + 1000) * MS)
    for recording in RULES.blocks[0].recordings:
        before_ms, after_ms = recording.before_ns // MS, recording.after_ns // MS
        found = [
            (one.incident.from_ns, one.to_ns, one.stamps_ns)
            for one in sink.kept
            if one.incident.recording is recording
        ]
        assert found == [
            (
                (moments_ms[0] - before_ms) * MS,
                (moments_ms[-1] + after_ms) * MS,
                [one * MS for one in moments_ms],
            )
            for moments_ms in windows(begun_ms, before_ms, after_ms)
        ]
    return sink.kept, came


@given(EVENTS)
def test_with_ample_memory_all_of_the_window_is_there_once_and_nothing_is_missing(
    events: list[tuple[int, tuple[str, int] | None]],
) -> None:
    kept, came = run(events, AMPLE_BYTES)
    for one in kept:
        incident = one.incident
        wanted = [
            number
            for at_ns, topic, number in came
            if topic in incident.recording.topics and incident.from_ns <= at_ns <= one.to_ns
        ]
        assert [message.number for message in one.messages] == wanted
        assert one.missing == ()


@given(EVENTS, st.integers(0, 6000))
def test_what_memory_cannot_hold_is_counted_with_its_times(
    events: list[tuple[int, tuple[str, int] | None]], memory_bytes: int
) -> None:
    kept, came = run(events, memory_bytes)
    for one in kept:
        incident = one.incident
        numbers = [message.number for message in one.messages]
        assert numbers == sorted(set(numbers))
        assert one.missing is not None
        gone: dict[str, list[Missing]] = {}
        for missing in one.missing:
            assert missing.reason is MissingReason.MEMORY
            gone.setdefault(missing.topic, []).append(missing)
        for topic in incident.recording.topics:
            lacking = [
                at_ns
                for at_ns, name, number in came
                if name == topic and incident.from_ns <= at_ns <= one.to_ns and number not in numbers
            ]
            parts = gone.get(topic, [])
            assert sum(part.messages or 0 for part in parts) == len(lacking)
            if parts:
                assert (parts[0].from_ns, parts[-1].to_ns) == (lacking[0], lacking[-1])


@given(EVENTS, st.integers(0, 6000))
def test_what_memory_cannot_hold_is_stored_once_for_as_long_as_a_window_may_ask_for_it(
    events: list[tuple[int, tuple[str, int] | None]], memory_bytes: int
) -> None:
    stored: dict[int, tuple[SourceMessage, int]] = {}

    def store(message: SourceMessage, until_ns: int, now_ns: int) -> None:
        assert message.number not in stored
        assert now_ns <= until_ns
        stored[message.number] = message, until_ns

    kept, came = run(events, memory_bytes, store)
    for one in kept:
        incident = one.incident
        held = {message.number for message in one.messages}
        for at_ns, topic, number in came:
            is_asked_for = topic in incident.recording.topics and incident.from_ns <= at_ns <= one.to_ns
            if is_asked_for and number not in held:
                message, until_ns = stored[number]
                assert (message.topic, message.stamp_ns) == (topic, at_ns)
                assert until_ns >= incident.trigger.stamp_ns
                assert number in {gone.number for gone in one.given_up[topic]}

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

from incidents.incident_runs import recorder_for, recording_rules, rules_of, trigger
from smarttestudo.domain.incident import MissingReason
from smarttestudo.incidents.missing import unsubscribed
from smarttestudo.incidents.recorder import MAX_OPEN_INCIDENTS
from smarttestudo.incidents.topic_ring import HeldMessage
from smarttestudo.language.rule_set import RuleSet

S = 1_000_000_000
MS = 1_000_000
RULES = recording_rules('Record "near miss" /scan Before 10 s After 5 s')


def many_rules(count: int) -> RuleSet:
    return rules_of(
        "\n".join(
            f'Rule "r{number}" If CheckValue /odom speed > {number + 1} Then '
            f'Record "n{number}" /scan Before 10 s After 5 s EndIf'
            for number in range(count)
        )
    )


def test_overlapping_incidents_of_fifty_rules_are_all_whole() -> None:
    rules = many_rules(50)
    recorder, sink = recorder_for(rules)
    for tick in range(400):
        now_ns = 100 * S + tick * S // 10
        recorder.on_message("/scan", now_ns, b"%d" % tick)
        if 200 <= tick < 300 and tick % 2 == 0:
            recorder.begin(trigger(rules, now_ns, tick // 2 - 100))
    recorder.finish(200 * S)
    assert len(sink.kept) == 50
    assert {len(one.messages) for one in sink.kept} == {151}
    # One message takes its memory once, whether it came before a trigger or after it.
    messages = [message for one in sink.kept for message in one.messages]
    held = [message for message in messages if isinstance(message, HeldMessage)]
    assert len({id(block) for message in held for block in message.blocks.blocks}) == 1
    assert len({id(one.payload) for one in messages if not isinstance(one, HeldMessage)}) <= 400
    assert recorder.refused == 0


def test_no_more_windows_are_open_than_can_be_written() -> None:
    rules = many_rules(MAX_OPEN_INCIDENTS + 3)
    recorder, sink = recorder_for(rules)
    for number in range(MAX_OPEN_INCIDENTS + 3):
        recorder.begin(trigger(rules, 100 * S + number, number))
    assert len(sink.kept) == MAX_OPEN_INCIDENTS
    assert recorder.refused == 3


def test_a_rule_that_flickers_on_has_an_incident_of_ten_windows_and_then_another() -> None:
    recorder, sink = recorder_for(RULES)
    for second in range(100, 300):
        recorder.on_message("/scan", second * S, b"%d" % second)
        if second >= 110:
            recorder.begin(trigger(RULES, second * S))
    recorder.finish(400 * S)
    # The first window began 10 s before 110, and ends 5 s after the last moment within 150 s of that.
    assert [(one.stamps_ns[0] // S, one.stamps_ns[-1] // S) for one in sink.kept] == [(110, 245), (246, 299)]
    assert [(one.incident.from_ns // S, one.to_ns // S) for one in sink.kept] == [(100, 250), (236, 304)]
    assert [len(one.messages) for one in sink.kept] == [151, 64]


@pytest.mark.parametrize(("gap_s", "incidents"), [(0.2, 1), (0.5, 1), (0.51, 2)])
def test_a_window_without_an_after_is_extended_by_what_begins_within_half_a_second(
    gap_s: float, incidents: int
) -> None:
    rules = recording_rules('Record "past" /scan Before 10 s After 0 s')
    recorder, sink = recorder_for(rules)
    times_ns = [round((100 + gap_s * number) * S) for number in range(4)]
    recorder.on_message("/scan", times_ns[0] - 1, b"before")
    for at_ns in times_ns[:2]:
        recorder.on_message("/scan", at_ns - MS, b"between")
        recorder.begin(trigger(rules, at_ns))
        recorder.on_message("/scan", at_ns + MS, b"after")
    recorder.advance(200 * S)
    assert len(sink.kept) == incidents
    # The last message came after the last window.
    assert [message.payload for message in sink.kept[-1].messages][-1] == b"between"
    assert sink.kept[-1].to_ns == times_ns[1]


def test_a_reload_that_leaves_a_rule_as_it_is_leaves_its_open_window_to_be_extended() -> None:
    other = 'Rule "other" If CheckValue /odom speed > 9 Then SetFrequency /scan 9 EndIf\n'
    text = (
        'Rule "near" If CheckValue /odom speed > 1 Then Record "near miss" /scan Before 10 s After 5 s EndIf'
    )
    longer = text.replace("After 5 s", "After 6 s")
    before, moved, changed = rules_of(text), rules_of(other + text), rules_of(longer)
    recorder, sink = recorder_for(before)
    recorder.begin(trigger(before, 100 * S))
    recorder.change_rules(moved)
    recorder.begin(trigger(moved, 102 * S, 1))
    recorder.change_rules(changed)
    recorder.begin(trigger(changed, 104 * S))
    recorder.finish(200 * S)
    assert [[stamp_ns // S for stamp_ns in one.stamps_ns] for one in sink.kept] == [[100, 102], [104]]


def test_records_of_one_rule_have_incidents_of_their_own() -> None:
    rules = recording_rules(*2 * ['Record "same" /scan Before 10 s After 5 s'])
    recorder, sink = recorder_for(rules)
    recorder.begin(trigger(rules, 100 * S))
    recorder.begin(trigger(rules, 101 * S))
    recorder.finish(200 * S)
    assert [len(one.stamps_ns) for one in sink.kept] == [2, 2]


def test_a_topic_that_nobody_publishes_is_missing_once_until_the_last_moment() -> None:
    rules = recording_rules('Record "near miss" /scan /odom Before 10 s After 5 s')
    recorder, sink = recorder_for(rules, topics=("/scan",))
    recorder.on_message("/scan", 99 * S, b"scan")
    recorder.begin(trigger(rules, 100 * S))
    recorder.begin(trigger(rules, 102 * S))
    recorder.on_subscribed("/odom", 103 * S, transient_local=False)
    recorder.begin(trigger(rules, 104 * S))
    recorder.finish(200 * S)
    assert sink.kept[0].missing == (
        unsubscribed("/odom", 90 * S, 102 * S, MissingReason.UNPUBLISHED),
        unsubscribed("/odom", 102 * S, 103 * S),
    )


def test_a_window_is_over_right_after_its_last_instant() -> None:
    recorder, sink = recorder_for(RULES)
    recorder.begin(trigger(RULES, 100 * S))
    assert recorder.next_wake_ns == 105 * S + 1
    recorder.on_message("/scan", 105 * S, b"last")
    recorder.advance(105 * S)
    assert sink.kept[0].missing is None
    recorder.advance(105 * S + 1)
    assert sink.kept[0].missing is not None
    assert [message.payload for message in sink.kept[0].messages] == [b"last"]
    assert recorder.next_wake_ns is None


def test_a_clock_that_jumps_back_neither_shortens_nor_lengthens_a_window() -> None:
    recorder, sink = recorder_for(RULES)
    recorder.on_message("/scan", 100 * S, b"before")
    recorder.begin(trigger(RULES, 100 * S))
    for second in (101, 102, 3, 4, 5):
        recorder.on_message("/scan", second * S, b"%d" % second)
    recorder.on_message("/scan", 9 * S, b"after the window")
    assert [message.payload for message in sink.kept[0].messages] == [
        b"before",
        b"101",
        b"102",
        b"3",
        b"4",
        b"5",
    ]


def test_a_jump_ahead_that_is_left_out_neither_shortens_a_window_nor_costs_what_came_before() -> None:
    recorder, sink = recorder_for(RULES)
    recorder.on_message("/scan", 99 * S, b"99")
    recorder.time.leave_out(3600 * S)
    recorder.begin(trigger(RULES, 3700 * S))
    recorder.time.leave_out(3600 * S)
    for second in (7304, 7306):
        recorder.on_message("/scan", second * S, b"%d" % second)
    assert [message.payload for message in sink.kept[0].messages] == [b"99", b"7304"]


def test_latched_messages_and_all_static_frames_are_in_every_incident() -> None:
    rules = rules_of(
        "SetFrequency /map Full\nIf CheckValue /odom speed > 1 Then\n"
        'Record "near miss" /scan Before 10 s After 5 s\nEndIf'
    )
    recorder, sink = recorder_for(rules)
    recorder.on_subscribed("/map", 0, transient_local=True)
    recorder.on_subscribed("/robot/tf_static", 0, transient_local=True)
    recorder.on_subscribed("/unnamed", 0, transient_local=True)
    assert [recorder.keeps(topic) for topic in ("/map", "/robot/tf_static", "/unnamed")] == [
        True,
        True,
        False,
    ]
    recorder.on_message("/map", 1 * S, b"old map", publisher=1)
    recorder.on_message("/map", 2 * S, b"map", publisher=1)
    recorder.on_message("/map", 3 * S, b"other map", publisher=2)
    recorder.on_message("/robot/tf_static", 4 * S, b"frames")
    recorder.begin(trigger(rules, 1000 * S))
    recorder.on_message("/map", 1001 * S, b"new map", publisher=1)
    recorder.finish(2000 * S)
    one = sink.kept[0]
    assert [message.payload for message in one.latched] == [b"map", b"other map", b"frames"]
    assert [message.payload for message in one.messages] == [b"new map"]


def test_memory_is_taken_from_the_topic_that_has_most_of_it() -> None:
    rules = recording_rules('Record "near miss" /scan /odom Before 10 s After 5 s')
    recorder, sink = recorder_for(rules, memory_bytes=50_000)
    for tick in range(50):
        recorder.on_message("/scan", 100 * S + tick, bytes(10_000))
        recorder.on_message("/odom", 100 * S + tick, bytes(10))
    recorder.begin(trigger(rules, 100 * S + 50))
    recorder.finish(110 * S)
    counts = {
        topic: sum(message.topic == topic for message in sink.kept[0].messages)
        for topic in ("/odom", "/scan")
    }
    assert counts["/odom"] == 50
    missing = sink.kept[0].missing
    assert missing is not None
    assert [(one.topic, one.messages) for one in missing if one.reason is MissingReason.MEMORY] == [
        ("/scan", 50 - counts["/scan"])
    ]


def test_what_was_heard_late_or_never_is_named() -> None:
    rules = recording_rules('Record "near miss" /scan /odom Before 10 s After 5 s')
    recorder, sink = recorder_for(rules, topics=())
    recorder.on_subscribed("/scan", 97 * S, transient_local=False)
    recorder.begin(trigger(rules, 100 * S))
    recorder.finish(102 * S)
    assert sink.kept[0].missing is not None
    assert [(one.topic, one.reason, one.from_ns, one.to_ns) for one in sink.kept[0].missing] == [
        ("/scan", MissingReason.LATE, 90 * S, 97 * S),
        ("/odom", MissingReason.UNPUBLISHED, 90 * S, 100 * S),
        ("/odom", MissingReason.ENDED, 102 * S, 105 * S),
        ("/scan", MissingReason.ENDED, 102 * S, 105 * S),
    ]


def test_other_rules_keep_what_was_kept() -> None:
    recorder, sink = recorder_for(RULES)
    recorder.on_message("/scan", 100 * S, b"scan")
    longer = recording_rules('Record "longer" /scan /odom Before 20 s After 5 s')
    recorder.change_rules(longer)
    recorder.begin(trigger(longer, 101 * S))
    assert [message.payload for message in sink.kept[0].messages] == [b"scan"]


def test_a_topic_that_is_silent_is_still_heard_after_a_reload() -> None:
    recorder, sink = recorder_for(RULES)
    recorder.change_rules(RULES)
    recorder.begin(trigger(RULES, 100 * S))
    recorder.finish(200 * S)
    assert sink.kept[0].missing == ()


def test_what_rules_did_not_ask_for_before_a_reload_is_named() -> None:
    recorder, sink = recorder_for(RULES)
    for second in range(100, 131):
        recorder.on_message("/scan", second * S, b"%d" % second)
    longer = recording_rules('Record "longer" /scan Before 30 s After 0 s')
    recorder.change_rules(longer)
    recorder.begin(trigger(longer, 140 * S))
    recorder.finish(141 * S)
    (one,) = sink.kept
    assert [message.payload for message in one.messages] == [b"%d" % second for second in range(120, 131)]
    assert one.missing is not None
    assert [(missing.topic, missing.reason, missing.from_ns, missing.to_ns) for missing in one.missing] == [
        ("/scan", MissingReason.LATE, 110 * S, 120 * S)
    ]


def test_what_the_middleware_lost_is_in_the_windows_that_it_concerns() -> None:
    rule_set = recording_rules('Record "one" /odom Before 1 s After 1 s')
    recorder, sink = recorder_for(rule_set)
    recorder.lose("/odom", 7, 0, 10 * MS)
    recorder.lose("/odom", 3, 2000 * MS, 2500 * MS)
    recorder.lose("/scan", 9, 2000 * MS, 2500 * MS)
    recorder.begin(trigger(rule_set, 3000 * MS))
    recorder.lose("/odom", 2, 3000 * MS, 3500 * MS)
    recorder.lose("/odom", 1, 4500 * MS, 5000 * MS)
    recorder.finish(6000 * MS)
    (one,) = sink.kept
    assert one.missing is not None
    assert [(missing.reason, missing.messages) for missing in one.missing] == [
        (MissingReason.LOST, 3),
        (MissingReason.LOST, 2),
    ]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What flickers is sent six times a minute at most, with a count, and what it said last is always sent."""

from __future__ import annotations

from functools import cache

from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.actions.notices import MOST_A_MINUTE, NoticeThrottle, SentNotice
from smarttestudo.domain.action import ActionDecision, ActionEvent, ActionKind, ActRequest

S = 1_000_000_000
TEXT = ActRequest(kind=ActionKind.NOTIFY, target="far away")


def event(kind: ActionEvent) -> ActionDecision:
    return ActionDecision(t_s=0.0, stamp_ns=0, event=kind, action=TEXT, rule="Far")


def test_a_notice_and_its_end_are_sent_at_once() -> None:
    throttle = NoticeThrottle()
    (begun,) = throttle.offer(event(ActionEvent.BEGIN), 0)
    (ended,) = throttle.offer(event(ActionEvent.END), 5 * S)
    assert (begun.decision.event, begun.count) == (ActionEvent.BEGIN, 1)
    assert (ended.decision.event, ended.count) == (ActionEvent.END, 0)
    assert list(throttle.advance(70 * S)) == []


@cache
def pauses() -> st.SearchStrategy[list[int]]:
    return st.lists(st.sampled_from([0, 1, 3, 20, 61]), min_size=1, max_size=80)


@given(pauses())
@settings(max_examples=200)
def test_six_a_minute_in_order_and_no_beginning_goes_uncounted(pauses: list[int]) -> None:
    throttle = NoticeThrottle()
    sent: list[tuple[int, SentNotice]] = []
    now_s, kind = 0, ActionEvent.END
    begun = 0
    for pause_s in pauses:
        for _ in range(pause_s):
            now_s += 1
            sent += [(now_s, one) for one in throttle.advance(now_s * S)]
        kind = ActionEvent.BEGIN if kind is ActionEvent.END else ActionEvent.END
        begun += kind is ActionEvent.BEGIN
        sent += [(now_s, one) for one in throttle.offer(event(kind), now_s * S)]
    sent += [(now_s + 61, one) for one in throttle.advance((now_s + 61) * S)]
    assert sent[-1][1].decision.event is kind
    assert sum(one.count for _, one in sent) == begun
    for at_s, _ in sent:
        assert sum(at_s <= other_s < at_s + 60 for other_s, _ in sent) <= MOST_A_MINUTE


def test_the_end_of_a_run_sends_what_waits() -> None:
    throttle = NoticeThrottle()
    for _ in range(20):
        list(throttle.offer(event(ActionEvent.BEGIN), 0))
    (last,) = throttle.flush()
    assert last.count == 20 - MOST_A_MINUTE

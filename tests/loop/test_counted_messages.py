# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A budget plans alike whether messages come to the loop, or are paced elsewhere and only counted."""

from __future__ import annotations

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from incidents.incident_runs import rules_of
from pacing.scenarios import seeds
from smarttestudo.domain.observation import ListenersChanged, SourceChanged
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.inputs import ChangeInput, MessageInput, WakeInput
from smarttestudo.loop.relay_loop import RelayLoop

TOPICS = ("/imu", "/odom", "/scan")
RULES = " ".join(
    f"SetFrequency {topic} {rate_hz}" for topic, rate_hz in zip(TOPICS, (50, 10, 0), strict=True)
)


def loop_of(budget_kb_per_s: float) -> RelayLoop:
    loop = RelayLoop(rules_of(RULES), Profile(), 0, budget_kb_per_s=budget_kb_per_s)
    for topic in TOPICS:
        source = SourceChanged(topic=topic, publishers=1, transient_local=False, type_name="")
        loop.handle(ChangeInput(stamp_ns=0, change=source))
    return loop


@settings(max_examples=150)
@given(seeds, st.floats(0.1, 100))
def test_the_rates_and_when_they_change_are_the_same(seed: int, budget_kb_per_s: float) -> None:
    chance, now_ns = random.Random(seed), 0
    here, elsewhere = loop_of(budget_kb_per_s), loop_of(budget_kb_per_s)
    sizes = {topic: int(10 ** chance.uniform(0, 4)) for topic in TOPICS}
    for _ in range(200):
        now_ns += int(10 ** chance.uniform(5, 9.3))
        for loop in (here, elsewhere):
            loop.handle(WakeInput(stamp_ns=now_ns))
        topic = chance.choice(TOPICS)
        if chance.random() < 0.1:
            are_there = chance.random() < 0.5
            change = ListenersChanged(topic=topic, are_there=are_there)
            for loop in (here, elsewhere):
                loop.handle(ChangeInput(stamp_ns=now_ns, change=change))
            continue
        here.handle(MessageInput(now_ns, topic, bytes(sizes[topic]), sizes[topic]))
        elsewhere.count(topic, sizes[topic], now_ns)
        assert here.knowledge.plan == elsewhere.knowledge.plan
        assert here.take_decisions() == elsewhere.take_decisions()


def test_without_a_budget_nothing_is_counted() -> None:
    loop = RelayLoop(rules_of(RULES), Profile(), 0)
    assert not loop.counts_all
    assert loop.count("/imu", 1000, NS_PER_S) == ()
    assert loop.may_leave("/imu")
    assert loop.may_skip("/imu")
    assert loop_of(1.0).counts_all
    assert not loop_of(1.0).may_skip("/imu")

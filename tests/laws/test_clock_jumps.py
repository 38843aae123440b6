# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A clock that jumps: rules with time decide as if it had not, and no alarm is stuck."""

from __future__ import annotations

from random import Random
from types import SimpleNamespace

from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.naive_time import random_condition
from language.evaluator.random_rules import block, rule_file, set_frequency
from smarttestudo.domain.observation import ClockJumped
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Signal
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.loop import RelayLoop
from smarttestudo.loop.inputs import ChangeInput, LoopInput, MessageInput, WakeInput

SIGNALS = [Signal("/p", "x"), Signal("/p", "y"), Signal("/q", "x")]
BORDERS = [0.0, 1.0, 2.0]
VALUES = [-1.0, 0.5, 1.0, 1.5, 3.0, float("nan")]
SETTLE_S = [0.0, 3e-9]
CASES_AN_EXAMPLE = 20
MOST_WAKES = 1000
LATE_NS = 20
"""The longest that a condition remembers here, and more."""

Made = tuple[int, str, float, str, str | None]


class Clocked:
    """A loop on a clock that is ``behind_ns`` behind a time that only goes forward, or ahead of it."""

    def __init__(self, rule_set: RuleSet, profile: Profile, start_ns: int) -> None:
        self.start_ns = start_ns
        self.loop = RelayLoop(rule_set, profile, start_ns)
        self.behind_ns = 0
        self.now_ns = 0
        self.made: list[Made] = []
        self._note()

    def pass_time_to(self, at_ns: int) -> None:
        for _ in range(MOST_WAKES):
            wake_ns = self.loop.next_wake_ns
            if wake_ns is None or self._steady(wake_ns) > at_ns:
                break
            self.now_ns = max(self._steady(wake_ns), self.now_ns)
            self._take(WakeInput(stamp_ns=self._clock_ns))
        else:
            raise AssertionError("an alarm is stuck")
        self.now_ns = at_ns
        self._take(WakeInput(stamp_ns=self._clock_ns))

    def send(self, topic: str, message: object) -> None:
        self._take(MessageInput(self._clock_ns, topic, b"", 0, message))

    def jump_ahead(self, ahead_ns: int) -> None:
        self.behind_ns -= ahead_ns
        self._take(ChangeInput(stamp_ns=self._clock_ns, change=ClockJumped(ahead_ns=ahead_ns)))

    @property
    def _clock_ns(self) -> int:
        return self.start_ns + self.now_ns - self.behind_ns

    def _steady(self, clock_ns: int) -> int:
        return clock_ns - self.start_ns + self.behind_ns

    def _take(self, given: LoopInput) -> None:
        self.loop.handle(given)
        self._note()

    def _note(self) -> None:
        for one in self.loop.take_decisions():
            planned = one.planned
            self.made.append((self.now_ns, one.topic, planned.rate.hz, planned.reason.value, planned.rule))


@given(st.integers(0, 2**32))
@settings(max_examples=50)
def test_rules_with_time_decide_as_if_the_clock_had_not_jumped(seed: int) -> None:
    for case in range(CASES_AN_EXAMPLE):
        random = Random(f"{seed} {case}")
        blocks = [
            block(
                random_condition(random, SIGNALS, BORDERS, depth=random.randint(1, 3)),
                [set_frequency(random.choice(("/a", "/b")), float(number + 2))],
                label=f"block {number}",
                priority=random.choice((None, 1)),
            )
            for number in range(random.randint(1, 4))
        ]
        defaults = [set_frequency(name, 1.0) for name in ("/a", "/b")]
        rule_set = compile_rules([rule_file([*defaults, *blocks])], lambda name: name)
        profile = Profile(settle_s=random.choice(SETTLE_S))
        steady, jumping = (Clocked(rule_set, profile, 1_000_000_000) for _ in range(2))
        at_ns = 0
        for _ in range(random.randint(2, 8)):
            at_ns += random.choice((0, 1, 1, 2, 3, 5))
            for one in (steady, jumping):
                one.pass_time_to(at_ns)
            by_ns = random.choice((1, 2, 5, 1_000, 900_000_000))
            match random.choice(("back", "ahead", None, None)):
                case "back":
                    jumping.behind_ns += by_ns
                case "ahead":
                    jumping.jump_ahead(by_ns)
            topic = random.choice(("/p", "/q"))
            message = SimpleNamespace(x=random.choice(VALUES), y=random.choice(VALUES))
            for one in (steady, jumping):
                one.send(topic, message)
            assert jumping.made == steady.made
        for one in (steady, jumping):
            one.pass_time_to(at_ns + LATE_NS)
        assert jumping.made == steady.made

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Drives a relay loop in virtual time, as a replay does, from rules as text."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace

from smarttestudo.domain.decision import Decision
from smarttestudo.domain.observation import LinkBudget, ListenersChanged, SourceChanged
from smarttestudo.domain.profile import Profile
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.loop import Relayed, RelayLoop
from smarttestudo.loop.inputs import ChangeInput, MessageInput, RulesInput, WakeInput
from smarttestudo.loop.reload import RuleExchange
from smarttestudo.pacing.sample import WhenSlow

MS = 1_000_000
SECOND = 1_000_000_000
ODOMETRY = "nav_msgs/msg/Odometry"


def odometry(x: float, y: float) -> object:
    position = SimpleNamespace(x=x, y=y, z=0.0)
    return SimpleNamespace(pose=SimpleNamespace(pose=SimpleNamespace(position=position)))


def rule_set_of(rules: str) -> RuleSet:
    parsed = parse(rules, "rules.adirf")
    assert not parsed.findings
    return compile_rules([parsed.file], lambda name: name)


class LoopDriver:
    """A loop that starts at time 0, with everything it relayed and decided so far."""

    def __init__(
        self,
        rules: str,
        profile: Profile | None = None,
        when_slow: WhenSlow = WhenSlow.PASS,
        types: dict[str, str] | None = None,
        budget_kb_per_s: float | None = None,
    ) -> None:
        self.rule_set = rule_set_of(rules)
        self.loop = RelayLoop(self.rule_set, profile or Profile(), 0, when_slow, budget_kb_per_s)
        self.relayed: list[Relayed] = []
        self.decisions: list[Decision] = []
        self.now_ns = 0
        self.source("/odom", type_name=ODOMETRY)
        for topic, type_name in (types or {}).items():
            self.source(topic, type_name=type_name)

    def source(
        self, topic: str, *, publishers: int = 1, transient_local: bool = False, type_name: str = ""
    ) -> None:
        change = SourceChanged(
            topic=topic, publishers=publishers, transient_local=transient_local, type_name=type_name
        )
        self.keep(self.loop.handle(ChangeInput(stamp_ns=self.now_ns, change=change)))

    def listeners(self, topic: str, *, are_there: bool) -> None:
        change = ListenersChanged(topic=topic, are_there=are_there)
        self.keep(self.loop.handle(ChangeInput(stamp_ns=self.now_ns, change=change)))

    def reload(self, rules: str, profile: Profile | None = None) -> None:
        self.reload_rule_set(rule_set_of(rules), profile)

    def reload_rule_set(
        self, rule_set: RuleSet, profile: Profile | None = None, prepared: RuleExchange | None = None
    ) -> None:
        given = RulesInput(
            stamp_ns=self.now_ns, rule_set=rule_set, profile=profile or Profile(), prepared=prepared
        )
        self.keep(self.loop.handle(given))

    def budget(self, budget_kb_per_s: float, *, is_measured: bool = False) -> None:
        change = LinkBudget(link_kb_per_s=budget_kb_per_s, is_measured=is_measured)
        self.keep(self.loop.handle(ChangeInput(stamp_ns=self.now_ns, change=change)))

    def wait_until(self, at_ns: int) -> None:
        while (wake_ns := self.loop.next_wake_ns) is not None and wake_ns <= at_ns:
            assert wake_ns >= self.now_ns
            self.now_ns = wake_ns
            self.keep(self.loop.handle(WakeInput(stamp_ns=wake_ns)))
        self.now_ns = at_ns

    def send(
        self, topic: str, at_ns: int, payload: bytes = b"", size_bytes: int = 100, message: object = None
    ) -> None:
        self.wait_until(at_ns)
        self.keep(self.loop.handle(MessageInput(at_ns, topic, payload, size_bytes, message)))

    def drive(self, at_ns: int, x: float, y: float) -> None:
        """An odometry message."""
        self.send("/odom", at_ns, message=odometry(x, y))

    def keep(self, relayed: Iterable[Relayed]) -> None:
        self.relayed += relayed
        self.decisions += self.loop.take_decisions()

    def stamps_of(self, topic: str) -> list[int]:
        return [one.stamp_ns for one in self.relayed if one.topic == topic]

    def rates(self) -> dict[str, float | None]:
        """The rate of each topic now, in Hz; ``None`` is Full."""
        return {topic: planned.rate.to_json() for topic, planned in self.loop.knowledge.plan.items()}

    def log(self) -> list[tuple[float, str, float | None, str, str | None]]:
        """Decisions as (time in s, topic, rate, reason, rule)."""
        return [
            (one.t_s, one.topic, one.planned.rate.to_json(), one.planned.reason.value, one.planned.rule)
            for one in self.decisions
        ]

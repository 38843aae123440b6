# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The same rules again change nothing; other rules at the start are as if they had always been there."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.random_rules import RELAYED, rule_files
from loop.test_step import BORDERS, SIGNALS, SOURCES, START, gaps_ns, messages
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.language.syntax import RuleFile
from smarttestudo.loop import Relayed, RelayLoop
from smarttestudo.loop.inputs import ChangeInput, MessageInput, RulesInput, WakeInput
from smarttestudo.pacing.sample import WhenSlow

TOPICS = (*SOURCES, *RELAYED)
files = rule_files(SIGNALS, BORDERS, max_blocks=4)
profiles = st.builds(
    lambda settle_s, stale_after_s, leader: Profile(
        settle_s=settle_s,
        topics={"/q": TopicProfile(stale_after_s=stale_after_s), "/b": TopicProfile(paced_with=leader)},
    ),
    st.sampled_from([0.0, 0.5]),
    st.sampled_from([None, 0.7]),
    st.sampled_from([None, "/a"]),
)
rules = st.tuples(files, profiles)
ways = st.tuples(st.sampled_from(WhenSlow), st.sampled_from([None, 3.0]))
arrivals = st.tuples(
    st.sampled_from(TOPICS), messages, st.sampled_from([b"", b"\x00\x01\x00\x00" + bytes(8)])
)
changes = st.builds(
    SourceChanged,
    topic=st.sampled_from(TOPICS),
    publishers=st.sampled_from([0, 1]),
    transient_local=st.booleans(),
    type_name=st.sampled_from(["", "tf2_msgs/msg/TFMessage"]),
)
events = st.lists(st.tuples(gaps_ns, st.one_of(st.none(), arrivals, changes)), max_size=25)


Rules = tuple[list[RuleFile], Profile]
Scenario = list[tuple[int, object]]


def compiled(rules: Rules) -> tuple[RuleSet, Profile]:
    files, profile = rules
    return compile_rules(files, lambda name: name), profile


class Driven:
    """A loop and what it did."""

    def __init__(self, rules: Rules, way: tuple[WhenSlow, float | None]) -> None:
        self.loop = RelayLoop(*compiled(rules), START, *way)
        self.relayed: list[Relayed] = []
        self.decisions: list[Decision] = []
        self.keep(())

    def keep(self, relayed: Sequence[Relayed]) -> None:
        self.relayed += relayed
        self.decisions += self.loop.take_decisions()

    def reload(self, rules: Rules, now_ns: int) -> None:
        rule_set, profile = compiled(rules)
        self.keep(self.loop.handle(RulesInput(stamp_ns=now_ns, rule_set=rule_set, profile=profile)))

    def take(self, event: object, now_ns: int) -> None:
        match event:
            case None:
                self.keep(self.loop.handle(WakeInput(stamp_ns=now_ns)))
            case SourceChanged():
                self.keep(self.loop.handle(ChangeInput(stamp_ns=now_ns, change=event)))
            case (str(topic), message, bytes(payload)):
                self.keep(self.loop.handle(MessageInput(now_ns, topic, payload, 500, message)))


@settings(max_examples=80)
@given(rules, ways, events)
def test_reloading_the_same_rules_changes_nothing(
    same: Rules, way: tuple[WhenSlow, float | None], scenario: list[tuple[int, object]]
) -> None:
    first, second = Driven(same, way), Driven(same, way)
    now_ns = START
    for gap_ns, event in scenario:
        now_ns += gap_ns
        for driven in (first, second):
            driven.take(event, now_ns)
            driven.take(None, now_ns)
        second.reload(same, now_ns)
        assert (first.relayed, first.decisions) == (second.relayed, second.decisions)
        assert first.loop.knowledge.plan == second.loop.knowledge.plan


@settings(max_examples=80)
@given(rules, rules, ways, events)
def test_rules_reloaded_at_the_start_are_as_if_they_had_always_been_there(
    before: Rules, after: Rules, way: tuple[WhenSlow, float | None], scenario: list[tuple[int, object]]
) -> None:
    reloaded, fresh = Driven(before, way), Driven(after, way)
    reloaded.reload(after, START)
    assert reloaded.loop.knowledge.plan == fresh.loop.knowledge.plan
    for driven in (reloaded, fresh):
        driven.decisions.clear()
    now_ns = START
    for gap_ns, event in scenario:
        now_ns += gap_ns
        for driven in (reloaded, fresh):
            driven.take(event, now_ns)
        assert (reloaded.relayed, reloaded.decisions) == (fresh.relayed, fresh.decisions)
        assert reloaded.loop.knowledge.plan == fresh.loop.knowledge.plan
        assert reloaded.loop.relays.statistics.keys() == fresh.loop.relays.statistics.keys()


@settings(max_examples=150)
@given(rules, rules, ways, st.tuples(events, events, events))
def test_rules_prepared_beforehand_come_into_force_as_those_that_are_not(
    before: Rules,
    after: Rules,
    way: tuple[WhenSlow, float | None],
    scenarios: tuple[Scenario, Scenario, Scenario],
) -> None:
    earlier, meanwhile, later = scenarios
    both = first, second = Driven(before, way), Driven(before, way)
    now_ns = take_by_each(both, earlier, START)
    rule_set, profile = compiled(after)
    prepared = second.loop.prepare(rule_set)
    now_ns = take_by_each(both, meanwhile, now_ns)
    first.reload(after, now_ns)
    given = RulesInput(stamp_ns=now_ns, rule_set=rule_set, profile=profile, prepared=prepared)
    second.keep(second.loop.handle(given))
    prepared.dismantle()
    assert_alike(first, second, now_ns)
    for event in later:
        now_ns = take_by_each(both, [event], now_ns)
        assert_alike(first, second, now_ns)
    assert second.loop.knowledge.rule_set is rule_set


def take_by_each(both: tuple[Driven, Driven], scenario: Scenario, now_ns: int) -> int:
    """When it is afterwards."""
    for gap_ns, event in scenario:
        now_ns += gap_ns
        for driven in both:
            driven.take(event, now_ns)
    return now_ns


def assert_alike(first: Driven, second: Driven, now_ns: int) -> None:
    assert (first.relayed, first.decisions) == (second.relayed, second.decisions)
    assert list(first.loop.block_states(now_ns)) == list(second.loop.block_states(now_ns))
    assert first.loop.next_wake_ns == second.loop.next_wake_ns

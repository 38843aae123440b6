# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Other rules while the loop runs."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.random_rules import RELAYED, rule_files
from loop.loop_driver import MS, ODOMETRY, SECOND, LoopDriver
from loop.test_step import BORDERS, SIGNALS, SOURCES, START, gaps_ns, messages
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.robot import Payload
from smarttestudo.language.rule_set import RuleSet, compile_rules, fallback_rules
from smarttestudo.language.syntax import RuleFile
from smarttestudo.loop import Relayed, RelayLoop
from smarttestudo.loop.inputs import ChangeInput, MessageInput, RulesInput, WakeInput
from smarttestudo.pacing.sample import WhenSlow

ZONE = """
begin
SetFrequency /scan 2
Rule "zone" If CheckValue /odom pose_x > 5 Then SetFrequency /scan 8 EndIf
end
"""


def stamped(sec: int) -> bytes:
    return b"\x00\x01\x00\x00" + sec.to_bytes(4, "little") + bytes(12)


def in_the_zone() -> LoopDriver:
    driver = LoopDriver(ZONE, types={"/odom": ODOMETRY})
    driver.drive(SECOND, 6.0, 0.0)
    driver.decisions.clear()
    return driver


def test_a_change_says_that_it_was_the_reload_and_which_block_decides() -> None:
    driver = in_the_zone()
    driver.reload(ZONE.replace("/scan 8", "/scan 9"))
    (decision,) = driver.decisions
    assert decision.to_json() == {
        "t": 1.0,
        "stamp_ns": SECOND,
        "topic": "/scan",
        "from_hz": 8.0,
        "to_hz": 9.0,
        "reason": "reload",
        "rule": "zone",
        "line": 4,
        "values": {"/odom pose_x": 6.0},
    }


def test_what_is_known_of_the_robot_survives() -> None:
    driver = in_the_zone()
    driver.reload(
        "begin SetFrequency /scan 2 If CheckValue /odom pose_x > 5.5 Then SetFrequency /imu 8 EndIf end"
    )
    assert driver.rates() == {"/scan": 2, "/imu": 8}
    assert driver.log() == [(1.0, "/scan", 2, "reload", None), (1.0, "/imu", 8, "reload", "block at line 1")]


def test_a_value_that_was_not_read_before_is_unknown_until_the_next_message() -> None:
    driver = in_the_zone()
    driver.reload(ZONE.replace("pose_x", "pose_y"), Profile(settle_s=0.0))
    assert driver.rates() == {"/scan": 8}
    driver.drive(2 * SECOND, 6.0, 0.0)
    assert driver.rates() == {"/scan": 2}


def test_a_topic_that_is_newly_read_is_known_by_type_and_publishers() -> None:
    driver = LoopDriver("begin SetFrequency /scan 2 end")
    driver.reload("begin SetFrequency /odom 3 end")
    driver.source("/odom", type_name=ODOMETRY)
    driver.reload(ZONE, Profile(settle_s=0.0))
    driver.source("/odom", publishers=0)
    driver.drive(SECOND, 6.0, 0.0)
    assert driver.rates() == {"/scan": 8}
    driver.source("/odom", type_name=ODOMETRY)
    driver.drive(2 * SECOND, 4.0, 0.0)
    assert driver.rates() == {"/scan": 2}


def test_a_lower_rate_that_waits_goes_on_waiting_where_the_rules_of_its_topic_stay() -> None:
    driver = in_the_zone()
    driver.drive(2 * SECOND, 4.0, 0.0)
    driver.wait_until(2300 * MS)
    driver.reload(f"// a comment that moves all lines\n{ZONE.replace('begin', 'begin SetFrequency /imu 1')}")
    assert driver.log() == [(2.3, "/imu", 1, "reload", None)]
    driver.wait_until(3 * SECOND)
    assert driver.log()[1:] == [(2.5, "/scan", 2, "default", None)]


def test_a_lower_rate_goes_on_waiting_where_a_block_without_a_name_moves() -> None:
    rules = ZONE.replace('Rule "zone" ', "")
    driver = LoopDriver(rules, types={"/odom": ODOMETRY})
    driver.drive(SECOND, 6.0, 0.0)
    driver.drive(2 * SECOND, 4.0, 0.0)
    driver.wait_until(2300 * MS)
    driver.reload(rules.replace("begin", "begin\nSetFrequency /imu 1"))
    driver.wait_until(2499 * MS)
    assert driver.rates() == {"/scan": 8, "/imu": 1}
    driver.wait_until(3 * SECOND)
    assert driver.rates() == {"/scan": 2, "/imu": 1}


def test_a_lower_rate_of_new_rules_holds_at_once() -> None:
    driver = in_the_zone()
    driver.reload(ZONE.replace("/scan 8", "/scan 4"))
    assert driver.rates() == {"/scan": 4}


def test_a_topic_that_is_no_longer_relayed_ends_and_one_that_comes_back_starts() -> None:
    driver = LoopDriver("begin SetFrequency /scan 1 SetFrequency /imu 5 end")
    driver.decisions.clear()
    for step in range(5):
        driver.send("/scan", step * 100 * MS)
    driver.reload("begin SetFrequency /imu 5 end")
    (ended,) = driver.decisions
    assert (ended.topic, ended.to_json()["to_hz"], ended.to_json()["end"]) == ("/scan", 0.0, True)
    assert list(driver.loop.relays.statistics) == ["/imu"]
    driver.send("/scan", SECOND)
    driver.wait_until(9 * SECOND)
    assert driver.stamps_of("/scan") == [0]
    driver.reload("begin SetFrequency /scan Full SetFrequency /imu 5 end")
    assert driver.decisions[1].to_json()["start"] is True
    driver.send("/scan", 10 * SECOND)
    assert driver.stamps_of("/scan") == [0, 10 * SECOND]


def test_a_full_topic_loses_no_message_and_a_paced_one_keeps_its_grid_through_500_reloads() -> None:
    driver = LoopDriver("begin SetFrequency /scan Full SetFrequency /imu 10 SetFrequency /a 1 end")
    for step in range(1000):
        driver.send("/scan", step * 10 * MS, payload=b"%d" % step)
        driver.send("/imu", step * 10 * MS + MS)
        if step % 2:
            block = f"If CheckValue /imu rate > {step} Then SetFrequency /t{step % 3} 1 EndIf"
            driver.reload(f"begin SetFrequency /scan Full SetFrequency /imu 10 {block} end")
    scans = [one.payload for one in driver.relayed if one.topic == "/scan"]
    assert scans == [b"%d" % step for step in range(1000)]
    assert abs(len(driver.stamps_of("/imu")) - 100) <= 1
    assert driver.loop.relays.statistics["/scan"].arrived.messages == 1000


def test_a_latched_topic_is_still_known_to_be_latched() -> None:
    driver = LoopDriver("begin SetFrequency /map 0.01 end")
    driver.source("/map", transient_local=True)
    driver.reload("begin SetFrequency /map 0.02 end", Profile(topics={"/map": TopicProfile(paced_with="/x")}))
    for step in range(5):
        driver.send("/map", step * 2 * SECOND)
    assert len(driver.relayed) == 5


def test_partners_may_be_paired_and_parted() -> None:
    rules = "begin SetFrequency /info 20 SetFrequency /image 5 end"
    paired = Profile(topics={"/info": TopicProfile(paced_with="/image")})
    driver = LoopDriver(rules)

    def play(start_s: int) -> tuple[list[Payload], list[Payload]]:
        driver.relayed.clear()
        for step in range(40):
            payload = stamped(start_s * 1000 + step)
            driver.send("/info", start_s * SECOND + step * 50 * MS, payload)
            driver.send("/image", start_s * SECOND + step * 50 * MS + MS, payload)
        driver.wait_until((start_s + 5) * SECOND)
        of = {
            name: [one.payload for one in driver.relayed if one.topic == name] for name in ("/info", "/image")
        }
        return of["/info"], of["/image"]

    play(0)
    driver.reload(rules, paired)
    infos, images = play(10)
    assert infos == images
    # Two seconds of the pause before are made up for.
    assert 9 <= len(images) <= 9 + 12
    driver.reload(rules)
    infos, images = play(20)
    # Two seconds of the pause before are made up for.
    assert 9 <= len(images) <= 9 + 12
    assert len(infos) >= 39
    assert driver.loop.relays.discarded == {}


def test_another_profile_says_when_repeating_ends() -> None:
    driver = LoopDriver("begin SetFrequency /scan 10 end", when_slow=WhenSlow.REPEAT)
    driver.reload(
        "begin SetFrequency /scan 10 end", Profile(topics={"/scan": TopicProfile(stale_after_s=0.5)})
    )
    driver.send("/scan", SECOND)
    driver.wait_until(9 * SECOND)
    assert driver.stamps_of("/scan")[-1] <= 1500 * MS


def test_a_budget_holds_for_the_topics_that_are_relayed_now() -> None:
    driver = LoopDriver("begin SetFrequency /a Full SetFrequency /b Full end", budget_kb_per_s=10.0)
    for step in range(500):
        for topic in ("/a", "/b"):
            driver.send(topic, step * 20 * MS, size_bytes=200)
    assert driver.rates() == {"/a": pytest.approx(25, abs=1), "/b": pytest.approx(25, abs=1)}
    driver.reload("begin SetFrequency /b Full end")
    assert driver.rates() == {"/b": None}


def test_without_rules_every_topic_is_full_and_topics_may_join() -> None:
    driver = LoopDriver("begin SetFrequency /scan 2 end")
    driver.decisions.clear()
    for topics in (["/scan"], ["/scan", "/imu"]):
        driver.reload_rule_set(fallback_rules(dict.fromkeys(topics, Rate.full())))
    assert driver.log() == [(0.0, "/scan", None, "fallback", None), (0.0, "/imu", None, "fallback", None)]
    driver.reload("begin SetFrequency /scan 2 end")
    assert [(one.topic, one.planned.reason.value, one.is_end) for one in driver.decisions[2:]] == [
        ("/imu", "reload", True),
        ("/scan", "reload", False),
    ]


def test_a_clock_that_steps_back_after_a_reload_shows_the_time_that_it_shows_without_one() -> None:
    robots = [LoopDriver("begin SetFrequency /scan 10 end") for _ in range(2)]
    for robot, is_reloaded in zip(robots, (False, True), strict=True):
        robot.send("/scan", 5)
        if is_reloaded:
            robot.reload("begin SetFrequency /scan 10 end")
        robot.keep(robot.loop.handle(MessageInput(3, "/scan", b"", 100)))
        robot.keep(robot.loop.handle(WakeInput(stamp_ns=8)))
        robot.now_ns = 8
        robot.reload("begin SetFrequency /scan 20 end")
    assert robots[0].decisions == robots[1].decisions
    assert robots[0].decisions[-1].t_s == 10e-9, "5 ns, none for the way back, then 5 ns"


def test_the_end_of_a_topic_is_decided_when_it_ends() -> None:
    robot = LoopDriver("begin SetFrequency /scan 10 end")
    robot.send("/scan", 4 * SECOND)
    robot.reload("begin SetFrequency /odom 10 end")
    assert {one.t_s for one in robot.decisions if one.is_end} == {4.0}


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

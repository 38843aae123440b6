# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that bound the receiver's estimate: which bound holds when, and the bound as a law of the loop."""

from __future__ import annotations

import math
from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st

from loop.loop_driver import MS, SECOND, LoopDriver, rule_set_of
from pacing.reckoning.ros_messages import NO_TWIST, ODOMETRY, odometry, planar
from smarttestudo.domain.decision import Decision, Reason
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import Profile
from smarttestudo.loop import Relayed, RelayLoop
from smarttestudo.loop.inputs import ChangeInput, MessageInput, RulesInput, WakeInput
from smarttestudo.pacing.cdr import PoseReader
from smarttestudo.pacing.reckoning.motion import Twist, Vector3

ALWAYS = """
begin
    SetFrequency /odom Full
    KeepWithin /odom position 0.1
end
"""
ZONES = """
begin
    SetFrequency /odom Full
    KeepWithin /odom position 0.5
    Rule "near" If CheckValue /battery level < 50 Then KeepWithin /odom position 0.1 EndIf
    Rule "dock" Priority 5 If CheckValue /battery level < 20 Then KeepWithin /odom position 0.2 EndIf
end
"""


def battery(percent: float) -> object:
    return SimpleNamespace(percentage=percent)


class BoundLoop:
    """A loop that is given odometry, with the receiver's last position."""

    def __init__(self, rules: str) -> None:
        self.loop = RelayLoop(rule_set_of(rules), Profile(), 0)
        self.now_ns = 0
        self.shown: float | None = None
        self.decisions: list[Decision] = self.loop.take_decisions()
        for topic, type_name in (("/odom", ODOMETRY), ("/battery", "sensor_msgs/msg/BatteryState")):
            change = SourceChanged(topic=topic, publishers=1, transient_local=False, type_name=type_name)
            self._keep(self.loop.handle(ChangeInput(stamp_ns=0, change=change)))

    @property
    def bounds(self) -> dict[str, float]:
        return dict(self.loop.knowledge.plan["/odom"].within)

    @property
    def reasons(self) -> dict[str, tuple[str, str | None]]:
        decided = self.loop.knowledge.plan["/odom"].bound_reasons
        return {name: (one.reason.value, one.rule) for name, one in decided.items()}

    @property
    def lines(self) -> dict[str, int | None]:
        return {name: one.line for name, one in self.loop.knowledge.plan["/odom"].bound_reasons.items()}

    def odometry(self, at_ns: int, x: float) -> bool:
        self._wake_until(at_ns)
        payload = odometry(at_ns + 1, planar(x, 0, 0), NO_TWIST)
        relayed = self.loop.handle(MessageInput(at_ns, "/odom", payload, len(payload)))
        self._keep(relayed)
        return any(one.payload is payload for one in relayed)

    def battery(self, at_ns: int, percent: float) -> None:
        self._wake_until(at_ns)
        self._keep(self.loop.handle(MessageInput(at_ns, "/battery", b"", 0, battery(percent))))

    def reload(self, rules: str) -> None:
        given = RulesInput(stamp_ns=self.now_ns, rule_set=rule_set_of(rules), profile=Profile())
        self._keep(self.loop.handle(given))

    def _wake_until(self, at_ns: int) -> None:
        while (wake_ns := self.loop.next_wake_ns) is not None and wake_ns <= at_ns:
            self._keep(self.loop.handle(WakeInput(stamp_ns=max(wake_ns, self.now_ns))))
        self.now_ns = at_ns

    def _keep(self, relayed: object) -> None:
        assert isinstance(relayed, list | tuple)
        self.decisions += self.loop.take_decisions()
        for one in relayed:
            assert isinstance(one, Relayed)
            if one.topic == "/odom":
                read = PoseReader(2, has_twist=True).read(one.payload[:])
                assert read is not None
                self.shown = read[1][0]


def test_the_tightest_bound_of_the_highest_priority_holds_and_in_doubt_the_tightest() -> None:
    loop = BoundLoop(ZONES)
    assert loop.bounds == {"position": 0.1}  # The battery is not known: either block may hold.
    loop.battery(SECOND, 80)
    loop.battery(2 * SECOND, 80)
    assert loop.bounds == {"position": 0.5}
    loop.battery(3 * SECOND, 40)
    assert loop.bounds == {"position": 0.1}
    loop.battery(4 * SECOND, 10)
    loop.battery(5 * SECOND, 10)
    assert loop.bounds == {"position": 0.2}


IN_DOUBT = """
begin
    SetFrequency /odom Full
    Rule "low battery" If CheckValue /battery level < 20 Then KeepWithin /odom position 0.05 EndIf
end
"""


def test_a_block_in_doubt_bounds_nothing_that_has_no_bound() -> None:
    loop = BoundLoop(IN_DOUBT)
    assert loop.bounds == {}
    assert all(loop.odometry(number * 20 * MS, 0.0) for number in range(20))
    first = loop.decisions[0].to_json()
    assert (first["reason"], first["rule"]) == ("default", None)
    assert first["bound_reasons"] == {"position": {"reason": "unknown", "rule": "low battery", "line": 4}}
    loop.battery(SECOND, 80)
    assert (loop.bounds, loop.reasons) == ({}, {})


def test_with_a_bound_of_one_property_the_doubt_about_another_counts_too() -> None:
    loop = BoundLoop(IN_DOUBT.replace("Full", "Full KeepWithin /odom orientation 5", 1))
    assert loop.bounds == {"position": 0.05, "orientation": 5}
    assert loop.reasons == {"position": ("unknown", "low battery"), "orientation": ("default", None)}


def test_the_first_bound_of_a_topic_waits_until_it_has_settled_and_its_end_does_not() -> None:
    loop = BoundLoop(IN_DOUBT)
    loop.battery(SECOND, 80)
    loop.battery(2 * SECOND, 10)
    loop._wake_until(2 * SECOND + 499 * MS)
    assert loop.bounds == {}
    loop._wake_until(2 * SECOND + 500 * MS)
    assert (loop.bounds, loop.reasons) == ({"position": 0.05}, {"position": ("block", "low battery")})
    loop.battery(3 * SECOND, 80)
    assert loop.bounds == {}


def test_a_bound_that_waits_goes_on_waiting_when_the_same_rules_come_again() -> None:
    loop = BoundLoop(ZONES)
    loop.battery(SECOND, 80)
    loop.battery(2 * SECOND, 40)
    loop.battery(3 * SECOND, 80)
    loop.reload(f"\n{ZONES}")
    assert (loop.bounds, loop.lines) == ({"position": 0.1}, {"position": 6})
    loop._wake_until(3 * SECOND + 500 * MS)
    assert loop.bounds == {"position": 0.5}


def test_a_tighter_bound_holds_at_once_and_a_wider_one_when_it_has_settled() -> None:
    loop = BoundLoop(ZONES)
    loop.battery(SECOND, 80)
    loop.battery(2 * SECOND, 40)
    loop.battery(3 * SECOND, 80)
    assert loop.bounds == {"position": 0.1}
    loop._wake_until(3 * SECOND + 499 * MS)
    assert loop.bounds == {"position": 0.1}
    loop._wake_until(3 * SECOND + 500 * MS)
    assert loop.bounds == {"position": 0.5}


def test_decisions_say_where_a_bound_changed_and_which_rule_did_it() -> None:
    loop = BoundLoop(ZONES)
    loop.battery(SECOND, 80)
    loop.battery(2 * SECOND, 40)
    first, *_, last = (one.to_json() for one in loop.decisions)
    assert (first["from_within"], first["to_within"]) == ({}, {"position": 0.1})
    assert (last["from_within"], last["to_within"]) == ({"position": 0.5}, {"position": 0.1})
    assert (last["rule"], last["reason"]) == ("near", Reason.BLOCK.value)
    assert Decision.from_json(last).to_json() == last
    unbound = BoundLoop("begin SetFrequency /odom 10 end").decisions[0].to_json()
    assert "to_within" not in unbound


def test_two_properties_are_bound_at_once_and_each_by_its_own_rules() -> None:
    loop = BoundLoop(
        """begin
        SetFrequency /odom Full
        KeepWithin /odom position 0.5
        If CheckValue /battery level < 50 Then KeepWithin /odom orientation 5 EndIf
        end"""
    )
    assert loop.bounds == {"position": 0.5, "orientation": 5}
    loop.battery(SECOND, 80)
    loop.battery(2 * SECOND, 80)
    assert loop.bounds == {"position": 0.5}


def test_the_floor_is_the_heartbeat() -> None:
    loop = BoundLoop("begin KeepAtLeast /odom 5 KeepWithin /odom position 0.1 end")
    passed = sum(loop.odometry(number * 20 * MS, 1.0) for number in range(500))
    assert passed in (50, 51)


def test_a_receiver_that_comes_later_gets_the_newest_message_at_once() -> None:
    driver = LoopDriver(ALWAYS)
    for number in range(3):
        payload = odometry(1 + number, planar(0, 0, 0))
        driver.keep(driver.loop.handle(MessageInput(number * MS, "/odom", payload, len(payload))))
    before = len(driver.relayed)
    driver.now_ns = 3 * MS
    driver.listeners("/odom", are_there=False)
    driver.listeners("/odom", are_there=True)
    assert len(driver.relayed) == before + 1


def test_a_message_that_cannot_be_read_passes_and_is_counted() -> None:
    driver = LoopDriver(ALWAYS)
    for number in range(3):
        driver.keep(driver.loop.handle(MessageInput(number * MS, "/odom", b"\x00\x01", 2)))
    assert len(driver.relayed) == 3
    assert driver.loop.relays.statistics["/odom"].unreadable == 3


RULES = (
    ALWAYS,
    ZONES,
    "begin SetFrequency /odom Full KeepWithin /odom position 0 end",
    "begin SetFrequency /odom 4 end",
    "begin SetFrequency /odom Full KeepWithin /odom position 0.3 KeepWithin /odom orientation 1 end",
)
events = st.lists(
    st.one_of(
        st.tuples(st.just("odometry"), st.floats(-1, 1)),
        st.tuples(st.just("odometry"), st.sampled_from([0.0, 0.01, -0.01])),
        st.tuples(st.just("battery"), st.sampled_from([10.0, 30.0, 80.0])),
        st.tuples(st.just("rules"), st.sampled_from(RULES)),
    ),
    max_size=30,
)


@given(events, st.lists(st.integers(1, 3 * SECOND), min_size=30, max_size=30))
def test_after_every_message_the_picture_is_within_the_bound_in_force_through_reloads(
    happened: list[tuple[str, float | str]], gaps_ns: list[int]
) -> None:
    loop, x, at_ns = BoundLoop(ALWAYS), 0.0, 0
    for (kind, what), gap_ns in zip(happened, gaps_ns, strict=False):
        at_ns += gap_ns
        if isinstance(what, str):
            loop._wake_until(at_ns)
            loop.reload(what)
        elif kind == "battery":
            loop.battery(at_ns, what)
        else:
            x += what
            loop.odometry(at_ns, x)
            bound = loop.bounds.get("position", math.inf)
            assert loop.shown is not None
            assert abs(loop.shown - x) <= bound


def test_dead_reckoning_sends_little_of_a_robot_that_drives_a_curve() -> None:
    twist = Twist(Vector3(0.5, 0, 0), Vector3(0, 0, 0.1))

    def passed(reckoned: tuple[str, ...]) -> int:
        loop = RelayLoop(rule_set_of(ALWAYS), Profile(), 0, reckoned=reckoned)
        change = SourceChanged(topic="/odom", publishers=1, transient_local=False, type_name=ODOMETRY)
        loop.handle(ChangeInput(stamp_ns=0, change=change))
        count = 0
        for number in range(1000):
            at_ns = number * 20 * MS + 1
            angle = 0.1 * at_ns / SECOND
            pose = planar(5 * math.sin(angle), 5 - 5 * math.cos(angle), angle)
            payload = odometry(at_ns, pose, twist)
            count += len(loop.handle(MessageInput(at_ns, "/odom", payload, len(payload))))
        return count

    assert passed(()) >= 90
    assert passed(("/odom",)) <= 12  # The heartbeat alone.

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop of a run is given what its rules read of the machine and the link, and nothing else."""

from __future__ import annotations

import threading
from collections.abc import Collection, Mapping
from pathlib import Path

import pytest

from robot.memory_link import MemoryLink
from robot.status.virtual_robot import SECOND, VirtualRobot
from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.link import LinkState
from smarttestudo.domain.observation import VitalsMeasured
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.loop.inputs import ChangeInput, WakeInput
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.machine import MachineVitals
from smarttestudo.robot.vitals import LinkVitals, VitalsPart

ALL = ("capacity", "round_trip", "used", "connected", "age")
MEMORY = "CheckValue @machine memory > 50"


def rules_of(condition: str) -> LiveRules:
    text = f"begin SetFrequency /odom 10 If ({condition}) Then SetFrequency /odom 20 EndIf end"
    parsed = parse(text, "rules.adirf")
    assert not parsed.findings
    return LiveRules(rule_set=compile_rules([parsed.file], lambda name: f"/robot{name}"))


class GivenRun:
    """The run as a part sees it, with what the loop was given, by source."""

    def __init__(self, rules: LiveRules) -> None:
        self.rules = rules
        self.loop = RelayLoop(rules.rule_set, rules.profile, 0)
        self.given: list[tuple[str, Mapping[str, float | None]]] = []

    def subscribed_here(self) -> Collection[str]:
        return ()

    def give(self, given: ChangeInput | WakeInput) -> None:
        assert isinstance(given, ChangeInput)
        assert isinstance(given.change, VitalsMeasured)
        self.given.append((given.change.source, given.change.values))
        self.loop.handle(given)

    def note(self, outcome: ActionDecision) -> None:
        raise NotImplementedError


def machine(root: Path) -> MachineVitals:
    (root / "proc").mkdir()
    (root / "proc/meminfo").write_text("MemTotal: 8 kB\nMemAvailable: 2 kB\n", encoding="ascii")
    return MachineVitals(root, root)


def begun(part: VitalsPart, condition: str) -> GivenRun:
    run = GivenRun(rules_of(condition))
    part.follow(run.rules, 0)
    part.begin(run)
    return run


def test_rules_that_read_nothing_of_them_cost_nothing(tmp_path: Path) -> None:
    threads = threading.active_count()
    part = VitalsPart(VirtualRobot(), machine(tmp_path), MemoryLink())
    run = begun(part, "CheckValue /odom speed > 1")
    for _ in range(3):
        part.poll()
    assert run.given == []
    assert threading.active_count() == threads


def test_what_rules_read_of_the_machine_decides(tmp_path: Path) -> None:
    part = VitalsPart(VirtualRobot(), machine(tmp_path), None)
    run = begun(part, MEMORY)
    while not run.given:
        part.poll()
    part.close()
    assert run.given == [("@machine", {"memory": 75.0})]
    decision = run.loop.take_decisions()[-1]
    assert decision.values == {"@machine memory": 75.0}
    assert decision.planned.reason is Reason.BLOCK


def test_rules_that_come_later_are_followed(tmp_path: Path) -> None:
    part = VitalsPart(VirtualRobot(), machine(tmp_path), MemoryLink())
    run = begun(part, "CheckValue @link connected = 1")
    part.poll()
    assert run.given == [("@link", {"connected": 1.0})]
    part.follow(rules_of("CheckValue @link age > 5 AND CheckValue @link used > 90"), 0)
    part.poll()
    assert run.given[1:] == [("@link", {"age": 0.0, "used": None})]


def test_without_a_link_all_of_it_is_unknown_and_that_is_said_once(tmp_path: Path) -> None:
    robot = VirtualRobot()
    part = VitalsPart(robot, machine(tmp_path), None)
    run = begun(part, "CheckValue @link connected = 0")
    part.follow(run.rules, 0)
    part.poll()
    assert run.given == []
    assert robot.log_lines == [
        "the rules read @link, which is unknown without a link: --link or --link-listen makes one"
    ]


def state(*, sent_bytes: int = 0, is_connected: bool = True, capacity: float | None = 50.0) -> LinkState:
    return LinkState(
        is_connected=is_connected,
        capacity_kb_per_s=capacity,
        round_trip_ms=12.3456,
        sent_bytes=sent_bytes,
        silent_s=0.25,
    )


def test_used_is_the_share_of_the_capacity_that_was_sent_since_the_last_time() -> None:
    vitals = LinkVitals()
    assert vitals.read(state(sent_bytes=1000), 0, ALL) == {
        "capacity": 50.0,
        "round_trip": 12.346,
        "used": None,
        "connected": 1.0,
        "age": 0.25,
    }
    assert vitals.read(state(sent_bytes=41_000), 2 * SECOND, ["used"]) == {"used": 40.0}
    assert vitals.read(state(sent_bytes=141_000), 3 * SECOND, ["used"]) == {"used": 100.0}
    assert vitals.read(state(capacity=None), 4 * SECOND, ["used", "capacity"]) == {
        "used": None,
        "capacity": None,
    }


@pytest.mark.parametrize("name", ["capacity", "round_trip", "used"])
def test_nobody_there_leaves_unknown_what_the_link_carries(name: str) -> None:
    vitals = LinkVitals()
    vitals.read(state(), 0, ALL)
    gone = vitals.read(state(sent_bytes=10, is_connected=False), SECOND, ALL)
    assert (gone[name], gone["connected"], gone["age"]) == (None, 0.0, 0.25)

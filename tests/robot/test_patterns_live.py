# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules with patterns and constants in a run, while topics appear and vanish."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from robot.test_fallback import RunningRobot, push, reload
from smarttestudo.domain.decision import AnyDecision, Decision
from smarttestudo.domain.names import STATUS_TOPIC, resolve_topic
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.robot import GraphChange, PollGraph
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.rule_set import fallback_rules
from smarttestudo.loop.input_log import input_log
from smarttestudo.loop.inputs import RecordedInput, RuleTextsInput
from smarttestudo.loop.reload import RuleExchange
from smarttestudo.replays.inputs import replay_inputs
from smarttestudo.robot.output_topics import OutputTopic
from smarttestudo.robot.rules import LiveRuleFiles, RuleWatch
from smarttestudo.robot.run import run_live
from smarttestudo.robot.run_options import RUN_OPTIONS, RunParameters

RULES = fallback_rules({})
SECOND = 1_000_000_000
BATTERY = "sensor_msgs/msg/BatteryState"
PATTERN = "begin SetFrequency /late/* 5 SetFrequency /odom 3 end"
CHARGING = """
begin SetFrequency /odom 3
If (CheckValue /robot/power power_supply_status = POWER_SUPPLY_STATUS_CHARGING)
Then SetFrequency /odom 9 EndIf
end
"""
Steps = Mapping[int, Callable[[RunningRobot], object]]


class PolledRobot(RunningRobot):
    """One whose graph is polled five times a second, as where no changes are reported."""

    def poll_graph(self, poll: PollGraph) -> None:
        def act() -> float:
            poll(GraphChange.UNREPORTED)
            return 0.2

        self.every(0.2, act)


def run(
    rules: str | Path,
    steps: Steps,
    seconds: float = 6,
    note: Callable[[RecordedInput], None] | None = None,
    decided: Sequence[Callable[[Sequence[AnyDecision]], None]] = (),
    **given: ParameterValue,
) -> PolledRobot:
    """A run of so many seconds in no time."""
    robot = PolledRobot(steps, "graph")
    options: dict[str, ParameterValue] = {"output_topic": "/testudo{topic}", **given}
    if isinstance(rules, Path):
        options["rules_file"] = (str(rules),)
    else:
        options["rules_text"] = rules
    run_live(
        RunParameters(robot, RUN_OPTIONS, options),
        robot,
        lambda: robot.steady_ns() >= seconds * SECOND,
        (),
        decided,
        note=note,
    )
    return robot


def joins(
    *topics: str, node: str = "/driver", type_name: str = "std_msgs/msg/String"
) -> Callable[..., object]:
    def step(robot: RunningRobot) -> None:
        for topic in topics:
            robot.joins(topic, f"{node}{topic}".encode(), node=node, type_name=type_name)

    return step


def matched(robot: RunningRobot) -> list[str]:
    return [line for line in robot.lines if "matched by patterns" in line]


def outputs(robot: RunningRobot) -> set[str]:
    """The sources that are published for operators."""
    return {one.topic.removeprefix("/testudo") for one in robot.advertised}


def test_topics_that_appear_are_relayed_and_one_that_vanishes_keeps_its_place() -> None:
    def leaves(robot: RunningRobot) -> None:
        robot.leaves("/late/a", b"/driver/late/a")

    robot = run(PATTERN, {2: joins("/late/a"), 3: leaves, 4: joins("/late/b")})
    assert {line.split(":")[0] for line in robot.lines if "5 Hz (reload)" in line} == {"/late/a", "/late/b"}
    assert not [line for line in robot.lines if "no longer relayed" in line]
    assert len(matched(robot)) == 2


def test_three_hundred_that_appear_together_cost_one_compilation() -> None:
    robot = run(PATTERN, {2: joins(*(f"/late/t{number}" for number in range(300)))})
    assert matched(robot) == [
        "/late/t0 and 299 other topics: there now, and matched by patterns in the rules"
    ]


def test_what_smarttestudo_publishes_and_what_is_hidden_is_never_relayed() -> None:
    def own(robot: RunningRobot) -> None:
        joins(STATUS_TOPIC, node="/other")(robot)
        joins("/late/own", "/late/both", node="/other")(robot)
        joins("/late/both", "/late/_hidden", "/testudo/late/x")(robot)

    robot = run("begin SetFrequency /** 5 end", {2: own})
    relayed = {line.split(":")[0] for line in robot.lines if "5 Hz (" in line}
    assert relayed == {"/cam", "/imu", "/odom", "/scan", "/late/both"}


def test_a_constant_is_known_as_soon_as_the_type_is() -> None:
    notes: list[RecordedInput] = []
    run(CHARGING, {2: joins("/robot/power", type_name=BATTERY)}, note=notes.append)
    first, then = (one for one in notes if isinstance(one, RuleTextsInput))
    assert first.known.topics == {}
    assert then.known.topics == {"/robot/power": BATTERY}
    assert then.known.definitions[BATTERY].constants["POWER_SUPPLY_STATUS_CHARGING"] == 1


def test_recorded_inputs_decide_alike(tmp_path: Path) -> None:
    live: list[AnyDecision] = []
    steps: Steps = {2: joins("/late/a", "/late/b"), 3: joins("/late/c")}
    with input_log(tmp_path / "inputs") as note:
        run(PATTERN, steps, note=note, decided=[live.extend])
    again: list[AnyDecision] = []
    replay_inputs(tmp_path / "inputs", again.extend)
    assert again == live
    assert {one.topic for one in live if isinstance(one, Decision)} == {
        "/odom",
        "/late/a",
        "/late/b",
        "/late/c",
    }


def test_other_rules_are_compiled_by_what_was_seen_and_a_push_that_is_not_kept_is_brought_up_to_date(
    tmp_path: Path,
) -> None:
    path = tmp_path / "rules.adirf"
    path.write_text(PATTERN)
    steps: Steps = {2: push("begin SetFrequency /odom 1 end"), 4: joins("/late/a")}
    robot = run(path, steps, seconds=16)
    assert [line for line in robot.lines if line.startswith("/late/a: 5 Hz (reload)")]

    def renamed(robot: RunningRobot) -> None:
        path.write_text("begin SetFrequency /* 3 end")
        reload(robot)

    path.write_text("begin SetFrequency /odom 1 end")
    other = run(path, {3: renamed})
    assert not [line for line in other.lines if "no longer relayed" in line]


def test_large_rules_are_compiled_anew_in_the_background(tmp_path: Path) -> None:
    blocks = " ".join(
        f"If (CheckValue /odom pose_x > {number}) Then SetFrequency /late/* {number % 9 + 1} EndIf"
        for number in range(1000)
    )
    path = tmp_path / "rules.adirf"
    path.write_text(f"begin SetFrequency /late/* 5 {blocks} end")
    seen = dict[str, str]()
    files = LiveRuleFiles(
        [path],
        None,
        resolve=resolve_topic,
        output_topic=OutputTopic(),
        known=lambda: KnownTypes(topics=dict(seen)),
    )
    first = files.read()
    assert first.rules is not None
    assert first.rules.is_large
    assert first.rules.rule_set.relayed == ()
    watch = RuleWatch(files, first, lambda rules, yield_turn: RuleExchange(RULES, rules, None, yield_turn))
    with watch.running():
        seen["/late/a"] = "std_msgs/msg/String"
        watch.compile_soon(first.rules)
        end_s = time.monotonic() + 60
        while not (compiled := [*watch.compiled()]):
            assert time.monotonic() < end_s
            time.sleep(0.05)
    assert compiled[0].before is first.rules
    assert compiled[0].rules is not None
    assert compiled[0].rules.output_topics == {"/late/a": "/testudo/late/a"}
    assert compiled[0].prepared is not None
    assert compiled[0].prepared.fits(RULES, compiled[0].rules.rule_set)

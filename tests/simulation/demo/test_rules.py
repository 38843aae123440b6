# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of the demo: those of the thesis, and those with bounds."""

from __future__ import annotations

import json
import math
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from made_demos import EXAMPLES, Ran, made_demo
from report.golden_files import assert_reads_as
from simulation.demo.demo_runs import GOLDEN, run_testudo, without_replay
from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.formatter import format_rules
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.simulation.warehouse import warehouse


def _text() -> str:
    return files("smarttestudo.simulation").joinpath("warehouse.adirf").read_text("utf-8")


def _rules() -> RuleSet:
    result = parse(_text(), "warehouse.adirf")
    assert result.findings == ()
    return compile_rules([result.file], resolve_topic)


def test_the_rules_are_those_of_the_evaluation() -> None:
    rules = _rules()

    assert {topic: rate.hz for topic, rate in rules.defaults.items()} == {
        "/odom": 10,
        "/cmd_vel": 7,
        "/scan": 3,
        "/camera/camera_info": 3,
        "/camera/image_raw": 3,
        "/camera/image_raw/compressed": 3,
        "/imu": 10,
        "/joint_states": 3,
        "/tf": 10,
    }
    assert {
        block.label: {topic: rate.hz for topic, rate in block.rates.items()} for block in rules.blocks
    } == {
        "Warehouse Corridor": {"/odom": 4, "/cmd_vel": 4, "/scan": 4},
        "Scaffolding": {"/odom": 10, "/cmd_vel": 10, "/scan": 10, "/camera/image_raw/compressed": 10},
    }


PLACES = st.builds(
    Point,
    st.floats(-14, 15) | st.sampled_from([-13.0, 6.0]),
    st.floats(-9, 26) | st.sampled_from([1.0, 5.4, 6.0, 25.5]),
)


@given(place=PLACES)
@settings(max_examples=200, deadline=None)
def test_each_rule_holds_exactly_in_the_zone_of_its_name(place: Point) -> None:
    rules = _rules()
    evaluator = Evaluator(rules)

    evaluator.set(Signal("/odom", "pose_x"), place.x_m)
    evaluator.set(Signal("/odom", "pose_y"), place.y_m)

    holding = {block.label for block in rules.blocks if evaluator.truth(block.order) is Truth.TRUE}
    assert holding == {zone.name for zone in warehouse().zones if zone.area.contains(place)}


ERRANDS = ("--mission", "examples/errands.mission.toml")
BOUNDING = ("warehouse_within.adirf", "warehouse_predicted.adirf")


@pytest.fixture(scope="module")
def errands(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that a demo of the mission that waits made."""
    return made_demo(tmp_path_factory, *ERRANDS)[0]


@pytest.fixture(scope="module")
def arms(errands: Path) -> dict[tuple[str, str], dict[str, Any]]:
    """What the demo says of /odom, by rules and what the operator's end shows."""
    said = json.loads((errands / "accuracy.json").read_text("utf-8"))
    return {
        (arm["name"], arm["shows"]): arm["topics"]["/odom"] | {"all": arm["bytes"]} for arm in said["arms"]
    }


def _position(arm: dict[str, Any]) -> dict[str, Any]:
    position: dict[str, Any] = arm["properties"]["position"]
    return position


@pytest.mark.parametrize("name", ["warehouse.adirf", *BOUNDING])
def test_the_demo_has_the_example_of_that_name_as_the_formatter_leaves_it(name: str) -> None:
    text = (EXAMPLES / name).read_text("utf-8")

    assert files("smarttestudo.simulation").joinpath(name).read_text("utf-8") == text
    assert format_rules(text, name) == text


@pytest.mark.full
def test_fixed_rates_and_rules_with_bounds_take_the_bytes_of_the_thesis(
    arms: dict[tuple[str, str], dict[str, Any]],
) -> None:
    thesis = arms["warehouse", "hold"]

    fixed, within = arms["fixed rates", "hold"], arms["warehouse_within", "hold"]

    assert fixed["bytes"] == pytest.approx(thesis["bytes"], rel=0.001)
    assert fixed["all"] == pytest.approx(thesis["all"], rel=0.001)
    # Never more, and as many but for what heartbeats and whole messages leave.
    assert 0.98 * thesis["bytes"] < within["bytes"] <= thesis["bytes"]
    assert 0.995 * thesis["all"] < within["all"] <= thesis["all"]


def test_held_within_bounds_the_position_is_half_as_much_off_as_at_fixed_rates(
    arms: dict[tuple[str, str], dict[str, Any]],
) -> None:
    fixed, within = _position(arms["fixed rates", "hold"]), _position(arms["warehouse_within", "hold"])

    assert within["rmse"] <= fixed["rmse"] / 2
    assert within["worst"] <= fixed["worst"] / 2
    assert within["worst"] <= max(within["bounds"])
    assert within["broken"] == 0


def test_reckoned_within_bounds_the_position_is_a_tenth_as_much_off_for_a_sixth_of_the_bytes(
    arms: dict[tuple[str, str], dict[str, Any]],
) -> None:
    fixed, predicted = arms["fixed rates", "hold"], arms["warehouse_predicted", "dead reckoning"]

    assert _position(predicted)["rmse"] <= _position(fixed)["rmse"] / 10
    assert _position(predicted)["worst"] <= max(_position(predicted)["bounds"])
    assert _position(predicted)["broken"] == 0
    assert predicted["bytes"] <= fixed["bytes"] / 6


@pytest.mark.parametrize(("name", "rmse_times"), [("warehouse_within", 2), ("warehouse_predicted", 4)])
def test_as_many_messages_at_a_fixed_rate_and_reckoned_alike_are_farther_off(
    arms: dict[tuple[str, str], dict[str, Any]], name: str, rmse_times: float
) -> None:
    within, fixed = arms[name, "dead reckoning"], arms[f"fixed rates for {name}", "dead reckoning"]

    assert fixed["messages"] == pytest.approx(within["messages"], abs=1)
    assert _position(fixed)["rmse"] >= rmse_times * _position(within)["rmse"]
    assert _position(fixed)["worst"] >= 6 * _position(within)["worst"]


def test_the_bounds_hold_for_every_property_and_view(arms: dict[tuple[str, str], dict[str, Any]]) -> None:
    for (name, _), arm in arms.items():
        for said in arm["properties"].values():
            assert said["broken"] == 0
            assert bool(said["bounds"]) == name.startswith("warehouse_")
            if said["bounds"]:
                assert said["worst"] <= max(said["bounds"])


@pytest.mark.full
def test_the_command_for_any_recording_says_the_same_as_the_demo(tmp_path: Path) -> None:
    demo = tmp_path / "demo"
    assert run_testudo("demo", "--seconds", 10, "--out", demo).code == 0
    within, predicted = (demo / name for name in BOUNDING)
    rules = ("--rules", demo / "warehouse.adirf", "--rules", within)
    command = ("bag", "accuracy", demo / "baseline", *rules, "--predicted", within, "--predicted", predicted)

    ran = run_testudo(*command, "--json")

    said = json.loads((demo / "accuracy.json").read_text("utf-8"))
    assert (ran.code, ran.stderr) == (0, "")
    assert json.loads(ran.stdout) == said | {"bag": str(demo / "baseline")}


def test_the_screen_and_the_report_show_the_ways_beside_each_other(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    errands, ran = made_demo(tmp_path_factory, *ERRANDS)
    page = (errands / "report.html").read_text("utf-8")

    assert (ran.code, ran.stderr) == (0, "")
    assert_reads_as(GOLDEN / "errands.txt", without_replay(ran))
    for text in ("How far the picture of /odom is off", "fixed rates", "warehouse_within", "dead reckoning"):
        assert text in page


@pytest.mark.full
def test_a_robot_that_never_stops_is_held_no_better_within_a_bound_than_at_a_fixed_rate(
    demo_out: Path, whole_demo: Ran, tmp_path: Path
) -> None:
    """As the documentation says of the patrol, where |x′| hardly changes."""
    fixed = tmp_path / "fixed.adirf"
    bounded = tmp_path / "bounded.adirf"
    fixed.write_text("begin SetFrequency /odom 8.5 end")
    bounded.write_text("begin SetFrequency /odom Full KeepWithin /odom position 0.02 end")

    ran = run_testudo(
        "bag", "accuracy", demo_out / "baseline", "--rules", fixed, "--rules", bounded, "--json"
    )

    at_rate, by_rule, within = (arm["topics"]["/odom"] for arm in json.loads(ran.stdout)["arms"])
    assert at_rate["messages"] == pytest.approx(within["messages"], rel=0.01)
    assert abs(by_rule["messages"] - at_rate["messages"]) <= 1
    assert _position(within)["rmse"] == pytest.approx(_position(at_rate)["rmse"], rel=0.05)
    assert _position(within)["worst"] <= 0.02 < _position(at_rate)["worst"]


def test_the_rules_of_the_thesis_are_as_much_off_as_the_measure_of_losses_says(
    errands: Path, arms: dict[tuple[str, str], dict[str, Any]]
) -> None:
    """``bag loss`` integrates the fields of the two recordings, without a picture."""
    ran = run_testudo(
        "bag", "loss", errands / "baseline", errands / "adaptive", "--topics", "/odom", "--json"
    )

    rmse = {one["field"]: one["received"]["hold"]["rmse"] for one in json.loads(ran.stdout)["fields"]}
    by_fields = math.hypot(rmse["pose_x"], rmse["pose_y"])
    assert _position(arms["warehouse", "hold"])["rmse"] == pytest.approx(by_fields, rel=1e-3)


def test_a_mission_that_cannot_be_driven_leaves_nothing(tmp_path: Path) -> None:
    mission = tmp_path / "mission.toml"
    mission.write_text("speed = 3\n")

    ran = run_testudo("demo", "--mission", mission, "--out", tmp_path / "out")

    assert (ran.code, ran.stdout) == (1, "")
    assert ran.stderr.startswith(f"{mission}: error: not the waypoints of a mission; ")
    assert [path.name for path in tmp_path.iterdir()] == ["mission.toml"]

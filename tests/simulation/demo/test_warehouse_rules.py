# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

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


def test_the_rules_are_the_example_of_that_name() -> None:
    examples = Path(__file__).parents[3] / "examples"

    assert (examples / "warehouse.adirf").read_text("utf-8") == _text()


def test_the_rules_are_as_the_formatter_leaves_them() -> None:
    assert format_rules(_text(), "warehouse.adirf") == _text()


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

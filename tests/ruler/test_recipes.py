# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Every recipe of the page is a clean rule file, and does what its first line says."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from smarttestudo.domain.signal import Signal
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.formatter import format_rules
from smarttestudo.rules.rule_sets import check_texts

RECIPES = Path(__file__).parents[2] / "gui" / "src" / "recipes"
CAMERA = "/camera/image_raw/compressed"
FULL = math.inf
Values = dict[str, float]
Rates = dict[str, float]


def evaluator_of(name: str) -> Evaluator:
    return Evaluator(check_texts({name: (RECIPES / name).read_text(encoding="utf-8")}).rule_set)


@pytest.mark.parametrize("path", sorted(RECIPES.glob("*.adirf")), ids=lambda path: path.stem)
def test_a_recipe_is_clean_and_says_what_it_is_for(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert check_texts({path.name: text}).findings == ()
    assert format_rules(text, path.name) == text
    title, _, about = text.splitlines()[0].removeprefix("// ").partition(": ")
    assert title
    assert about.endswith(".")


@pytest.mark.parametrize(
    ("name", "steps"),
    [
        (
            "low_battery.adirf",
            [
                ({"/battery_state level": 80}, {"/scan": 5, CAMERA: 10, "/odom": 10}),
                ({"/battery_state level": 19}, {"/scan": 2, CAMERA: 1, "/odom": 10}),
                ({"/battery_state level": 20}, {"/scan": 5, CAMERA: 10, "/odom": 10}),
            ],
        ),
        (
            "emergency.adirf",
            [
                ({"/scan distance": 2, "/imu roll": 0, "/imu pitch": 0}, {"/odom": 10, "/scan": 5}),
                ({"/scan distance": 0.3}, {"/odom": FULL, "/scan": FULL, "/imu": FULL, "/cmd_vel": FULL}),
                ({"/scan distance": 2}, {"/odom": 10, "/scan": 5, "/imu": 10, "/cmd_vel": 5}),
                ({"/imu pitch": -30}, {"/odom": FULL, "/scan": FULL}),
            ],
        ),
        (
            "corridor.adirf",
            [
                ({"/odom pose_x": 5, "/odom pose_y": 3}, {"/odom": 10, "/scan": 5, CAMERA: 10}),
                ({"/odom pose_y": 1}, {"/odom": 4, "/scan": 2, CAMERA: 2}),
                ({"/odom pose_x": 10}, {"/odom": 10, "/scan": 5, CAMERA: 10}),
            ],
        ),
        (
            "weak_link.adirf",
            [
                ({"/operator/heartbeat rate": 10, "/operator/heartbeat age": 0.1}, {CAMERA: 10, "/scan": 5}),
                ({"/operator/heartbeat rate": 7}, {CAMERA: 1, "/scan": 1, "/odom": 5}),
                ({"/operator/heartbeat rate": 10}, {CAMERA: 10, "/scan": 5, "/odom": 10}),
                ({"/operator/heartbeat age": 0.6}, {CAMERA: 1, "/scan": 1, "/odom": 5}),
            ],
        ),
        (
            "sensor_fault.adirf",
            [
                ({"/scan age": 0.1}, {"/odom": 10, "/diagnostics": 1, CAMERA: 5}),
                ({"/scan age": 1.5}, {"/odom": 30, "/diagnostics": FULL, CAMERA: 15}),
                ({"/scan age": 0}, {"/odom": 10, "/diagnostics": 1, CAMERA: 5}),
            ],
        ),
    ],
)
def test_a_recipe_changes_rates_when_it_says_so(name: str, steps: list[tuple[Values, Rates]]) -> None:
    evaluator = evaluator_of(name)
    for values, rates in steps:
        for signal, value in values.items():
            evaluator.set(Signal.named(signal), value)
        assert {topic: evaluator.request(topic).rate.hz for topic in rates} == rates


def test_in_doubt_no_recipe_monitors_less() -> None:
    for path in RECIPES.glob("*.adirf"):
        rule_set = check_texts({path.name: path.read_text(encoding="utf-8")}).rule_set
        evaluator = Evaluator(rule_set)
        for topic, default in rule_set.defaults.items():
            hz = evaluator.request(topic).rate.hz
            assert hz >= default.hz

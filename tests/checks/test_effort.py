# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Long conditions cost in proportion to their length."""

from __future__ import annotations

import sys
from collections.abc import Callable

import pytest

from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.language.parser import parse


def calls_of(work: Callable[[], object]) -> int:
    """How many functions ``work`` calls, which does not depend on the machine."""
    calls = 0

    def count(_frame: object, event: str, _argument: object) -> None:
        nonlocal calls
        calls += event in {"call", "c_call"}

    sys.setprofile(count)
    try:
        work()
    finally:
        sys.setprofile(None)
    return calls


@pytest.mark.parametrize("joint", ["AND", "OR"])
@pytest.mark.parametrize("operator", ["!=", "=", ">"])
def test_twice_the_checks_of_one_property_cost_about_twice_as_much(joint: str, operator: str) -> None:
    def calls(count: int) -> int:
        condition = f" {joint} ".join(f"CheckValue /odom pose_x {operator} {value}" for value in range(count))
        result = parse(f"begin If ({condition}) Then SetFrequency /imu 5 EndIf end", "long.adirf")
        return calls_of(lambda: check_rules([result], CheckContext()))

    calls(10)
    assert calls(800) < 2.5 * calls(400)


@pytest.mark.parametrize(
    ("head", "part", "tail"),
    [
        ("begin ", "SetFrequency/odom 5 ", "end"),
        ("begin ", "If(CheckValue/odom end>1)ThenSetFrequency/imu 5 ", "end"),
        ("", "beginend", ""),
        ("", "IfThen", ""),
        (
            "begin If (CheckValue /a x > 1 ",
            "AND CheckValue /a property_{} > 1 ",
            ") Then SetFrequency /a 1 end",
        ),
    ],
)
def test_twice_the_text_costs_about_twice_as_much(head: str, part: str, tail: str) -> None:
    def calls(count: int) -> int:
        text = head + "".join(part.format(number) for number in range(count)) + tail
        return calls_of(lambda: check_rules([parse(text, "long.adirf")], CheckContext()))

    calls(10)
    assert calls(400) < 2.5 * calls(200)

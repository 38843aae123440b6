# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of our own node."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping

import pytest

from smarttestudo.domain.parameter import Access, Parameter, ParameterValue
from smarttestudo.domain.robot import Robot
from smarttestudo.robot.ros import open_robot


@pytest.fixture
def robot(in_domain: None) -> Iterator[Robot]:
    with open_robot() as opened:
        yield opened


def test_a_value_on_which_its_acceptance_fails_is_refused_with_the_reason(robot: Robot) -> None:
    def accept(changes: Mapping[str, ParameterValue]) -> None:
        int(str(changes["text"]))

    text = Parameter(name="text", description="A text.", value="1", access=Access.ANYONE)
    robot.declare([text], accept)
    assert robot.set_parameters({"text": "one"}) == {
        "text": "error: unexpected ValueError: invalid literal for int() with base 10: 'one'"
    }
    assert robot.parameters(["text"]) == {"text": "1"}
    assert robot.set_parameters({"text": "2"}) == {}


def test_what_utf_8_cannot_say_is_shown_as_question_marks_and_used_as_it_is(robot: Robot) -> None:
    name = os.fsdecode(b"r\xe9gles.adirf")
    declared = robot.declare(
        [
            Parameter(name="rules", description="Files.", value=(name,), is_final=True),
            Parameter(name="file", description="A file.", value=name, access=Access.NODE),
            Parameter(name="text", description="A text.", value="", access=Access.ANYONE),
        ],
        lambda _changes: None,
    )
    assert declared["rules"] == (name,)
    robot.show("file", f"/{name}")
    assert robot.set_parameters({"text": name}) == {}
    assert robot.parameters(["rules", "file", "text"]) == {
        "rules": ("r?gles.adirf",),
        "file": "/r?gles.adirf",
        "text": "r?gles.adirf",
    }

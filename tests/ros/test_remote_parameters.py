# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of another node, asked for by either data path's node."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator

import pytest

from ros.ros_processes import LINE_TIMEOUT_S, SmallRobot
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.parameter import SilentNodeError, Values
from smarttestudo.domain.remote_robots import RuleTexts
from smarttestudo.domain.robot import DataPathKind, Robot
from smarttestudo.robot.ros import open_robot

NODE = "/smarttestudo"
RULES = "begin SetFrequency imu 10 end"
WAITS = 400


@pytest.fixture(params=[DataPathKind.RCL, DataPathKind.RCLPY])
def node(
    request: pytest.FixtureRequest, domain: int, robot: SmallRobot, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Robot]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with open_robot(name=f"asking_{os.getpid()}", data_path=request.param) as node:
        assert node.data_path.description
        yield node


def answer(node: Robot, ask: Callable[[Callable[[object], None]], None]) -> object:
    """What comes of asking; at least after each wait something is looked at."""
    told: list[object] = []
    ask(told.append)
    for _ in range(WAITS):
        if told:
            break
        node.wait(None, 0.1)
    (one,) = told
    return one


def test_values_refusals_and_silence_come_as_answers(node: Robot, robot: SmallRobot) -> None:
    robot.runtime(RULES, "--topic-prefix", "/tb3_0").line_with("Relaying")
    ours = node.remote_parameters
    end_s = time.monotonic() + LINE_TIMEOUT_S
    # Discovery may bring the node's services later than an answer is waited for.
    while isinstance(answer(node, lambda told: ours.get(NODE, ["rules_hash"], told)), SilentNodeError):
        assert time.monotonic() < end_s, "the node does not answer"
    values = answer(
        node, lambda told: ours.get(NODE, ["rules_in_force", "status_hz", "budget_kb_per_s"], told)
    )
    assert isinstance(values, dict)
    assert (values["status_hz"], values["budget_kb_per_s"]) == (1.0, None)
    texts = RuleTexts.from_text(values["rules_in_force"])
    assert [text for _, text in texts.files] == [RULES]
    assert texts.full_names == {"imu": "/tb3_0/imu"}

    wanted: Values = {"status_hz": 5.0, "rules_hash": "0", "rules_text": "begin"}
    refused = answer(node, lambda told: ours.set(NODE, wanted, told))
    assert isinstance(refused, dict)
    assert refused.keys() == {"rules_hash", "rules_text"}
    assert refused["rules_text"].startswith("rules_text:1:")
    assert answer(node, lambda told: ours.get(NODE, ["status_hz"], told)) == {"status_hz": 5.0}

    assert isinstance(answer(node, lambda told: ours.get("/nobody", ["x"], told)), SilentNodeError)
    nonsense = answer(node, lambda told: ours.get("no name!", ["x"], told))
    assert isinstance(nonsense, RosError)
    assert not isinstance(nonsense, SilentNodeError)

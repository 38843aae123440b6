# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The relays of ``live_cost.py``: SmartTestudo and its rivals."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from live.cases import Topic

ROLES = Path(__file__).parent / "roles.py"
TESTUDO = "import sys; from smarttestudo.cli.main import main; sys.exit(main())"


def role(name: str, topics: Sequence[Topic]) -> list[str]:
    """The command of a role of ``roles.py``."""
    return [sys.executable, str(ROLES), name, json.dumps([topic.to_json() for topic in topics])]


@dataclass(frozen=True, kw_only=True)
class Contender:
    """A relay: its commands for some topics (none where it is not installed), and its node's name."""

    name: str
    node: str
    commands: Callable[[Sequence[Topic], Path], list[list[str]]]


def smarttestudo(*options: str) -> Callable[[Sequence[Topic], Path], list[list[str]]]:
    """``testudo run`` with one rule for each topic."""

    def commands(topics: Sequence[Topic], folder: Path) -> list[list[str]]:
        rates = {topic.name: "Full" if math.isinf(topic.target_hz) else topic.target_hz for topic in topics}
        lines = [f"SetFrequency {name} {rate}" for name, rate in rates.items()]
        rules = folder / "rules.adirf"
        rules.write_text("\n".join(["begin", *lines, "end"]), encoding="utf-8")
        return [[sys.executable, "-c", TESTUDO, "run", "--rules", str(rules), *options]]

    return commands


def plain_rclpy(topics: Sequence[Topic], folder: Path) -> list[list[str]]:  # noqa: ARG001 - needs no file
    """One process with a raw subscription for each topic."""
    return [role("plain_relay", topics)]


def topic_tools(topics: Sequence[Topic], folder: Path) -> list[list[str]]:  # noqa: ARG001 - needs no file
    """One throttle for each topic."""
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    found = [Path(prefix) / "lib" / "topic_tools" / "throttle" for prefix in prefixes if prefix]
    throttle = next((path for path in found if path.exists()), None)
    if throttle is None:
        return []
    return [
        [
            str(throttle),
            "messages",
            topic.name,
            str(min(topic.target_hz, 1e6)),
            f"/testudo{topic.name}",
            "--ros-args",
            "-r",
            f"__node:=throttle_{number}",
        ]
        for number, topic in enumerate(topics)
    ]


CONTENDERS = [
    Contender(name="SmartTestudo", node="smarttestudo", commands=smarttestudo()),
    Contender(
        name="SmartTestudo through librcl",
        node="smarttestudo",
        commands=smarttestudo("--data-path", "librcl"),
    ),
    Contender(
        name="SmartTestudo through rclpy",
        node="smarttestudo",
        commands=smarttestudo("--data-path", "rclpy"),
    ),
    Contender(name="(a) plain rclpy relay", node="plain_relay", commands=plain_rclpy),
    Contender(name="(b) topic_tools throttle", node="throttle_0", commands=topic_tools),
]

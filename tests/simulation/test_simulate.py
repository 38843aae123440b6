# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What testudo simulate says when it starts, and what it does when its machine slept."""

from __future__ import annotations

from collections import Counter

import pytest

from robot.small_graph import SmallGraph
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.messages import CAMERA_TOPICS, RobotMessages
from smarttestudo.simulation.simulate import SimulateRequest, simulate

TYPES = {channel.type_name for channel in RobotMessages().channels.values()}
CAMERA = [RobotMessages().channels[topic] for topic in CAMERA_TOPICS]
HOUR_NS = 3600 * NS_PER_S
TRANSFORMS = "tf2_msgs/msg/TFMessage"


class WithoutWarnings(SmallGraph):
    def warning(self, message: str) -> None:
        pytest.fail(f"warned: {message}")


@pytest.mark.parametrize(
    ("missing", "said"),
    [
        (set(), "Driving the patrol with 9 topics"),
        (
            {TRANSFORMS},
            "Driving the patrol with 7 topics, without /tf, /tf_static "
            "(tf2_msgs/msg/TFMessage is not installed)",
        ),
    ],
)
def test_a_type_that_is_not_installed_is_no_warning(missing: set[str], said: str) -> None:
    graph = WithoutWarnings()
    graph.installed = TYPES - missing
    simulate(SimulateRequest(seconds=1, seed=0, frames=FrameSize.SMALL), graph, lambda: True)
    assert graph.lines == [said]


class Sleeper(SmallGraph):
    """A machine whose clock goes on as one waits, and once by an hour more."""

    def __init__(self, awake_s: int) -> None:
        super().__init__()
        self.installed = TYPES - {channel.type_name for channel in CAMERA}
        self.sleeps_at_ns = awake_s * NS_PER_S
        self.time_ns = 0

    def now_ns(self) -> int:
        return self.time_ns

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        assert wake_ns is not None
        if self.time_ns < self.sleeps_at_ns <= wake_ns:
            wake_ns += HOUR_NS
        self.time_ns = wake_ns


def test_what_a_machine_slept_through_is_not_made_up_for() -> None:
    graph = Sleeper(awake_s=5)
    at_ns: list[int] = []

    def stopped() -> bool:
        at_ns.append(graph.time_ns)
        return graph.time_ns > HOUR_NS + 10 * NS_PER_S

    simulate(SimulateRequest(seconds=None, seed=0, frames=FrameSize.SMALL), graph, stopped)
    assert max(Counter(at_ns).values()) < 10
    slept_s = HOUR_NS / NS_PER_S
    (line,) = [line for line in graph.lines if "Lost" in line]
    assert float(line.split("Lost ")[1].split()[0]) == pytest.approx(slept_s, abs=0.1)

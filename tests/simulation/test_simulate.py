# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What testudo simulate says when it starts."""

from __future__ import annotations

import pytest

from robot.small_graph import SmallGraph
from smarttestudo.demo.simulate import SimulateRequest, simulate
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.messages.messages import RobotMessages

TYPES = {channel.type_name for channel in RobotMessages().channels.values()}
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

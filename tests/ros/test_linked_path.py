# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What goes out over a link and on the graph is open in both places, or in none."""

from __future__ import annotations

import importlib.util

import pytest

from robot.memory_link import MemoryLink
from robot.small_graph import TEXT, SmallGraph
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.link import StreamInfo
from smarttestudo.domain.robot import Publisher, Qos

if importlib.util.find_spec("rclpy") is None:
    pytest.skip("ROS 2 (rclpy) is not installed", allow_module_level=True)

from smarttestudo.robot.ros.linked_node import LinkedPath

# An old lark, which rclpy imports, uses a module of Python that is deprecated.
pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")

UNKNOWN = "new_msgs/msg/New"
QOS = Qos(reliable=True, transient_local=False)


class OpenLink(MemoryLink):
    """Link to an operator who has all types."""

    def __init__(self) -> None:
        super().__init__()
        self.there = SmallGraph()
        self.there.installed = {TEXT, UNKNOWN}

    def advertise(self, stream: StreamInfo) -> Publisher:
        return self.there.advertise(stream.topic, stream.type_name, stream.qos)


def test_a_type_that_is_missing_here_leaves_no_stream_on_the_link() -> None:
    here, link = SmallGraph(), OpenLink()
    path = LinkedPath(here, link, is_local=True)
    with pytest.raises(RosError, match=f"{UNKNOWN} is not installed"):
        path.advertise("/new", UNKNOWN, QOS)
    assert (here.advertised, link.there.advertised) == ([], [])
    path.advertise("/words", TEXT, QOS).publish(b"hello")
    assert here.published == link.there.published == [("/words", b"hello")]

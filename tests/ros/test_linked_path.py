# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What goes out over a link and on the graph is open in both places, or in none."""

from __future__ import annotations

import time

import pytest

from robot.memory_link import MemoryLink
from robot.small_graph import TEXT, SmallGraph
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.link import LinkState, StreamInfo
from smarttestudo.domain.robot import GraphChange, Publisher, Qos
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.linked_node import LinkedPath

UNKNOWN = "new_msgs/msg/New"
QOS = Qos(reliable=True, transient_local=False)
TIMEOUT_S = 120.0


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


@pytest.mark.usefixtures("in_domain")
def test_an_operators_end_that_comes_or_goes_is_a_change_of_the_graph() -> None:
    link = OpenLink()
    looks: list[tuple[bool, GraphChange]] = []
    with open_robot(link=link) as robot:
        robot.poll_graph(lambda graph: looks.append((link.state.is_connected, graph)))
        end_s = time.monotonic() + TIMEOUT_S
        for is_connected in (False, True, False):
            while not looks or looks[-1][1] is not GraphChange.NONE:
                assert time.monotonic() < end_s
                robot.wait(None, 0.1)
            link.state = LinkState(is_connected=is_connected)
            while looks[-1][0] is not is_connected:
                assert time.monotonic() < end_s
                robot.wait(None, 0.1)
            assert looks[-1] == (is_connected, GraphChange.REPORTED)

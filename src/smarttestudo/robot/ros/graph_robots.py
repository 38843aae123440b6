# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that are heard on a ROS graph."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.parameter import Got, SilentNodeError, Values, WasSet
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.remote_robots import GotTopics, HeardStatus
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.domain.status_json import status_from_text
from smarttestudo.domain.visible_topics import topic_types

_TEXT_TYPE = "std_msgs/msg/String"
# Several nodes may publish between two polls, and all share one queue.
_QOS = Qos(reliable=True, transient_local=True, depth=100)


class GraphRobots:
    """The robots that the node ``robot`` hears, as ``RemoteRobots``; all of them share one graph.

    ``steady_s`` is a clock that never jumps. Raises ``RosError``.
    """

    place = STATUS_TOPIC
    remedy = "start `testudo run`, in this version and with the same ROS_DOMAIN_ID"
    problem = None

    def __init__(self, robot: Robot, steady_s: Callable[[], float]) -> None:
        self.heard: dict[str, HeardStatus] = {}
        self.unreadable = 0
        self._robot = robot
        self._steady_s = steady_s
        robot.data_path.subscribe(STATUS_TOPIC, _TEXT_TYPE, _QOS, self._receive)

    @property
    def has_heard_all(self) -> bool:
        """Whether there is a robot, and a status of each that is known to be there was received."""
        # `testudo receive` publishes those of several robots, so the names of nodes do not tell.
        return 0 < len(self.heard) >= len(self._robot.publishers(STATUS_TOPIC))

    def wait(self, timeout_s: float) -> None:
        """Receive what comes, for so long at most."""
        self._robot.wait(None, timeout_s)

    def forget(self, robot_id: str) -> None:
        """Let go of what was heard of a robot."""
        self.heard.pop(robot_id, None)

    def get(self, robot_id: str, names: Sequence[str], got: Got) -> None:
        """The values of parameters; one that the robot does not have is ``None``."""
        elsewhere = self._elsewhere(robot_id)
        if elsewhere is None:
            self._robot.remote_parameters.get(_node(robot_id), names, got)
        else:
            got(elsewhere)

    def set(self, robot_id: str, values: Values, was_set: WasSet) -> None:
        """Have a robot give its parameters these values, each by itself."""
        elsewhere = self._elsewhere(robot_id)
        if elsewhere is None:
            self._robot.remote_parameters.set(_node(robot_id), values, was_set)
        else:
            was_set(elsewhere)

    def topics(self, robot_id: str | None, got: GotTopics) -> None:  # noqa: ARG002 - all share one graph
        """Tell ``got`` the topics that the robots' own nodes publish."""
        try:
            got(topic_types(self._robot))
        except RosError as error:
            got(error)

    def _elsewhere(self, robot_id: str) -> RosError | None:
        """Why a robot with a name cannot be asked: another's node may be called like its own."""
        node = _node(robot_id)
        if node == robot_id or node in {one.node for one in self._robot.publishers(STATUS_TOPIC)}:
            return None
        return SilentNodeError(
            "it is heard here, but its node is not on this ROS graph",
            place=robot_id,
            remedy="use --connect with the endpoint where `testudo receive` listens",
        )

    def _receive(self, payload: Payload, _publisher: Hashable) -> None:
        try:
            message = self._robot.data_path.decode(STATUS_TOPIC, _TEXT_TYPE, payload)
            status = status_from_text(getattr(message, "data", ""))
        except (RosError, ValueError):
            self.unreadable += 1
            return
        self.heard[status.robot_id] = HeardStatus(
            status=status, heard_s=self._steady_s(), size_bytes=len(payload)
        )


def _node(robot_id: str) -> str:
    return robot_id[max(robot_id.find("/"), 0) :]

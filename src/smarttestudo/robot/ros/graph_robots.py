# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that are heard on a ROS graph."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.names import NAME_OPTION, STATUS_TOPIC
from smarttestudo.domain.parameter import Got, SilentNodeError, Values, WasSet
from smarttestudo.domain.remote_robots import GotTopics, HeardStatus
from smarttestudo.domain.robot import Payload, Qos, Robot, topic_types
from smarttestudo.domain.status import status_from_text

_TEXT_TYPE = "std_msgs/msg/String"
# Several nodes may publish between two polls, and all share one queue.
_QOS = Qos(reliable=True, transient_local=True, depth=100)
_DIGITS_OF_RUN = 4
_LOST_AFTER_S = 5.0
_OVER_S = 60.0
"""A run that was silent for so long while another of its id was not is over."""


@dataclass(slots=True, kw_only=True)
class _Run:
    """The last status of a run, since when it is heard, and the id under which it is shown."""

    heard: HeardStatus
    begun_s: float
    robot_id: str


class GraphRobots:
    """The robots that the node ``robot`` hears, as ``RemoteRobots``; all of them share one graph.

    ``steady_s`` is a clock that never jumps. Raises ``RosError``.
    """

    place = STATUS_TOPIC
    remedy = "start `testudo run`, in this version and with the same ROS_DOMAIN_ID"
    problem = None

    def __init__(self, robot: Robot, steady_s: Callable[[], float]) -> None:
        self.heard: Mapping[str, HeardStatus] = {}
        """The last status of each robot, those of one name told apart by a number."""
        self.unreadable = 0
        self._runs: dict[str, dict[str, _Run]] = {}
        """The runs of each id."""
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
        for runs in self._runs.values():
            for number in [number for number, one in runs.items() if one.robot_id == robot_id]:
                del runs[number]
        self._name()

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
        """Why a robot cannot be asked: another's node is, or may be, called like its own."""
        node = _node(robot_id)
        if node != robot_id and node not in {one.node for one in self._robot.publishers(STATUS_TOPIC)}:
            return SilentNodeError(
                "it is heard here, but its node is not on this ROS graph",
                place=robot_id,
                remedy="use --connect with the endpoint where `testudo receive` listens",
            )
        now_s = self._steady_s()
        namesakes = sum(
            one.status.node == node and now_s - one.heard_s < _LOST_AFTER_S for one in self.heard.values()
        )
        if namesakes < 2:
            return None
        return SilentNodeError(
            f"{namesakes} nodes that are heard here are called {node}, and any of them may answer",
            place=robot_id,
            remedy=f"start each with a name of its own, as with {NAME_OPTION}, or use --connect where a "
            "robot is heard over a link",
        )

    def _receive(self, payload: Payload, _publisher: Hashable) -> None:
        try:
            message = self._robot.data_path.decode(STATUS_TOPIC, _TEXT_TYPE, payload)
            status = status_from_text(getattr(message, "data", ""))
        except (RosError, ValueError):
            self.unreadable += 1
            return
        heard = HeardStatus(status=status, heard_s=self._steady_s(), size_bytes=len(payload))
        runs = self._runs.setdefault(status.robot_id, {})
        for number in [number for number, one in runs.items() if heard.heard_s > one.heard.heard_s + _OVER_S]:
            if number != status.run:
                del runs[number]
        begun_s = runs[status.run].begun_s if status.run in runs else heard.heard_s
        runs[status.run] = _Run(heard=heard, begun_s=begun_s, robot_id=status.robot_id)
        self._name()

    def _name(self) -> None:
        """Have each run under an id of its own; one that is silent since another began was its forerunner."""
        named: dict[str, HeardStatus] = {}
        for runs in self._runs.values():
            newest_s = max((one.begun_s for one in runs.values()), default=0.0)
            there = {number: one for number, one in runs.items() if one.heard.heard_s >= newest_s}
            for number, one in there.items():
                status = one.heard.status
                if len(there) > 1:
                    status = replace(status, robot=f"{status.robot}#{number[:_DIGITS_OF_RUN]}")
                one.robot_id = status.robot_id
                named[status.robot_id] = replace(one.heard, status=status)
        self.heard = named


def _node(robot_id: str) -> str:
    return robot_id[max(robot_id.find("/"), 0) :]

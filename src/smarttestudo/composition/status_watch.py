# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the SmartTestudos of a ROS graph say of themselves."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace

from smarttestudo.composition.status_announcer import STATUS_QOS, STATUS_TOPIC
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.status_json import status_from_text

_TEXT_TYPE = "std_msgs/msg/String"
# Several may speak between two looks, and all share one queue.
_QOS = replace(STATUS_QOS, depth=100)


@dataclass(frozen=True, slots=True, kw_only=True)
class HeardStatus:
    """The last status of one SmartTestudo, when it came, and the size of the message that it came in."""

    status: RuntimeStatus
    heard_s: float
    size_bytes: int


class StatusWatch:
    """Listens on ``STATUS_TOPIC``; ``steady_s`` is a clock that never jumps. Raises ``RosError``.

    ``unreadable`` counts what came there and was no status of this version.
    """

    def __init__(self, robot: Robot, steady_s: Callable[[], float]) -> None:
        self.heard: dict[str, HeardStatus] = {}
        self.unreadable = 0
        self._robot = robot
        self._steady_s = steady_s
        robot.data_path.subscribe(STATUS_TOPIC, _TEXT_TYPE, _QOS, self._receive)

    @property
    def has_heard_all(self) -> bool:
        """Whether every SmartTestudo that was discovered was heard, and there is one."""
        nodes = {endpoint.node for endpoint in self._robot.publishers(STATUS_TOPIC)}
        return bool(self.heard) and nodes <= self.heard.keys()

    def _receive(self, payload: Payload, _publisher: Hashable) -> None:
        try:
            message = self._robot.data_path.decode(STATUS_TOPIC, _TEXT_TYPE, payload)
            status = status_from_text(getattr(message, "data", ""))
        except (RosError, ValueError):
            self.unreadable += 1
            return
        self.heard[status.node] = HeardStatus(
            status=status, heard_s=self._steady_s(), size_bytes=len(payload)
        )

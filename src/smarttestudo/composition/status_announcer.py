# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where the status of a live run goes."""

from __future__ import annotations

import json
from collections.abc import Callable

from smarttestudo.composition.diagnostics import diagnostics
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.status_json import status_to_json

STATUS_TOPIC = "/testudo/status"
STATUS_QOS = Qos(reliable=True, transient_local=True, depth=1)
DIAGNOSTICS_TOPIC = "/diagnostics"

_Announce = Callable[[RuntimeStatus], None]


class StatusAnnouncer:
    """Publishes a status on ``STATUS_TOPIC`` and as diagnostics; where one of them fails, it is said once."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        opened = (self._opened(way) for way in (_as_text, _as_diagnostics))
        self._ways = [way for way in opened if way is not None]

    def announce(self, status: RuntimeStatus) -> None:
        """Publish ``status``."""
        self._ways = [way for way in self._ways if self._succeeded(way, status)]

    def _opened(self, way: Callable[[Robot], _Announce]) -> _Announce | None:
        try:
            return way(self._robot)
        except RosError as error:
            self._robot.log.warning(str(error))
            return None

    def _succeeded(self, way: _Announce, status: RuntimeStatus) -> bool:
        try:
            way(status)
        except RosError as error:
            self._robot.log.warning(f"{error}; nothing more is said there")
            return False
        return True


def _as_text(robot: Robot) -> _Announce:
    publish = robot.text_publisher(STATUS_TOPIC, STATUS_QOS)
    return lambda status: publish(json.dumps(status_to_json(status), ensure_ascii=False, allow_nan=False))


def _as_diagnostics(robot: Robot) -> _Announce:
    publish = robot.diagnostics_publisher(DIAGNOSTICS_TOPIC)
    return lambda status: publish(diagnostics(status))

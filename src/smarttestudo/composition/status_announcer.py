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
        self._text = self._opened(_as_text)
        self._diagnostics = self._opened(_as_diagnostics)

    def announce(self, status: RuntimeStatus, *, diagnostics_too: bool = True) -> None:
        """Publish ``status``."""
        self._text = self._said(self._text, status)
        if diagnostics_too:
            self._diagnostics = self._said(self._diagnostics, status)

    def _opened(self, way: Callable[[Robot], _Announce]) -> _Announce | None:
        try:
            return way(self._robot)
        except RosError as error:
            self._robot.log.warning(str(error))
            return None

    def _said(self, way: _Announce | None, status: RuntimeStatus) -> _Announce | None:
        """``way`` as long as it works."""
        try:
            if way is not None:
                way(status)
        except RosError as error:
            self._robot.log.warning(f"{error}; nothing more is said there")
            return None
        return way


def _as_text(robot: Robot) -> _Announce:
    publish = robot.text_publisher(STATUS_TOPIC, STATUS_QOS)
    return lambda status: publish(json.dumps(status_to_json(status), ensure_ascii=False, allow_nan=False))


def _as_diagnostics(robot: Robot) -> _Announce:
    publish = robot.diagnostics_publisher(DIAGNOSTICS_TOPIC)
    return lambda status: publish(diagnostics(status))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions of the page about running robots, and requests to them."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.domain.errors import RosError, TestudoError
from smarttestudo.ruler.robots import push as pushing
from smarttestudo.ruler.robots.checks import RobotChecksAnswer, RobotChecksRequest
from smarttestudo.ruler.robots.history import RobotHistoryAnswer
from smarttestudo.ruler.robots.link import RobotLink
from smarttestudo.ruler.robots.push import (
    ConfirmAnswer,
    LastingAnswer,
    PushAnswer,
    PushedRequest,
    PushPreview,
    PushRequest,
    RobotRequest,
    WriteAnswer,
)
from smarttestudo.ruler.robots.view import RobotStartAnswer, robot_start


class UnknownRobotError(RosError):
    """A robot without any status so far."""


class WatchedRobots:
    """The robots that ``link`` receives statuses of."""

    def __init__(self, link: RobotLink) -> None:
        self._link = link

    def preview(self, request: PushRequest) -> PushPreview:
        """Compare rules with a robot's. Raises ``UnknownRobotError`` and what ``pushing.preview`` does."""
        self._require_known(request.node)
        return pushing.preview(self._link, request)

    def push(self, request: PushRequest) -> PushAnswer:
        """Let a robot follow the rules until they are confirmed; raises like ``preview``."""
        self._require_known(request.node)
        return pushing.push(self._link, request)

    def confirm(self, request: PushedRequest) -> ConfirmAnswer:
        """Let pushed rules hold for good. Raises ``UnknownRobotError`` and ``RosError``."""
        self._require_known(request.node)
        return pushing.confirm(self._link, request)

    def lasting(self, request: RobotRequest) -> LastingAnswer:
        """How long kept rules last. Raises ``UnknownRobotError`` and ``RosError``."""
        self._require_known(request.node)
        return pushing.lasting(self._link, request)

    def write(self, request: PushedRequest) -> WriteAnswer:
        """Have kept rules written to the robot's file. Raises ``UnknownRobotError`` and ``RosError``."""
        self._require_known(request.node)
        return pushing.write(self._link, request)

    def history(self, request: RobotRequest) -> RobotHistoryAnswer:
        """The last hour of a robot. Raises ``UnknownRobotError``."""
        self._require_known(request.node)
        return self._link.history(request.node)

    def checks(self, request: RobotChecksRequest) -> RobotChecksAnswer:
        """The checks and rules of a robot over the last minutes. Raises ``UnknownRobotError``."""
        self._require_known(request.node)
        return self._link.checks(request)

    def start(self, request: RobotRequest) -> RobotStartAnswer:
        """A project from what a robot relays. Raises ``UnknownRobotError``."""
        self._require_known(request.node)
        return robot_start(self._link.seen[request.node].status)

    def topics(self) -> Mapping[str, str]:
        """The types of what robots publish, as far as they can be known now."""
        if not self._link.is_up:
            return {}
        relayed = {
            topic: status.type_name
            for seen in self._link.seen.values()
            for topic, status in seen.status.topics.items()
            if status.type_name is not None
        }
        try:
            return {**relayed, **self._link.topics()}
        except TestudoError:
            # Words to suggest come from the files, too.
            return relayed

    def _require_known(self, node: str) -> None:
        """Nothing is asked of a robot that never spoke."""
        if node not in self._link.seen:
            raise UnknownRobotError(
                f"no status of {node} was received",
                remedy=self._link.remedy,
            )

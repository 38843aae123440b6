# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that can be heard and asked, on a ROS graph or over a link."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.parameter import Got, Values, WasSet
from smarttestudo.domain.status import RuntimeStatus

ANSWER_WITHIN_S = 5.0
"""How long an answer is waited for."""

Topics = Mapping[str, str]
"""The types of topics by their names."""
GotTopics = Callable[[Topics | TestudoError], None]
"""Takes topics, or why nothing is known of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HeardStatus:
    """The last status of a robot's runtime, when it was received, and the mean size of what it travels as.

    Not ``is_present`` where the robot is known to be gone.
    """

    status: RuntimeStatus
    heard_s: float
    size_bytes: int
    is_present: bool = True


class RemoteRobots(Protocol):
    """Robots by their ids (``RuntimeStatus.robot_id``), for one thread; callbacks run within ``wait``.

    ``place`` is where they are listened for. ``unreadable`` counts what came there and was no status of this
    version.
    """

    place: str

    @property
    def remedy(self) -> str:
        """Advice where no robot is heard."""

    @property
    def heard(self) -> Mapping[str, HeardStatus]:
        """Last status of each robot, as heard; a live view."""

    @property
    def unreadable(self) -> int:
        """Count of messages there that were no status of this version."""

    @property
    def has_heard_all(self) -> bool:
        """Whether there is a robot, and a status of each that is known to be there was received."""

    @property
    def problem(self) -> str | None:
        """Why no robot can be heard now; ``None`` where one could be."""

    def wait(self, timeout_s: float) -> None:
        """Receive what comes, for so long at most."""

    def forget(self, robot_id: str) -> None:
        """Let go of what was heard of a robot."""

    def get(self, robot_id: str, names: Sequence[str], got: Got) -> None:
        """The values of parameters; one that the robot does not have is ``None``.

        ``got`` is called once; with a ``SilentNodeError`` where there is no answer in time.
        """

    def set(self, robot_id: str, values: Values, was_set: WasSet) -> None:
        """Have a robot give its parameters these values, each by itself; ``was_set`` is called as ``got``."""

    def topics(self, robot_id: str | None, got: GotTopics) -> None:
        """Ask which topics the own nodes of a robot publish, or of all; ``got`` is called as for ``get``."""

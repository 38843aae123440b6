# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents that robots hold, listed and fetched over a link."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from smarttestudo.domain.errors import LinkError

OUTAGE_NAME = "outage"
OUTAGE_RULE = "(link)"
"""What stands in the place of a rule's name where the link's outage was the reason."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RemoteIncident:
    """An incident on a robot, as its list says; ``name`` is that of its folder.

    ``label`` is the name in the ``Record``, ``rule`` that of the block. Stamps are the robot's clock.
    ``missing`` are the reasons (``MissingReason``) for which messages of the window are not there.
    """

    robot: str
    name: str
    label: str
    rule: str
    triggered_ns: int
    from_ns: int
    to_ns: int
    messages: int
    size_bytes: int
    is_read: bool = False
    missing: tuple[str, ...] = ()

    @property
    def is_outage(self) -> bool:
        """Whether it holds what could not be sent during an outage."""
        return (self.label, self.rule) == (OUTAGE_NAME, OUTAGE_RULE)


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchProgress:
    """How far a fetch is: ``got_bytes`` of ``total_bytes``, those of earlier attempts included.

    ``level_hz`` is the grid of the skeleton that is whole for all topics of small messages: 1, 2, 4 … Hz;
    ``None`` before the first, infinite once all of their messages are there, so that large ones remain.
    ``rate_bytes_per_s`` is that of the last seconds; ``waits_for`` says why nothing comes, where that is so.
    """

    got_bytes: int
    total_bytes: int
    rate_bytes_per_s: float = 0.0
    level_hz: float | None = None
    waits_for: str | None = None


class SilentRobotError(LinkError):
    """A robot is connected and does not answer: it has no incidents to offer, or is still starting."""


OnProgress = Callable[[FetchProgress], None]
"""Takes the progress, a few times a second, on the thread that fetches."""


class RemoteIncidents(Protocol):
    """Robots by their names on the link; calls wait, and may come from any thread."""

    def robots(self, within_s: float) -> Sequence[str]:
        """The robots that are there now, sorted; waits so long until all that were there before are known."""

    @property
    def problem(self) -> str | None:
        """Why no robot can be heard now; ``None`` where one could be."""

    def list(self, robot: str) -> Sequence[RemoteIncident]:
        """The incidents of a robot, oldest first. Raises ``TestudoError``, as ``SilentRobotError``."""

    def fetch(
        self,
        robot: str,
        name: str,
        folder: Path,
        on_progress: OnProgress,
        cancelled: Callable[[], bool],
    ) -> Path | None:
        """Have the incident ``name`` below ``folder``, byte for byte as the robot has it; where it then is.

        Until it is whole it is ``folder/.NAME.partial``, with which another call goes on. ``None`` if
        ``cancelled``, which is asked often, said so first. A robot that leaves is waited for.
        Raises ``TestudoError``.
        """

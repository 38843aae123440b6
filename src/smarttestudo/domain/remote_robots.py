# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that can be heard and asked, on a ROS graph or over a link, and the rules that they follow."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.parameter import Got, Values, WasSet
from smarttestudo.domain.record import from_json, to_json
from smarttestudo.domain.status import RuntimeStatus


class RuleText(NamedTuple):
    """A rule file by its name."""

    name: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleTexts:
    """Rule files with their names, in their order; none while there are no rules.

    ``sha256`` is that of the texts, one after the other. ``full_names`` are those of the topics that the
    texts call otherwise: relative ones, remapped ones, or all of them below a prefix.
    """

    sha256: str = ""
    files: tuple[RuleText, ...]
    full_names: Mapping[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The files as one text with the same meaning."""
        return "\n".join(text for _, text in self.files)

    def to_text(self) -> str:
        """The record as a text of JSON."""
        return json.dumps(to_json(self), ensure_ascii=False)

    @staticmethod
    def from_text(text: str) -> RuleTexts:
        """Rule texts that ``to_text`` wrote. Raises ``ValueError``."""
        try:
            return from_json(RuleTexts, json.loads(text))
        except RecursionError as error:
            raise ValueError(str(error)) from error


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

    ``place`` is where they are listened for. ``unreadable`` counts what arrived there and was no status of
    this version.
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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An incident as the recorder hands it on, and where it goes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import takewhile
from typing import Protocol

from smarttestudo.domain.incident import Missing
from smarttestudo.incidents.topic_ring import GivenUp, IncidentMessage, SourceMessage
from smarttestudo.language.rule_set import RecordRequest
from smarttestudo.loop.step import Trigger

Store = Callable[[SourceMessage, int, int], None]
"""Takes a message that memory gives up, until when a window may ask for it, and the time, both steady."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Incident:
    """Incident that one ``Record`` keeps, as it begins: between two stamps of the clock, both included.

    ``rules_sha256`` is that of the texts of the rules.
    """

    trigger: Trigger
    recording: RecordRequest
    from_ns: int
    to_ns: int
    rules_sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Past:
    """Messages that arrived before a beginning and belong to its incident, in the order of their numbers.

    ``latched`` arrived before the window, which began at the steady time ``from_ns``, and counted then.
    ``given_up`` are those, by topic, that memory did not hold any more; latched ones come first.
    """

    from_ns: int = 0
    latched: Sequence[SourceMessage] = ()
    messages: Iterable[IncidentMessage] = ()
    given_up: Mapping[str, Sequence[GivenUp]] = field(default_factory=dict)

    def latched_of(self, topic: str) -> Iterator[GivenUp]:
        """Messages of a topic among those given up that arrived before the window."""
        return takewhile(lambda message: message.at_ns < self.from_ns, self.given_up[topic])


class IncidentSink(Protocol):
    """Where incidents go; all calls for one incident come in the order of its messages."""

    def begin(self, incident: Incident, past: Past) -> None:
        """A window opened."""

    def extend(self, incident: Incident, trigger: Trigger, to_ns: int, past: Past) -> None:
        """The block of ``incident`` began to hold once more, so that its window is open until ``to_ns``.

        ``past`` are the messages since the window was over, if it was.
        """

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        """Take a message that arrived while the windows of ``incidents`` were open, which keep it."""

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        """The window is over."""

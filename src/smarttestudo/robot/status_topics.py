# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The statuses of a runtime, published as often as requested: on the ROS graph and over a link."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, Protocol

from smarttestudo.domain.errors import RosError, said
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.record import to_json
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.domain.status import MOST_BLOCKS, STATUS_HZ, BlockStatus, RulesInForce, RuntimeStatus
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.diagnostics import diagnostics

if TYPE_CHECKING:
    from smarttestudo.domain.link import OutgoingLink

STATUS_QOS = Qos(reliable=True, transient_local=True, depth=1)
DIAGNOSTICS_TOPIC = "/diagnostics"


class BlockJson(NamedTuple):
    """One block of a status in JSON, as an object and as text."""

    record: dict[str, object]
    text: str

    @classmethod
    def of(cls, block: BlockStatus) -> BlockJson:
        """The JSON of ``block``."""
        record = to_json(block)
        return cls(record, json_text(record, ascii_only=False))


_Announce = Callable[[RuntimeStatus, Sequence[BlockJson]], None]


class StatusPublisher:
    """Publishes a status on ``STATUS_TOPIC``, over ``link`` and as diagnostics.

    If one of them fails, it is logged once.
    """

    def __init__(self, robot: Robot, link: OutgoingLink | None = None) -> None:
        self._robot = robot
        self._text = self._opened(_as_text)
        self._linked: _Announce | None = None if link is None else _as_record(link)
        self._diagnostics = self._opened(_as_diagnostics)

    def announce(
        self, status: RuntimeStatus, blocks: Sequence[BlockJson] = (), *, diagnostics_too: bool = True
    ) -> None:
        """Publish ``status`` with ``blocks``, or its own where there are none of those.

        As diagnostics only with a subscriber, since they are not latched.
        """
        self._text = self._said(self._text, status, blocks)
        self._linked = self._said(self._linked, status, blocks)
        if diagnostics_too and self._robot.local_subscriber_count(DIAGNOSTICS_TOPIC):
            self._diagnostics = self._said(self._diagnostics, status, blocks)

    def _opened(self, way: Callable[[Robot], _Announce]) -> _Announce | None:
        try:
            return way(self._robot)
        except RosError as error:
            self._robot.log.warning(str(error))
            return None

    def _said(
        self, way: _Announce | None, status: RuntimeStatus, blocks: Sequence[BlockJson]
    ) -> _Announce | None:
        """``way`` as long as it works."""
        try:
            if way is not None:
                way(status, blocks)
        except Exception as error:  # noqa: BLE001 - whatever publishing fails of, relaying goes on
            self._robot.log.warning(f"{said(error)}; nothing more is published there")
            return None
        return way


def _as_text(robot: Robot) -> _Announce:
    publish = robot.text_publisher(STATUS_TOPIC, STATUS_QOS, goes_over_link=False)

    def announce(status: RuntimeStatus, blocks: Sequence[BlockJson]) -> None:
        text = json_text(to_json(status), ascii_only=False)
        # In a text of JSON a quote has a backslash before it, so this is nothing but the entry.
        publish(text.replace(_NO_BLOCKS, _NO_BLOCKS[:-1] + ", ".join(one.text for one in blocks) + "]", 1))

    return announce


def _as_record(link: OutgoingLink) -> _Announce:
    def announce(status: RuntimeStatus, blocks: Sequence[BlockJson]) -> None:
        record = to_json(status)
        link.tell({**record, "blocks": [one.record for one in blocks]} if blocks else record)

    return announce


def _as_diagnostics(robot: Robot) -> _Announce:
    publish = robot.diagnostics_publisher(DIAGNOSTICS_TOPIC)
    return lambda status, _: publish(diagnostics(status))


_NO_BLOCKS = '"blocks": []'
# Status publishing is capped at a fifth of a core: messages come first.
_TIMES_ITS_COST = 5
_MOST_BLOCKS_UNWATCHED = 20
"""How many blocks the latched status holds while nobody listens: it costs the same whatever the rules."""
# A period of one second is met by timers that are a little early.
_DIAGNOSIS_AFTER_NS = NS_PER_S * 9 // 10
_UNWATCHED_AFTER_NS = 10 * NS_PER_S - NS_PER_S // 10
"""How old the latched status becomes while nobody needs one: with many topics it costs what relaying does."""


class StatusTimer:
    """Once a second, or ``asked_hz`` times where somebody receives them; diagnostics once a second.

    So a requested rate ends with its subscriber. While nobody receives them, nor ``needs_all``, one comes
    every ten seconds, and at once for other rules in force.
    """

    def __init__(self, robot: Robot, link: OutgoingLink | None = None, *, needs_all: bool = False) -> None:
        self._link = link
        self.asked_hz = STATUS_HZ
        self._robot = robot
        self._needs_all = needs_all
        self._published: tuple[int, RulesInForce] | None = None
        self._diagnosed_ns: int | None = None

    @property
    def period_s(self) -> float:
        """The time from one status to the next."""
        return 1 / self.status_hz

    @property
    def status_hz(self) -> float:
        """How often a status comes now."""
        return self.asked_hz if self.asked_hz <= STATUS_HZ or self._is_watched else STATUS_HZ

    @property
    def most_blocks(self) -> int:
        """How many blocks the status of now holds at most."""
        return MOST_BLOCKS if self._is_watched else _MOST_BLOCKS_UNWATCHED

    @property
    def _is_watched(self) -> bool:
        return (self._link is not None and self._link.is_watched) or bool(
            self._robot.local_subscriber_count(STATUS_TOPIC)
        )

    def is_due(self, steady_ns: int, rules: RulesInForce) -> bool:
        """Whether to publish a status now, with those ``rules``; where it is, it counts as published."""
        if not (self._needs_all or self._is_watched or self._robot.local_subscriber_count(DIAGNOSTICS_TOPIC)):
            published_ns, published_rules = self._published or (-_UNWATCHED_AFTER_NS, rules)
            if steady_ns < published_ns + _UNWATCHED_AFTER_NS and rules == published_rules:
                return False
        self._published = steady_ns, rules
        return True

    def is_diagnosis_due(self, steady_ns: int) -> bool:
        """Whether the status of now is one for diagnostics, too; asked once for each."""
        if self._diagnosed_ns is not None and steady_ns < self._diagnosed_ns + _DIAGNOSIS_AFTER_NS:
            return False
        self._diagnosed_ns = steady_ns
        return True

    def next_s(self, cost_ns: int) -> float:
        """In how many seconds to publish again, if publishing took ``cost_ns`` of CPU time."""
        return max(self.period_s, min(cost_ns * _TIMES_ITS_COST / NS_PER_S, 1 / STATUS_HZ))


class States(Protocol):
    """States of the first blocks, of one moment; ``left_out`` counts the others."""

    @property
    def left_out(self) -> int:
        """How many blocks there are beyond."""

    def __iter__(self) -> Iterator[BlockStatus]: ...


BLOCKS_PER_SLICE = 20
"""How many blocks of a status are made while messages wait: about a millisecond's worth."""
_PAUSE_S = 0.000_5


class StatusReporter:
    """Publishes one status after the other, each in slices between which messages are relayed.

    ``measure`` gives the status of now without its blocks, and the states of those, of which it is given
    how many at most; ``rules`` gives those in force.
    """

    def __init__(
        self,
        robot: Robot,
        publisher: StatusPublisher,
        timer: StatusTimer,
        measure: Callable[[int], tuple[RuntimeStatus, States]],
        rules: Callable[[], RulesInForce],
    ) -> None:
        self._robot = robot
        self._publisher = publisher
        self._timer = timer
        self._measure = measure
        self._rules = rules
        self._open: Iterator[None] | None = None
        self._began_ns = 0
        self._cost_ns = 0
        self._has_failed = False

    def report(self) -> float:
        """Begin a status, or go on with it; returns in how many seconds to do so again."""
        start_ns = time.process_time_ns()
        if self._open is None:
            self._began_ns, self._cost_ns = self._robot.steady_ns(), 0
            self._open = self._slices()
        try:
            is_done = next(self._open, self) is self
        except Exception as error:  # noqa: BLE001 - whatever publishing fails of, relaying goes on
            is_done = True
            if not self._has_failed:
                self._has_failed = True
                self._robot.log.warning(f"{said(error)}; some statuses are missing")
        self._cost_ns += time.process_time_ns() - start_ns
        if not is_done:
            return _PAUSE_S
        self._open = None
        took_s = (self._robot.steady_ns() - self._began_ns) / NS_PER_S
        return max(self._timer.next_s(self._cost_ns) - took_s, _PAUSE_S)

    def _slices(self) -> Iterator[None]:
        if not self._timer.is_due(self._began_ns, self._rules()):
            return
        status, states = self._measure(self._timer.most_blocks)
        is_diagnosis_due = self._timer.is_diagnosis_due(self._robot.steady_ns())
        blocks: list[BlockJson] = []
        for block in states:
            blocks.append(BlockJson.of(block))
            if len(blocks) % BLOCKS_PER_SLICE == 0:
                yield
        whole = replace(status, blocks_left_out=states.left_out)
        self._publisher.announce(whole, blocks, diagnostics_too=is_diagnosis_due)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions of a robot within the last hour, as its statuses tell, in bounded memory."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from threading import Lock

from msgspec import Struct

from smarttestudo.domain.rate import Rate
from smarttestudo.domain.record import json_name
from smarttestudo.domain.status import BlockStatus, RulesOrigin, RuntimeStatus
from smarttestudo.editing.zones import axis_of
from smarttestudo.ruler.robots.watch import Place, SeenRobot

KEPT_S = 3600.0
MAX_EVENTS = 2000
MAX_EVENTS_TOLD = 300
MAX_POINTS_TOLD = 1000
_POINT_PERIOD_S = 1.0


class EventKind(Enum):
    """Kind of a change; the value is its name in JSON."""

    RATE = "rate"
    RULE = "rule"
    RULES = "rules"


class RobotEvent(Struct, frozen=True, kw_only=True):
    """A change of a topic's rate, a rule's state, or all rules; ``because`` is what decided the rate."""

    s_ago: float
    kind: EventKind
    name: str
    before: str
    after: str
    because: str


class RobotHistoryAnswer(Struct, frozen=True, kw_only=True):
    """Events since ``since_s_ago``, the newest first; ``left_out`` older ones are not told.

    ``path`` is ``[seconds ago, x, y]`` in metres, the oldest first, by the checks of the rules that read
    ``pose_topic``; null where none does.
    """

    since_s_ago: float
    events: tuple[RobotEvent, ...]
    left_out: int
    path: tuple[tuple[float, float, float], ...]
    pose_topic: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Change:
    heard_s: float
    kind: EventKind
    name: str
    before: str
    after: str
    because: str = ""
    place: Place | None = None
    rules_sha256: str = ""


class RobotHistory:
    """One robot's last hour; any thread may ask while another one adds."""

    def __init__(self) -> None:
        self._changes: deque[_Change] = deque(maxlen=MAX_EVENTS)
        self._points: deque[tuple[float, float, float]] = deque(maxlen=int(KEPT_S / _POINT_PERIOD_S))
        self._pose_topic: str | None = None
        self._since_s: float | None = None
        self._last: SeenRobot | None = None
        self._lost = 0
        self._lock = Lock()

    def add(self, seen: SeenRobot) -> None:
        """Compare a status with the one before."""
        with self._lock:
            if self._since_s is None:
                self._since_s = seen.heard_s
            if self._last is not None:
                for change in _changes(self._last.status, seen.status, seen.heard_s):
                    self._lost += len(self._changes) == MAX_EVENTS
                    self._changes.append(change)
            self._last = seen
            self._add_point(seen)
            self._forget(seen.heard_s - KEPT_S)

    def answer(self, now_s: float) -> RobotHistoryAnswer:
        """All that is known at ``now_s`` of the clock of the statuses."""
        with self._lock:
            changes, points, last = list(self._changes), list(self._points), self._last
            since_s = now_s if self._since_s is None else self._since_s
            lost = self._lost
        step = -(-len(points) // MAX_POINTS_TOLD) or 1
        told = changes[-MAX_EVENTS_TOLD:]
        return RobotHistoryAnswer(
            since_s_ago=min(max(now_s - since_s, 0.0), KEPT_S),
            events=tuple(_event(one, last, now_s) for one in reversed(told)),
            left_out=len(changes) - len(told) + lost,
            # The last place is where the robot is.
            path=tuple((now_s - at_s, x_m, y_m) for at_s, x_m, y_m in reversed(points[::-1][::step])),
            pose_topic=self._pose_topic,
        )

    def _add_point(self, seen: SeenRobot) -> None:
        if self._points and seen.heard_s - self._points[-1][0] < _POINT_PERIOD_S:
            return
        found = _place_of(seen)
        if found is not None:
            self._pose_topic, x_m, y_m = found
            self._points.append((seen.heard_s, x_m, y_m))

    def _forget(self, before_s: float) -> None:
        while self._changes and self._changes[0].heard_s < before_s:
            self._changes.popleft()
            self._lost = 0
        while self._points and self._points[0][0] < before_s:
            self._points.popleft()


def _changes(before: RuntimeStatus, now: RuntimeStatus, heard_s: float) -> Iterator[_Change]:
    if (before.rules.sha256, before.rules.origin) != (now.rules.sha256, now.rules.origin):
        yield _Change(
            heard_s=heard_s,
            kind=EventKind.RULES,
            name="rules",
            before=_rules_words(before),
            after=_rules_words(now),
        )
    for name, topic in now.topics.items():
        known = before.topics.get(name)
        if known is not None and known.target_hz != topic.target_hz:
            yield _Change(
                heard_s=heard_s,
                kind=EventKind.RATE,
                name=name,
                before=str(Rate(known.target_hz)),
                after=str(Rate(topic.target_hz)),
                because=topic.rule or topic.reason.value,
            )
    if before.rules.sha256 == now.rules.sha256:
        states = {_place(block): block.state for block in before.blocks}
        for block in now.blocks:
            state = states.get(_place(block), block.state)
            if state is not block.state:
                yield _Change(
                    heard_s=heard_s,
                    kind=EventKind.RULE,
                    name=f"the rule at line {block.line}",
                    before=json_name(state),
                    after=json_name(block.state),
                    place=_place(block),
                    rules_sha256=now.rules.sha256,
                )


def _rules_words(status: RuntimeStatus) -> str:
    if status.rules.origin is RulesOrigin.FALLBACK:
        return "no valid rules"
    return f"{status.rules.sha256[:8]} ({status.rules.origin.value})"


def _place(block: BlockStatus) -> Place:
    return block.file, block.line, block.column


def _event(change: _Change, last: SeenRobot | None, now_s: float) -> RobotEvent:
    """``change`` with the name of its rule, if the rules that it is from are known by now."""
    name = change.name
    if change.place is not None and last is not None and last.words.sha256 == change.rules_sha256:
        name = last.words.labels.get(change.place, name)
    return RobotEvent(
        s_ago=max(now_s - change.heard_s, 0.0),
        kind=change.kind,
        name=name,
        before=change.before,
        after=change.after,
        because=change.because,
    )


def _place_of(seen: SeenRobot) -> tuple[str, float, float] | None:
    """The topic whose x and y checks read, and what they read; ``None`` where no topic has both."""
    found: dict[str, dict[str, float]] = {}
    for block in seen.status.blocks:
        for check in block.checks:
            written = seen.words.checks.get((block.file, check.line, check.column))
            axis = None if written is None else axis_of(written.property)
            if written is not None and axis is not None and isinstance(check.value, float):
                place = found.setdefault(written.topic, {})
                place[axis] = check.value
                if len(place) == 2:
                    return written.topic, place["pose_x"], place["pose_y"]
    return None

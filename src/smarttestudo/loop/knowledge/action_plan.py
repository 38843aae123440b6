# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Actions to do as blocks begin and cease to hold."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from smarttestudo.domain.action import ActionEvent, ActionKind, ActRequest
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.timing import AlarmClock
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.rule_set import RuleBlock

LEAST_PAUSE_NS = NS_PER_S
"""A service is called, a notice begins and a parameter changes once in so long at most."""


class PlannedAction(NamedTuple):
    """An action to do because of ``block``; a notice that ends was there for ``lasted_ns``."""

    event: ActionEvent
    action: ActRequest
    block: RuleBlock
    lasted_ns: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """The value that ``block`` asks for; the greatest ``rank`` counts, that of the first block of equals."""

    action: ActRequest
    block: RuleBlock

    @property
    def rank(self) -> tuple[int, int]:
        return self.block.priority, -self.block.order


class _Statement(NamedTuple):
    """An action of a block, the same where other rules have moved it."""

    path: str
    rule: str
    action: ActRequest

    @classmethod
    def of(cls, action: ActRequest, block: RuleBlock) -> _Statement:
        return cls(block.path, block.label, action)


class ActionPlan:
    """The parameters that blocks have set, the notices that hold, and when each action was done last.

    ``profile`` says what is allowed. Times are steady times. A parameter has the value that the block of the
    highest priority asks for, of equals the first one in the files. A change that comes too soon waits, as a
    parameter has to be right at the end; a call or a notice is skipped.
    """

    def __init__(self, profile: Profile) -> None:
        self._profile = profile
        self._asked: dict[str, dict[int, _Asked]] = {}
        self._set: dict[str, _Asked] = {}
        self._notices: dict[_Statement, tuple[RuleBlock, int]] = {}
        self._done_ns: dict[str | _Statement, int] = {}
        self._alarms: AlarmClock[str] = AlarmClock()

    @property
    def next_wake_ns(self) -> int | None:
        """When a change of a parameter that waits is due; it may come early."""
        return self._alarms.next_ns

    def begin(self, block: RuleBlock, now_ns: int) -> Iterator[PlannedAction]:
        """``block`` began to hold; what it sets comes with the next ``advance``."""
        for action in block.acts:
            if not self._profile.allows(action):
                yield PlannedAction(ActionEvent.NOT_ALLOWED, action, block)
            elif action.kind is ActionKind.SET_PARAMETER:
                self._ask(action, block, now_ns)
            else:
                statement = _Statement.of(action, block)
                if action.kind is ActionKind.NOTIFY:
                    self._notices[statement] = block, now_ns
                event = ActionEvent.SKIPPED
                if self._may_follow(statement, now_ns):
                    self._done_ns[statement], event = now_ns, ActionEvent.BEGIN
                yield PlannedAction(event, action, block)

    def end(self, block: RuleBlock, now_ns: int) -> Iterator[PlannedAction]:
        """``block`` holds no more; what it set is given back with the next ``advance``."""
        for action in block.acts:
            if action.kind is ActionKind.NOTIFY:
                yield from self._end_notice(_Statement.of(action, block), now_ns)
            elif self._asked.get(action.place, {}).pop(block.order, None) is not None:
                self._alarms.set(action.place, now_ns)

    def advance(self, now_ns: int) -> Iterator[PlannedAction]:
        """Give parameters the values that they are to have by ``now_ns``, once all blocks have turned."""
        for place in self._alarms.take_due(now_ns):
            yield from self._settle(place, now_ns)

    def change_rules(
        self, holding: Iterable[RuleBlock], profile: Profile, now_ns: int
    ) -> Iterator[PlannedAction]:
        """Go on with other rules and another profile; ``holding`` are the blocks of them that hold still."""
        self._profile = profile
        self._done_ns = {key: ns for key, ns in self._done_ns.items() if now_ns < ns + LEAST_PAUSE_NS}
        statements = [(_Statement.of(action, block), block) for block in holding for action in block.acts]
        going_on = {statement for statement, _ in statements}
        for statement in [one for one in self._notices if one not in going_on]:
            yield from self._end_notice(statement, now_ns)
        self._asked = {}
        for statement, block in statements:
            if statement.action.kind is ActionKind.SET_PARAMETER and profile.allows(statement.action):
                self._ask(statement.action, block, now_ns)
        for place in self._set:
            self._alarms.set(place, now_ns)

    def _ask(self, action: ActRequest, block: RuleBlock, now_ns: int) -> None:
        asked = self._asked.setdefault(action.place, {})
        asked.setdefault(block.order, _Asked(action=action, block=block))
        self._alarms.set(action.place, now_ns)

    def _end_notice(self, statement: _Statement, now_ns: int) -> Iterator[PlannedAction]:
        if (notice := self._notices.pop(statement, None)) is not None:
            block, since_ns = notice
            yield PlannedAction(ActionEvent.END, statement.action, block, now_ns - since_ns)

    def _may_follow(self, done: str | _Statement, now_ns: int) -> bool:
        done_ns = self._done_ns.get(done)
        return done_ns is None or now_ns >= done_ns + LEAST_PAUSE_NS

    def _settle(self, place: str, now_ns: int) -> Iterator[PlannedAction]:
        """Give a parameter the value that it is to have, once it may change again."""
        asked, before = self._asked.get(place, {}), self._set.get(place)
        wanted = max(asked.values(), key=lambda one: one.rank, default=None)
        if wanted is not None and before is not None and wanted.action.is_same(before.action):
            self._set[place] = before = wanted
        if wanted is before:
            return
        if not self._may_follow(place, now_ns):
            self._alarms.set(place, self._done_ns[place] + LEAST_PAUSE_NS)
            return
        self._done_ns[place] = now_ns
        if wanted is not None:
            self._set[place] = wanted
            yield PlannedAction(ActionEvent.BEGIN, wanted.action, wanted.block)
        elif before is not None:
            del self._set[place]
            yield PlannedAction(ActionEvent.END, replace(before.action, value=None), before.block)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which notices are sent when: what flickers comes a few times a minute, with a count."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field

from smarttestudo.domain.action import ActionDecision, ActionEvent
from smarttestudo.domain.units import NS_PER_S

MOST_A_MINUTE = 6
_MINUTE_NS = 60 * NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class SentNotice:
    """A notice as it is sent: it began or ended, and began so many times (``count``) since the last one."""

    decision: ActionDecision
    count: int


@dataclass(slots=True, eq=False)
class _Notice:
    sent_ns: deque[int] = field(default_factory=deque)
    waiting: ActionDecision | None = None
    count: int = 0


class NoticeThrottle:
    """Lets each notice out ``MOST_A_MINUTE`` times at most, the last of what it said in any case, in order.

    Times are steady times.
    """

    def __init__(self) -> None:
        self._notices: dict[tuple[str | None, str], _Notice] = {}

    def offer(self, decision: ActionDecision, now_ns: int) -> Iterator[SentNotice]:
        """A notice began or ended; what to send now."""
        notice = self._notices.setdefault((decision.rule, decision.action.target), _Notice())
        notice.waiting = decision
        notice.count += decision.event is not ActionEvent.END
        yield from self._due(notice, now_ns)

    def advance(self, now_ns: int) -> Iterator[SentNotice]:
        """Send what waited long enough."""
        for key, notice in [*self._notices.items()]:
            yield from self._due(notice, now_ns)
            if not notice.sent_ns:
                del self._notices[key]

    def flush(self) -> Iterator[SentNotice]:
        """Send all that waits."""
        for notice in self._notices.values():
            notice.sent_ns.clear()
            yield from self._due(notice, 0)

    def _due(self, notice: _Notice, now_ns: int) -> Iterator[SentNotice]:
        while notice.sent_ns and notice.sent_ns[0] + _MINUTE_NS <= now_ns:
            notice.sent_ns.popleft()
        if notice.waiting is not None and len(notice.sent_ns) < MOST_A_MINUTE:
            notice.sent_ns.append(now_ns)
            yield SentNotice(decision=notice.waiting, count=notice.count)
            notice.waiting, notice.count = None, 0

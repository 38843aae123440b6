# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A loop that notes what it is given."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.domain.observation import LinkBudget, SourceChanged, Undecodable
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.profile import Profile
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.runtime.execute.relay import Relayed
from smarttestudo.runtime.inputs import BudgetInput, LoopInput, MessageInput, SourceInput, WakeInput
from smarttestudo.runtime.relay_loop import RelayLoop


class RecordingLoop(RelayLoop):
    """Hands each input to ``note`` before it takes it. Rules are noted by whoever knows their texts."""

    def __init__(
        self,
        rule_set: RuleSet,
        profile: Profile,
        start_ns: int,
        when_slow: WhenSlow = WhenSlow.PASS,
        budget_kb_per_s: float | None = None,
        *,
        note: Callable[[LoopInput], None],
    ) -> None:
        super().__init__(rule_set, profile, start_ns, when_slow, budget_kb_per_s)
        self._note = note
        self._publishers: dict[Hashable, int] = {}

    def on_message(
        self,
        topic: str,
        now_ns: int,
        payload: Payload,
        size_bytes: int,
        *,
        message: object | None = None,
        publisher: Hashable = None,
    ) -> Sequence[Relayed]:
        """See ``RelayLoop``."""
        decodable = not isinstance(message, Undecodable)
        self._note(
            MessageInput(
                stamp_ns=now_ns,
                topic=topic,
                size_bytes=size_bytes,
                payload=payload[:] if decodable and self.reads(topic) else None,
                decodable=decodable,
                publisher=self._number(publisher),
            )
        )
        return super().on_message(topic, now_ns, payload, size_bytes, message=message, publisher=publisher)

    def on_source(self, change: SourceChanged, now_ns: int) -> Sequence[Relayed]:
        """See ``RelayLoop``."""
        self._note(SourceInput(stamp_ns=now_ns, change=change))
        return super().on_source(change, now_ns)

    def on_budget(self, budget: LinkBudget, now_ns: int) -> Sequence[Relayed]:
        """See ``RelayLoop``."""
        self._note(BudgetInput(stamp_ns=now_ns, budget_kb_per_s=budget.link_kb_per_s))
        return super().on_budget(budget, now_ns)

    def on_wake(self, now_ns: int) -> Sequence[Relayed]:
        """See ``RelayLoop``."""
        self._note(WakeInput(stamp_ns=now_ns))
        return super().on_wake(now_ns)

    def _number(self, publisher: Hashable) -> int | None:
        return None if publisher is None else self._publishers.setdefault(publisher, len(self._publishers))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rule files ask of the optimizer: the defaults, then each block's topics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from smarttestudo.adirf.normal_form import Resolve
from smarttestudo.adirf.syntax import (
    Block,
    KeepAtLeast,
    RateWord,
    RuleFile,
    SetFrequency,
    Statement,
    sets_in,
)
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.domain.source import Span
from smarttestudo.optimizer.model import Ask, TopicNeeds, needs_of

StatementKey = tuple[str, Span]
"""A file's path and where its rate is written: what a statement is known by."""


class Undecided(Enum):
    """What becomes of topics for which the files have no default."""

    APPENDED = "every one in the profile gets Unacceptable, as a default"
    COUNTED = "the same, but only where the profile has what that needs"
    LEFT_OUT = "none; those that the files relay are Full, and count as such"


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Topics that are solved in one go: the defaults (``label`` is ``None``) or one side of a block.

    ``asks`` are by topic. ``tier_statements`` are the statements that name a level, with their topic.
    ``path`` and ``span`` say where the block, or the first default, is.
    """

    label: str | None
    path: str
    span: Span
    asks: Mapping[str, Ask]
    tier_statements: tuple[tuple[StatementKey, str], ...]

    @property
    def place(self) -> str:
        """``file:line:column``."""
        return f"{self.path}:{self.span.line}:{self.span.column}"


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleAsks:
    """Everything that is asked. ``appended`` are the profile's topics that no default names."""

    defaults: Part
    blocks: tuple[Part, ...]
    appended: tuple[str, ...]


def collect_asks(
    files: Sequence[RuleFile], profile: Profile, resolve: Resolve, undecided: Undecided
) -> RuleAsks:
    """What ``files``, which have no errors, ask of the topics in ``profile``.

    Raises ``ProfileError`` where the profile lacks a topic of the rules or an entry that is needed.
    """
    return _Collector(files=files, profile=profile, resolve=resolve, undecided=undecided).asks()


class _Collector:
    def __init__(
        self, *, files: Sequence[RuleFile], profile: Profile, resolve: Resolve, undecided: Undecided
    ) -> None:
        self._files = files
        self._profile = profile
        self._resolve = resolve
        self._undecided = undecided
        self._floors_hz: dict[str, float] = {}
        for _, statement in self._statements():
            if isinstance(statement, KeepAtLeast) and isinstance(statement.rate.value, int | float):
                topic = resolve(statement.topic.text)
                self._floors_hz[topic] = max(self._floors_hz.get(topic, 0.0), statement.rate.value)
        self._needs: dict[str, TopicNeeds] = {}

    def asks(self) -> RuleAsks:
        blocks = tuple(
            part
            for path, statement in self._statements()
            if isinstance(statement, Block)
            for part in self._sides(path, statement)
        )
        defaults, appended = self._defaults(blocks)
        return RuleAsks(defaults=defaults, blocks=blocks, appended=appended)

    def _statements(self) -> Iterator[tuple[str, Statement]]:
        return ((file.path, statement) for file in self._files for statement in file.statements)

    def _defaults(self, blocks: Sequence[Part]) -> tuple[Part, tuple[str, ...]]:
        written = [
            (path, statement) for path, statement in self._statements() if isinstance(statement, SetFrequency)
        ]
        asks = dict(self._ask(statement) for _, statement in written)
        appended = tuple(
            topic for topic in self._profile.topics if topic not in asks and self._appends(topic)
        )
        asks.update((topic, self._ask_for(topic, Tier.UNACCEPTABLE)) for topic in appended)
        relayed = dict.fromkeys([*self._floors_hz, *(topic for part in blocks for topic in part.asks)])
        asks.update((topic, self._ask_for(topic, RateWord.FULL)) for topic in relayed if topic not in asks)
        path, span = next(iter((path, one.span) for path, one in written), self._start())
        return self._part(None, path, span, asks, written), appended

    def _appends(self, topic: str) -> bool:
        if self._undecided is Undecided.COUNTED:
            entry = self._profile.topic(topic)
            return entry.message_kb is not None and entry.tiers_hz is not None
        return self._undecided is Undecided.APPENDED

    def _start(self) -> tuple[str, Span]:
        first = self._files[0]
        return first.path, first.collections[0].span

    def _sides(self, path: str, block: Block) -> Iterator[Part]:
        for label, side in ((block.label, block.then), (f"{block.label} (Else)", block.otherwise)):
            if sets := sets_in(side):
                asks = dict(self._ask(statement) for statement in sets)
                yield self._part(label, path, block.span, asks, [(path, statement) for statement in sets])

    def _part(
        self,
        label: str | None,
        path: str,
        span: Span,
        asks: Mapping[str, Ask],
        written: Sequence[tuple[str, SetFrequency]],
    ) -> Part:
        tier_statements = tuple(
            ((of_path, one.rate.span), self._resolve(one.topic.text))
            for of_path, one in written
            if isinstance(one.rate.value, Tier)
        )
        return Part(label=label, path=path, span=span, asks=asks, tier_statements=tier_statements)

    def _ask(self, statement: SetFrequency) -> tuple[str, Ask]:
        topic = self._resolve(statement.topic.text)
        return topic, self._ask_for(topic, statement.rate.value)

    def _ask_for(self, topic: str, value: float | Tier | RateWord) -> Ask:
        needs = self._needs_of(topic)
        if isinstance(value, Tier):
            return Ask(needs=needs, wanted=value)
        if value is RateWord.FULL:
            return Ask(needs=needs, wanted=needs.source_hz)
        rate = Rate.off() if isinstance(value, RateWord) else Rate(value)
        return Ask(needs=needs, wanted=rate.at_least(self._floors_hz.get(topic, 0.0)).hz)

    def _needs_of(self, topic: str) -> TopicNeeds:
        if topic not in self._needs:
            floor_hz = self._floors_hz.get(topic, 0.0)
            self._needs[topic] = needs_of(topic, self._profile, keep_at_least_hz=floor_hz)
        return self._needs[topic]

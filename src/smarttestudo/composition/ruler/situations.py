# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every topic takes of the link: by default, in each block, and in the worst case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from smarttestudo.adirf.checks import CheckContext
from smarttestudo.adirf.evaluator import Evaluator
from smarttestudo.adirf.rule_set import RuleSet, compile_rules
from smarttestudo.composition.ruler.optimizing import OptimizedDraft
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.optimizer.joint.check import check_together
from smarttestudo.optimizer.joint.loads import loads_of, missing_entries
from smarttestudo.optimizer.problem import fits
from smarttestudo.optimizer.rule_rates import Optimization, SolvedPart


class SituationKind(Enum):
    """Which situation loads belong to; the value is its name in JSON."""

    DEFAULTS = "defaults"
    RULE = "rule"
    WORST = "worst"


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """A topic's rate and what it takes of the link, in KB/s."""

    topic: str
    rate: Rate
    kb_per_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedSituation:
    """The loads of all topics; ``lines`` are those of the blocks that hold, ``state`` an example for it."""

    kind: SituationKind
    title: str
    loads: tuple[Load, ...]
    feasible: bool
    lines: tuple[int, ...] = ()
    state: Mapping[Signal, float] = field(default_factory=dict)

    @property
    def kb_per_s(self) -> float:
        """What all topics take together."""
        return math.fsum(load.kb_per_s for load in self.loads)


def situations_of(optimized: OptimizedDraft) -> Iterator[LoadedSituation]:
    """The defaults, each side of each block, and, where everything fits by itself, the worst of all."""
    done = optimized.outcome.optimization
    base = dict(_rates_hz(done.defaults, done))
    sizes = _sizes_kb(done)
    for part in done.parts:
        is_default = part is done.defaults
        rates_hz = {**base, **dict(_rates_hz(part, done))}
        yield LoadedSituation(
            kind=SituationKind.DEFAULTS if is_default else SituationKind.RULE,
            title=part.part.label or "Defaults",
            loads=tuple(
                Load(topic=topic, rate=Rate(rate_hz), kb_per_s=sizes[topic] * rate_hz)
                for topic, rate_hz in rates_hz.items()
            ),
            feasible=part.feasible,
            lines=() if is_default else (part.part.span.line,),
        )
    if done.feasible:
        yield from _worst(optimized)


def _rates_hz(part: SolvedPart, done: Optimization) -> Iterator[tuple[str, float]]:
    """The rates of a part; where it does not fit, the least that was asked for."""
    for topic, ask in part.part.asks.items():
        rate_hz = ask.bounds_hz(done.model)[0] if part.rates_hz is None else part.rates_hz[topic]
        yield topic, rate_hz


def _sizes_kb(done: Optimization) -> dict[str, float]:
    return {topic: ask.needs.size_kb for part in done.parts for topic, ask in part.part.asks.items()}


def _worst(optimized: OptimizedDraft) -> Iterator[LoadedSituation]:
    """Nothing where the profile does not know every load, or the conditions are too complex."""
    done = optimized.outcome.optimization
    file = optimized.checked.document.result.file
    rule_set = _with_appended(compile_rules([file], resolve_topic, done.tier_rate), done)
    loads = loads_of(rule_set, optimized.profile)
    if missing_entries(rule_set, loads):
        return
    domain = CheckContext(profile=optimized.profile).domain
    found = check_together(rule_set, loads, done.budget_kb_per_s, domain, max_situations=1)
    if found.unproven:
        return
    worst, evaluator = found.worst, Evaluator(rule_set)
    for signal, value in worst.state.items():
        evaluator.set(signal, value)
    yield LoadedSituation(
        kind=SituationKind.WORST,
        title="Worst case",
        loads=tuple(
            Load(
                topic=topic,
                rate=evaluator.wish(topic).rate,
                kb_per_s=loads.kb_per_s(topic, evaluator.wish(topic).rate),
            )
            for topic in rule_set.relayed
        ),
        feasible=fits(worst.kb_per_s, done.budget_kb_per_s),
        lines=tuple(block.line for block in worst.blocks),
        state=worst.state,
    )


def _with_appended(rule_set: RuleSet, done: Optimization) -> RuleSet:
    """With the defaults that the optimizer adds for topics of the profile."""
    rates_hz = done.defaults.rates_hz or {}
    appended = {topic: Rate(rates_hz[topic]) for topic in done.appended}
    return replace(rule_set, defaults={**rule_set.defaults, **appended})

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a topic takes of the link at a rate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate


@dataclass(frozen=True, slots=True, kw_only=True)
class Loads:
    """KB for each message and the source's Hz, which Full passes on, by topic."""

    size_kb: Mapping[str, float]
    source_hz: Mapping[str, float]

    def kb_per_s(self, topic: str, rate: Rate) -> float:
        """``topic`` at ``rate``."""
        return self.size_kb[topic] * (self.source_hz[topic] if rate.is_full else rate.hz)


def loads_of(rule_set: RuleSet, profile: Profile) -> Loads:
    """What ``profile`` says of the relayed topics that it knows."""
    entries = {topic: profile.topic(topic) for topic in rule_set.relayed}
    return Loads(
        size_kb={t: entry.message_kb for t, entry in entries.items() if entry.message_kb is not None},
        source_hz={t: entry.source_hz for t, entry in entries.items() if entry.source_hz is not None},
    )


def missing_entries(rule_set: RuleSet, loads: Loads) -> list[tuple[str, str]]:
    """The topics whose load is not known, with the key that the profile lacks."""
    can_be_full = set(_full_topics(rule_set))
    missing = [(topic, "message_kb") for topic in rule_set.relayed if topic not in loads.size_kb]
    missing += [(t, "source_hz") for t in rule_set.relayed if t in can_be_full and t not in loads.source_hz]
    return missing


def _full_topics(rule_set: RuleSet) -> Iterable[str]:
    yield from (topic for topic in rule_set.relayed if topic not in rule_set.defaults)
    for rates in (rule_set.defaults, *(block.rates for block in rule_set.blocks)):
        yield from (topic for topic, rate in rates.items() if rate.is_full)

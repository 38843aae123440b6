# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which conditions hold."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Set as AbstractSet

from smarttestudo.loop.knowledge.knowledge import Knowledge
from smarttestudo.loop.knowledge.watched_topic import Reading


def analyze(knowledge: Knowledge, readings: Iterable[Reading], now_ns: int) -> AbstractSet[str]:
    """The topics whose request may have changed by ``now_ns``, a steady time; at first all relayed ones."""
    knowledge.evaluator.advance(now_ns)
    for signal, value in readings:
        knowledge.evaluator.set(signal, value)
    return knowledge.evaluator.take_changed_topics()

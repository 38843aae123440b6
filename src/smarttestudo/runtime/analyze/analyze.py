# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of signals to the topics for which the rules may now ask for something else."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Set as AbstractSet

from smarttestudo.runtime.knowledge.fields import Reading
from smarttestudo.runtime.knowledge.knowledge import Knowledge


def analyze(knowledge: Knowledge, readings: Iterable[Reading]) -> AbstractSet[str]:
    """The topics whose wish may have changed; at first all that are relayed."""
    for signal, value in readings:
        knowledge.evaluator.set(signal, value)
    return knowledge.evaluator.take_changed_topics()

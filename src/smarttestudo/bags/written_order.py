# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Stamps in the order in which messages were written, which go back where a clock is set."""

from __future__ import annotations

from smarttestudo.bags.stray_stamps import YEAR_NS
from smarttestudo.domain.units import NS_PER_S

LEAST_BACK_NS = NS_PER_S
"""A recorder that has several threads writes messages in another order than they came, by less than that."""
SAMPLES = 2000
"""So many messages are looked at in a moment; of more, so many at least."""


def notices_of_back(back_ns: int) -> list[str]:
    """The notice that stamps of a topic go back by so much, if that is worth one.

    Those that go back by years are left out of the recording, which says so itself.
    """
    if not LEAST_BACK_NS < back_ns <= 2 * YEAR_NS:
        return []
    return [
        f"stamps go back by up to {back_ns / NS_PER_S:.1f} s, as where a clock was set: "
        "messages of before and after are read by their stamps, so rates, ages and losses mix both"
    ]

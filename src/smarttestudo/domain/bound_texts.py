# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of the receiver's picture, as people read them."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.domain.decision import BoundReason, Reason


def bound_texts(within: Mapping[str, float], reasons: Mapping[str, BoundReason]) -> tuple[str, ...]:
    """Bound of each property, and what decided it, as people read them.

    ``position 0.05: Docking``, ``position 0.05, in doubt: Docking`` and, where a doubt lets everything pass,
    ``position not bound, in doubt: Docking``.
    """
    return tuple(
        f"{name} {f'{within[name]:g}' if name in within else 'not bound'}{_decider(reasons.get(name))}"
        for name in dict.fromkeys([*within, *reasons])
    )


def _decider(decided: BoundReason | None) -> str:
    if decided is None:
        return ""
    return f"{', in doubt' * (decided.reason is Reason.UNKNOWN)}: {decided.rule or decided.reason.value}"

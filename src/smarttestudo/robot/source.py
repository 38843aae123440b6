# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Source of a topic on the graph: its publishers together, and which subscribers their QoS can serve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from smarttestudo.domain.robot import Endpoint, Qos

DEPTH = 10
# The last messages of all publishers come at once, and one may keep more of them than ten others.
LATCHED_SUBSCRIPTION_DEPTH = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveSource:
    """Source of a topic: what its publishers have in common.

    ``other_types`` are types that some publish beside ``type_name``; those publishers do not count. ``gids``
    are those of the publishers, of the last ones where none is left; a source with others is still the same.
    """

    type_name: str
    publishers: int
    qos: Qos
    other_types: tuple[str, ...] = ()
    gids: frozenset[bytes] = field(default=frozenset(), compare=False)

    @property
    def subscription_qos(self) -> Qos:
        """QoS that a subscription asks for, ``qos`` being what a publisher offers."""
        if not self.qos.transient_local:
            return self.qos
        return replace(self.qos, depth=max(LATCHED_SUBSCRIPTION_DEPTH, self.qos.depth))


def live_source(endpoints: Sequence[Endpoint], before: LiveSource | None) -> LiveSource | None:
    """The source that ``endpoints`` make, after ``before``; ``None`` before the first publisher.

    A subscription may request only what every publisher offers, and its output offers no more.
    A source without publishers keeps its type and QoS, so that it is received at once when it comes back.
    """
    types = sorted({endpoint.type_name for endpoint in endpoints})
    if not types:
        return None if before is None else replace(before, publishers=0, other_types=())
    type_name = before.type_name if before is not None and before.type_name in types else types[0]
    counted = [endpoint for endpoint in endpoints if endpoint.type_name == type_name]
    transient_local = all(endpoint.transient_local for endpoint in counted)
    return LiveSource(
        type_name=type_name,
        publishers=len(counted),
        qos=Qos(
            reliable=all(endpoint.reliable for endpoint in counted),
            transient_local=transient_local,
            depth=max(DEPTH, 2 * len(counted)) if transient_local else DEPTH,
        ),
        other_types=tuple(other for other in types if other != type_name),
        gids=frozenset(endpoint.gid for endpoint in counted),
    )


def suits(had: LiveSource, now: LiveSource) -> bool:
    """Whether what was opened for ``had`` does for ``now``: latched messages are lost with what held them."""
    return (
        had.type_name == now.type_name
        and replace(had.qos, depth=0) == replace(now.qos, depth=0)
        and had.qos.depth >= now.qos.depth
    )


def not_offered(offered: Qos, subscriber: Endpoint) -> tuple[str, ...]:
    """Policies that ``subscriber`` requests beyond ``offered``; if there are any, it receives nothing."""
    unmet = {
        "reliable delivery": subscriber.reliable and not offered.reliable,
        "transient local durability": subscriber.transient_local and not offered.transient_local,
    }
    return (*(policy for policy, is_unmet in unmet.items() if is_unmet), *subscriber.asks)


_LESS = {"reliable delivery": "best effort", "transient local durability": "volatile durability"}


def instead_of(policies: Sequence[str]) -> str:
    """Policies for a subscriber to request in the place of those that are ``not_offered``."""
    return " and ".join(_LESS.get(policy, f"no {policy.removeprefix('a ')}") for policy in policies)

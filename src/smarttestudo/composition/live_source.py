# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A source as its publishers make it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from smarttestudo.domain.robot import Endpoint, Qos

DEPTH = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveSource:
    """What the publishers of a topic have in common.

    ``other_types`` are types that some publish beside ``type_name``; those publishers do not count.
    """

    type_name: str
    publishers: int
    qos: Qos
    other_types: tuple[str, ...] = ()


def live_source(endpoints: Sequence[Endpoint], before: LiveSource | None) -> LiveSource | None:
    """The source that ``endpoints`` make, after ``before``; ``None`` while nobody ever published.

    A subscriber may ask only for what every publisher offers, and its output promises no more.
    A source without publishers keeps its type and QoS, so that it is heard at once when it comes back.
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
    )


def suits(had: LiveSource, now: LiveSource) -> bool:
    """Whether what was opened for ``had`` does for ``now``: latched messages are lost with what held them."""
    return (
        had.type_name == now.type_name
        and replace(had.qos, depth=0) == replace(now.qos, depth=0)
        and had.qos.depth >= now.qos.depth
    )


def can_serve(offered: Qos, subscriber: Endpoint) -> bool:
    """Whether ``subscriber`` receives what is published with ``offered``: it may not ask for more."""
    return (offered.reliable or not subscriber.reliable) and (
        offered.transient_local or not subscriber.transient_local
    )

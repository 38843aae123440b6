# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Connections of a relayed topic on the graph."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicLink:
    """Connections of a relayed topic on the graph.

    Unless it ``is_subscribed``, the source is not subscribed to; it was ``subscriptions`` times.
    Of the ``subscribers`` of the output, its QoS cannot serve ``unserved``, which are of the nodes
    ``incompatible``.
    """

    output: str
    type_name: str | None = None
    publishers: int = 0
    is_subscribed: bool = True
    subscriptions: int = 0
    transient_local: bool = False
    has_header: bool = False
    subscribers: int = 0
    unserved: int = 0
    incompatible: tuple[str, ...] = ()
    problem: str | None = None

    @property
    def is_received(self) -> bool:
        """Whether somebody receives what is relayed."""
        return self.subscribers > self.unserved

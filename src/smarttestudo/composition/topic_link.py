# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a relayed topic is connected to on the graph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.composition.live_source import LiveSource, not_offered
from smarttestudo.domain.robot import Endpoint, Robot


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicLink:
    """What a relayed topic is connected to on the graph.

    ``incompatible`` are the nodes among the ``subscribers`` of the output that its QoS cannot serve.
    """

    output: str
    type_name: str | None = None
    publishers: int = 0
    transient_local: bool = False
    has_header: bool = False
    subscribers: int = 0
    incompatible: tuple[str, ...] = ()
    problem: str | None = None


def topic_link(
    robot: Robot,
    output: str,
    source: LiveSource | None,
    subscribers: Sequence[Endpoint],
    problem: str | None,
) -> TopicLink:
    """The links of a topic whose publishers make ``source``, relayed to ``output``.

    ``problem`` says why it cannot be relayed.
    """
    if source is None:
        return TopicLink(output=output, subscribers=len(subscribers), problem=problem)
    return TopicLink(
        output=output,
        type_name=source.type_name,
        publishers=source.publishers,
        transient_local=source.qos.transient_local,
        has_header=robot.begins_with_header(source.type_name),
        subscribers=len(subscribers),
        incompatible=tuple(sorted({one.node for one in subscribers if not_offered(source.qos, one)})),
        problem=problem,
    )

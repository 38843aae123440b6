# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a live run, as a bag stores them."""

from __future__ import annotations

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.metadata_text import offered_qos
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.robot.source import LiveSource

_MOST_CHANGES = 100


class HeardChannels:
    """The channels in ``by_topic``, with the type and QoS of the source that was heard last.

    Types before that are kept for their messages.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._heard: dict[str, tuple[str, Qos]] = {}
        # Another thread reads these: what is in them is replaced, not changed.
        self._since: dict[str, tuple[tuple[int, StoredChannel], ...]] = {}
        self.by_topic: dict[str, StoredChannel] = {}

    def hear(self, topic: str, source: LiveSource, number: int) -> None:
        """Messages of ``source`` are received from ``number`` on, if they were not before."""
        heard = source.type_name, source.qos
        if self._heard.get(topic) != heard:
            self._heard[topic] = heard
            channel = StoredChannel(
                topic=topic,
                type_name=source.type_name,
                definition=self._robot.definition(source.type_name),
                qos_text=offered_qos(source.qos),
            )
            before = self._since.get(topic, ())
            if before and before[-1][1].type_name == channel.type_name:
                # Not all readers bear two channels of one topic and type.
                number, before = before[-1][0], before[:-1]
            self._since[topic] = (*before[-_MOST_CHANGES:], (number, channel))
            self.by_topic[topic] = channel

    def of(self, topic: str, number: int) -> StoredChannel | None:
        """The channel as it was when the message of that number came."""
        since = self._since.get(topic, ())
        found = (channel for first, channel in reversed(since) if first <= number)
        return next(found, since[0][1] if since else None)

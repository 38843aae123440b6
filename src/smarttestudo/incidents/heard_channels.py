# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a live run, as a bag stores them."""

from __future__ import annotations

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.metadata_text import offered_qos
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.robot.topic import LiveSource


class HeardChannels:
    """The channels in ``by_topic``, with the type and QoS of the source that was heard last."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._heard: dict[str, tuple[str, Qos]] = {}
        self.by_topic: dict[str, StoredChannel] = {}

    def hear(self, topic: str, source: LiveSource) -> None:
        """Messages of ``source`` are received from now on, if they were not before."""
        heard = source.type_name, source.qos
        if self._heard.get(topic) != heard:
            self._heard[topic] = heard
            self.by_topic[topic] = StoredChannel(
                topic=topic,
                type_name=source.type_name,
                definition=self._robot.definition(source.type_name),
                qos_text=offered_qos(source.qos),
            )

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Channels of a recording as other bags store them."""

from __future__ import annotations

from collections.abc import Mapping

from rosbags.interfaces import Qos
from rosbags.rosbag2.metadata import dump_qos_v8

from smarttestudo.bags.definitions import TypeLibrary
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.domain.recording import Channel


def stored_channels(channels: Mapping[str, Channel]) -> dict[str, StoredChannel]:
    """``channels``, with definitions where the recording has none and ROS 2 knows the type."""
    types = TypeLibrary()
    return {topic: _stored(channel, types) for topic, channel in channels.items()}


def _stored(channel: Channel, types: TypeLibrary) -> StoredChannel:
    definition, digest = types.definition_and_digest(channel)
    return StoredChannel(
        topic=channel.topic,
        type_name=channel.type_name,
        definition=definition,
        digest=digest,
        qos_text=dump_qos_v8([profile for profile in channel.qos if isinstance(profile, Qos)]),
        serialization_format=channel.serialization_format,
    )

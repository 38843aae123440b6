# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One list of channels from what several places say about them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from smarttestudo.domain.recording import Channel

ChannelKey = tuple[str, str]


def key_of(channel: Channel) -> ChannelKey:
    """What makes a channel one of a kind: topic and type."""
    return channel.topic, channel.type_name


def merged_channels(channels: Iterable[Channel]) -> dict[ChannelKey, Channel]:
    """One channel for each topic and type; what an earlier one leaves open, later ones fill in."""
    merged: dict[ChannelKey, Channel] = {}
    for channel in channels:
        known = merged.get(key_of(channel))
        merged[key_of(channel)] = channel if known is None else _filled_in(known, channel)
    return merged


def _filled_in(known: Channel, other: Channel) -> Channel:
    takes_qos = not known.qos
    return replace(
        known,
        definition=known.definition or other.definition,
        digest=known.digest or other.digest,
        qos=other.qos if takes_qos else known.qos,
        transient_local=other.transient_local if takes_qos else known.transient_local,
    )

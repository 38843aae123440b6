# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is known of a recording's types without decoding a message."""

from __future__ import annotations

from smarttestudo.adapters.rosbag.definitions import TypeLibrary
from smarttestudo.domain.recording import Channel

_HEADER = "std_msgs/msg/Header"


class MessageTypes:
    """Types by the recording's own definitions, or else by those of ROS 2."""

    def __init__(self) -> None:
        self._types = TypeLibrary()

    def is_defined(self, channel: Channel) -> bool:
        """Whether the recording or ROS 2 defines the channel's type; the definition itself is not read."""
        return channel.definition is not None or self._types.store_for(channel) is not None

    def has_header(self, channel: Channel) -> bool:
        """Whether messages begin with a std_msgs/Header; false if no definition says so."""
        store = self._types.store_for(channel)
        if store is None:
            return False
        fields = store.fielddefs[channel.type_name][1]
        return bool(fields) and fields[0][1][1] == _HEADER

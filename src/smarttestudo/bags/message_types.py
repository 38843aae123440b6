# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Facts about the types of recorded messages."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from smarttestudo.domain.recording import Channel

if TYPE_CHECKING:
    from smarttestudo.bags.definitions import TypeLibrary

_HEADER = "std_msgs/msg/Header"


class MessageTypes:
    """Types by the recording's own definitions, or else by those of ROS 2."""

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

    @cached_property
    def _types(self) -> TypeLibrary:
        from smarttestudo.bags.definitions import TypeLibrary  # noqa: PLC0415  most recordings need none

        return TypeLibrary()

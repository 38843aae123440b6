# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Facts about the types of recorded messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING

from smarttestudo.domain.recording import Channel

if TYPE_CHECKING:
    from smarttestudo.bags.definitions import TypeLibrary

_COUNTED = "its messages are counted, but cannot be decoded"
_HEADER = "std_msgs/msg/Header"


class MessageTypes:
    """Types by the recording's own definitions, or else by those of ROS 2."""

    def notices(self, channels: Iterable[Channel], so: str = _COUNTED) -> Iterator[str]:
        """A notice of each channel whose messages cannot be decoded, and what follows from that."""
        for channel in channels:
            why = self._types.why_undecodable(channel)
            if why is not None:
                yield f"{channel.topic}: {why}; {so}"

    def has_header(self, channel: Channel) -> bool:
        """Whether messages begin with a std_msgs/Header; false if no definition says so."""
        types = self._types.types_for(channel)
        if types is None:
            return False
        from smarttestudo.bags.definitions import is_standard  # noqa: PLC0415  as below

        fields = types[channel.type_name][1]
        return bool(fields) and fields[0][1][1] == _HEADER and is_standard(types, _HEADER)

    @cached_property
    def _types(self) -> TypeLibrary:
        from smarttestudo.bags.definitions import TypeLibrary  # noqa: PLC0415  most recordings need none

        return TypeLibrary()

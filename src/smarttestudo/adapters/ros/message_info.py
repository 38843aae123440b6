# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the middleware says of a message beside its bytes."""

from __future__ import annotations

import ctypes
import struct
from dataclasses import dataclass

from smarttestudo.adapters.ros.rcl_library import MESSAGE_INFO_BYTES

_NUMBER_AT = 16
_GID_AT = 40
_UNNUMBERED = 2**64 - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class InfoLayout:
    """Where an rmw_message_info_t has the publisher's GID and its number of the message, if it has them.

    From Humble on it begins with two times of 8 bytes, two sequence numbers (all ones: not supported) and,
    behind a pointer, the GID of ``gid_bytes``: 24, later 16. 0 says that GIDs are not to be found there.
    """

    gid_bytes: int
    is_numbered: bool

    @staticmethod
    def found_in(raw_info: bytes, gid: bytes) -> InfoLayout:
        """The layout, by the info of the first message of the publisher ``gid``."""
        if not gid or raw_info[_GID_AT : _GID_AT + len(gid)] != gid:
            return InfoLayout(gid_bytes=0, is_numbered=False)
        (number,) = struct.unpack_from("=Q", raw_info, _NUMBER_AT)
        return InfoLayout(gid_bytes=len(gid), is_numbered=number == 1)


class MessageInfo:
    """The rmw_message_info_t of the message that was taken last."""

    __slots__ = ("_buffer", "_read", "address", "layout")

    def __init__(self, layout: InfoLayout) -> None:
        self.layout = layout
        self._buffer = ctypes.create_string_buffer(MESSAGE_INFO_BYTES)
        self._read = struct.Struct(f"=Q{_GID_AT - _NUMBER_AT - 8}x{layout.gid_bytes}s").unpack_from
        self.address = ctypes.addressof(self._buffer)

    def read(self) -> tuple[int, bytes]:
        """The publisher's number of the message, and the publisher's GID."""
        number, gid = self._read(self._buffer, _NUMBER_AT)
        return number, gid

    @property
    def raw(self) -> bytes:
        """All of it."""
        return self._buffer.raw

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Buffers that messages are taken into, lent to whoever holds the message."""

from __future__ import annotations

import ctypes

from smarttestudo.robot.ros.rcl.bindings import RclLibrary, SerializedMessage, bytes_at

KEPT_BUFFERS = 2
"""What a topic at a steady rate needs: one message held back, one coming in."""


class RclBuffer:
    """A serialized message of librcl; ``address`` is where its struct is."""

    __slots__ = ("address", "message")

    def __init__(self, message: SerializedMessage) -> None:
        self.message = message
        self.address = ctypes.addressof(message)


class RclBuffers:
    """The buffers of one topic.

    ``lent`` are held by payloads; at most ``KEPT_BUFFERS`` more are kept for the messages to come, and none
    once it is closed. The middleware makes them larger as needed; they never shrink.
    """

    __slots__ = ("_closed", "_free", "_library", "lent")

    def __init__(self, library: RclLibrary) -> None:
        self._library = library
        self._free: list[RclBuffer] = []
        self._closed = False
        self.lent = 0

    @property
    def kept(self) -> int:
        """How many buffers wait for a message."""
        return len(self._free)

    def next(self) -> RclBuffer:
        """The buffer for the next message; ``lend`` it if one came."""
        if not self._free:
            self._free.append(RclBuffer(self._library.new_message()))
        return self._free[-1]

    def lend(self) -> RclPayload:
        """The message that came in ``next``."""
        self.lent += 1
        return RclPayload(self._free.pop(), self)

    def take_back(self, buffer: RclBuffer) -> None:
        """Nobody holds the message of ``buffer`` any more."""
        self.lent -= 1
        if self._closed or len(self._free) >= KEPT_BUFFERS:
            self._library.free(buffer.message)
        else:
            self._free.append(buffer)

    def close(self) -> None:
        """Free what is kept, and what is lent as soon as it comes back."""
        self._closed = True
        while self._free:
            self._library.free(self._free.pop().message)


class RclPayload:
    """A message in a buffer, which goes back when nobody holds the payload any more."""

    __slots__ = ("_buffer", "_buffers", "_size_bytes")

    def __init__(self, buffer: RclBuffer, buffers: RclBuffers) -> None:
        self._buffer = buffer
        self._buffers = buffers
        self._size_bytes: int = buffer.message.length

    @property
    def address(self) -> int:
        """Where its rcutils_uint8_array_t is."""
        return self._buffer.address

    def __len__(self) -> int:
        return self._size_bytes

    def __getitem__(self, part: slice, /) -> bytes:
        return bytes_at(self._buffer.message.buffer or 0, self._size_bytes, part)

    def __del__(self) -> None:
        self._buffers.take_back(self._buffer)

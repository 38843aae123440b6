# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Functions of librcl that rclpy does not offer, and the buffers and message info that they fill."""

from __future__ import annotations

import ctypes
import os
import struct
from ctypes import c_char, c_int, c_size_t, c_void_p
from dataclasses import dataclass

from smarttestudo.domain.errors import RosError

RCL_RET_OK = 0
RCL_RET_ERROR = 1
RCL_RET_SUBSCRIPTION_TAKE_FAILED = 401

MESSAGE_INFO_BYTES = 256
"""More than an rmw_message_info_t has in any distribution."""

_ERROR_BYTES = 4096
"""At least what an rcutils_error_string_t has in any distribution: librcl writes all that it has there."""

KEPT_BUFFERS = 2
"""What a topic at a steady rate needs: one message held back, one coming in."""


class Allocator(ctypes.Structure):
    """An rcutils_allocator_t."""

    _fields_ = tuple((name, c_void_p) for name in ("allocate", "deallocate", "reallocate", "zero", "state"))


class SerializedMessage(ctypes.Structure):
    """An rcutils_uint8_array_t; the middleware makes its buffer as large as a message needs."""

    _fields_ = (("buffer", c_void_p), ("length", c_size_t), ("capacity", c_size_t), ("allocator", Allocator))


def bytes_at(address: int, size_bytes: int, part: slice = slice(None)) -> bytes:
    """A copy of a part of so many bytes."""
    start, stop, step = part.indices(size_bytes)
    count = max(stop - start, 0)
    if step == 1 and count <= _MOST_OF_STRING_AT:
        return ctypes.string_at(address + start, count)
    return memoryview((ctypes.c_uint8 * size_bytes).from_address(address))[part].tobytes()


_MOST_OF_STRING_AT = 2**31 - 1
"""What fits into the C int that ``ctypes.string_at`` makes of a size; it is several times as fast."""


class _ErrorString(ctypes.Structure):
    _fields_ = (("text", c_char * _ERROR_BYTES),)


class RclLibrary:
    """The librcl that rclpy has loaded. Pointers are addresses; ``take`` and ``publish`` return a code.

    Raises ``RosError`` where this machine has no such library, or not all that is needed of it.
    """

    def __init__(self) -> None:
        if ctypes.sizeof(c_void_p) != ctypes.sizeof(ctypes.c_uint64):
            raise RosError("librcl can be used directly on 64-bit machines only")
        try:
            library = loaded_librcl()
            self.take = rcl_function(library, "rcl_take_serialized_message", 4)
            self.publish = rcl_function(library, "rcl_publish_serialized_message", 3)
            self._on_new_message = rcl_function(library, "rcl_subscription_set_on_new_message_callback", 3)
            self._on_new_request = rcl_function(library, "rcl_service_set_on_new_request_callback", 3)
            self._on_new_answer = rcl_function(library, "rcl_client_set_on_new_response_callback", 3)
            self._graph_guard_condition = rcl_function(library, "rcl_node_get_graph_guard_condition", 1)
            self._free = rcl_function(library, "rcutils_uint8_array_fini", 1)
            default_allocator = library.rcutils_get_default_allocator
            self._error_string = library.rcutils_get_error_string
            self._reset_error = library.rcutils_reset_error
            # What the middleware calls on its own threads must not need Python: a function of libc.
            self._eventfd_write = ctypes.cast(ctypes.CDLL(None).eventfd_write, c_void_p)
        except (OSError, AttributeError) as error:
            raise RosError(f"librcl cannot be used directly: {error}") from error
        default_allocator.restype = Allocator
        self._graph_guard_condition.restype = c_void_p
        self._error_string.restype = _ErrorString
        self.allocator = default_allocator()

    def new_message(self) -> SerializedMessage:
        """A message without a buffer, which the middleware allocates; ``free`` it at the end."""
        return SerializedMessage(None, 0, 0, self.allocator)

    def free(self, message: SerializedMessage) -> None:
        """Give the buffer of ``message`` back to the system."""
        if message.buffer:
            self._free(ctypes.addressof(message))

    def wake_on_message(self, subscription: int, event_fd: int | None) -> None:
        """Have each new message counted up on ``event_fd``, or on nothing any more. Raises ``RosError``."""
        self._count_up(self._on_new_message, subscription, event_fd)

    def call_on_message(self, subscription: int, function: c_void_p, argument: int) -> None:
        """Have a C function called now and for each new message, with ``argument``. Raises ``RosError``."""
        self._set_callback(self._on_new_message, subscription, function, argument)

    def wake_on_request(self, service: int, event_fd: int | None) -> None:
        """Have each new request counted up on ``event_fd``, or on nothing any more. Raises ``RosError``."""
        self._count_up(self._on_new_request, service, event_fd)

    def wake_on_answer(self, client: int, event_fd: int | None) -> None:
        """Have each new answer counted up on ``event_fd``, or on nothing any more. Raises ``RosError``."""
        self._count_up(self._on_new_answer, client, event_fd)

    def graph_guard_condition(self, node: int) -> int:
        """Guard condition, triggered when the graph changes as ``node`` sees it. Raises ``RosError``."""
        condition: int | None = self._graph_guard_condition(node)
        if condition is None:
            raise self.error(RCL_RET_ERROR)
        return condition

    def error(self, code: int, place: str | None = None) -> RosError:
        """The text of rcl for the last failure, which returned ``code``; its first line is for people."""
        text = self._error_string().text.decode("utf-8", "replace")
        self._reset_error()
        cause = text.partition("\n")[0] or "an error without a message"
        return RosError(f"librcl: {cause} (code {code})", place=place)

    @property
    def relay_functions(self) -> dict[str, c_void_p]:
        """The functions that a compiled relay calls, by name."""
        functions = {
            "take": self.take,
            "publish": self.publish,
            "error_text": self._error_string,
            "reset_error": self._reset_error,
        }
        return {name: ctypes.cast(function, c_void_p) for name, function in functions.items()}

    def reset_error(self) -> None:
        """Forget the last failure, which is none."""
        self._reset_error()

    def _count_up(self, setter: ctypes._NamedFuncPointer, entity: int, event_fd: int | None) -> None:
        # The callback gets its user data and a count: the very arguments of eventfd_write.
        callback = None if event_fd is None else self._eventfd_write
        self._set_callback(setter, entity, callback, event_fd)

    def _set_callback(
        self, setter: ctypes._NamedFuncPointer, entity: int, callback: c_void_p | None, argument: int | None
    ) -> None:
        code = setter(entity, callback, argument)
        if code != RCL_RET_OK:
            raise self.error(code)
        if callback is not None:
            # Fast DDS announces nothing that comes while a callback is set, nor what it announced to another.
            ctypes.cast(callback, _Callback)(argument, 1)


_Callback = ctypes.CFUNCTYPE(None, c_void_p, ctypes.c_size_t)


def loaded_librcl() -> ctypes.CDLL:
    """The librcl that rclpy has loaded. Raises ``OSError`` where there is none."""
    return ctypes.CDLL("librcl.so", mode=os.RTLD_NOLOAD | os.RTLD_LAZY)


def rcl_function(library: ctypes.CDLL, name: str, pointers: int) -> ctypes._NamedFuncPointer:
    """The function of that name, which takes so many pointers and returns a code."""
    function: ctypes._NamedFuncPointer = getattr(library, name)
    function.argtypes = [c_void_p] * pointers
    function.restype = c_int
    return function


_NUMBER_AT = 16
_GID_AT = 40
_UNNUMBERED = 2**64 - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class InfoLayout:
    """Where an rmw_message_info_t has the publisher's GID and its number of the message, if it has them.

    From Humble on it begins with two times of 8 bytes, two sequence numbers (all ones: not supported) and,
    behind a pointer, the GID of ``gid_bytes``: 24, later 16. 0 means that GIDs are not found there.
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
        """The buffer for the next message; ``lend`` it if there is one."""
        if not self._free:
            self._free.append(RclBuffer(self._library.new_message()))
        return self._free[-1]

    def lend(self) -> RclPayload:
        """The message that was taken into ``next``."""
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

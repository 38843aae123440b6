# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The functions of librcl that rclpy does not give: serialized messages without a copy, and wake-ups.

Signatures as in rcl/publisher.h, rcl/subscription.h, rcl/service.h and rcutils/types/uint8_array.h; they are
the same from Humble on.
"""

from __future__ import annotations

import ctypes
import os
from ctypes import c_char, c_int, c_size_t, c_void_p

from smarttestudo.domain.errors import RosError

RCL_RET_OK = 0
RCL_RET_SUBSCRIPTION_TAKE_FAILED = 401

MESSAGE_INFO_BYTES = 256
"""More than an rmw_message_info_t has in any distribution."""

_ERROR_BYTES = 1024


class _Allocator(ctypes.Structure):
    _fields_ = tuple((name, c_void_p) for name in ("allocate", "deallocate", "reallocate", "zero", "state"))


class SerializedMessage(ctypes.Structure):
    """An rcutils_uint8_array_t; the middleware makes its buffer as large as a message needs."""

    _fields_ = (
        ("buffer", c_void_p),
        ("length", c_size_t),
        ("capacity", c_size_t),
        ("allocator", _Allocator),
    )


class _ErrorString(ctypes.Structure):
    _fields_ = (("text", c_char * _ERROR_BYTES),)


class RclLibrary:
    """The librcl that rclpy has loaded. Pointers are addresses; ``take`` and ``publish`` return a code.

    Raises ``RosError`` where this machine has no such library, or not all that is needed of it.
    """

    def __init__(self) -> None:
        if ctypes.sizeof(c_void_p) != ctypes.sizeof(ctypes.c_uint64):
            raise RosError("the direct way to librcl needs a 64-bit machine")
        try:
            library = ctypes.CDLL("librcl.so", mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
            self.take = _function(library, "rcl_take_serialized_message", 4)
            self.publish = _function(library, "rcl_publish_serialized_message", 3)
            self._on_new_message = _function(library, "rcl_subscription_set_on_new_message_callback", 3)
            self._on_new_request = _function(library, "rcl_service_set_on_new_request_callback", 3)
            self._free = _function(library, "rcutils_uint8_array_fini", 1)
            default_allocator = library.rcutils_get_default_allocator
            self._error_string = library.rcutils_get_error_string
            self._reset_error = library.rcutils_reset_error
            # What the middleware calls on its own threads must not need Python: a function of libc.
            self._eventfd_write = ctypes.cast(ctypes.CDLL(None).eventfd_write, c_void_p)
        except (OSError, AttributeError) as error:
            raise RosError(f"librcl cannot be used directly: {error}") from error
        default_allocator.restype = _Allocator
        self._error_string.restype = _ErrorString
        self._allocator = default_allocator()

    def new_message(self) -> SerializedMessage:
        """A message without a buffer, which the middleware allocates; ``free`` it at the end."""
        return SerializedMessage(None, 0, 0, self._allocator)

    def free(self, message: SerializedMessage) -> None:
        """Give the buffer of ``message`` back to the system."""
        if message.buffer:
            self._free(ctypes.addressof(message))

    def wake_on_message(self, subscription: int, event_fd: int | None) -> None:
        """Have each new message counted up on ``event_fd``, or on nothing any more. Raises ``RosError``."""
        self._set_callback(self._on_new_message, subscription, event_fd)

    def wake_on_request(self, service: int, event_fd: int) -> None:
        """Have each new request counted up on ``event_fd``. Raises ``RosError``."""
        self._set_callback(self._on_new_request, service, event_fd)

    def error(self, code: int, place: str | None = None) -> RosError:
        """What rcl says of the last failure, which returned ``code``; only the first line is for people."""
        text = self._error_string().text.decode("utf-8", "replace")
        self._reset_error()
        cause = text.partition("\n")[0] or "an error that it does not explain"
        return RosError(f"librcl: {cause} (code {code})", place=place)

    def reset_error(self) -> None:
        """Forget the last failure, which is none."""
        self._reset_error()

    def _set_callback(self, setter: ctypes._NamedFuncPointer, entity: int, event_fd: int | None) -> None:
        # The callback gets its user data and a count: the very arguments of eventfd_write.
        callback = None if event_fd is None else self._eventfd_write
        code = setter(entity, callback, event_fd)
        if code != RCL_RET_OK:
            raise self.error(code)


def _function(library: ctypes.CDLL, name: str, pointers: int) -> ctypes._NamedFuncPointer:
    function: ctypes._NamedFuncPointer = getattr(library, name)
    function.argtypes = [c_void_p] * pointers
    function.restype = c_int
    return function

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Compiled relays made for a test, and a librcl that is a list."""

from __future__ import annotations

import ctypes
import subprocess
from collections import deque
from ctypes import CFUNCTYPE, POINTER, c_int, c_int64, c_void_p, cast, memmove
from pathlib import Path

from smarttestudo.robot.ros.rcl import relay_library
from smarttestudo.robot.ros.rcl.bindings import (
    RCL_RET_OK,
    RCL_RET_SUBSCRIPTION_TAKE_FAILED,
    Allocator,
    SerializedMessage,
)
from smarttestudo.robot.ros.rcl.relay_library import RelayFunctions, RelaySettings

SOURCE = Path(relay_library.__file__).with_name("relay.c")
COPIES = SOURCE.with_name("copies.c")
FLAGS = ("-std=c11", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-pthread")
GID_BYTES = 16
_libc = ctypes.CDLL(None)
_libc.malloc.restype = c_void_p
_Message = POINTER(SerializedMessage)


def compiled(folder: Path, name: str, *arguments: str) -> Path:
    """What the C compiler makes of these arguments; who asks needs ``compiled_relays``."""
    made = folder / name
    done = subprocess.run(
        ["cc", *FLAGS, *arguments, "-o", str(made)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return made


def library_in(folder: Path, *flags: str) -> relay_library.RelayLibrary:
    """relay.c and copies.c as they are here."""
    made = compiled(folder, "relay.so", "-shared", "-fPIC", *flags, str(SOURCE), str(COPIES))
    return relay_library.RelayLibrary(made)


class ListedRcl:
    """Messages to take, as publisher, number and content, and what was published, all at ``now_ns``.

    ``steady`` is the function of C that reads ``steady_ns``.
    """

    def __init__(self) -> None:
        self.now_ns = self.steady_ns = 0
        self.to_take: deque[tuple[bytes, int, bytes]] = deque()
        self.published: list[bytes] = []
        # As long as C may call them, somebody must hold them.
        self._functions = (
            CFUNCTYPE(c_int, c_void_p, _Message, c_void_p, c_void_p)(self._take),
            CFUNCTYPE(c_int, c_void_p, _Message, c_void_p)(self._publish),
            CFUNCTYPE(c_int64)(lambda: self.now_ns),
        )
        self._steady = CFUNCTYPE(c_int64)(lambda: self.steady_ns)
        self.steady = cast(self._steady, c_void_p)

    def settings(self, **others: int) -> RelaySettings:
        """Settings of a relay that takes and publishes here."""
        take, publish, now = (cast(function, c_void_p) for function in self._functions)
        libc = {"allocate": "malloc", "deallocate": "free", "reallocate": "realloc", "zero": "calloc"}
        return RelaySettings(
            rcl=RelayFunctions(take=take, publish=publish, now_ns=now),
            allocator=Allocator(**{name: cast(_libc[function], c_void_p) for name, function in libc.items()}),
            gid_bytes=GID_BYTES,
            **others,
        )

    def _take(self, _subscription: int, taken: object, info: int, _allocation: int) -> int:
        if not self.to_take:
            return RCL_RET_SUBSCRIPTION_TAKE_FAILED
        gid, number, content = self.to_take.popleft()
        message = taken[0]  # type: ignore[index]
        if message.capacity < len(content):
            _libc.free(c_void_p(message.buffer))
            message.buffer, message.capacity = _libc.malloc(len(content)), len(content)
        message.length = len(content)
        memmove(message.buffer, content, len(content))
        memmove(info + 16, number.to_bytes(8, "little"), 8)
        memmove(info + 40, gid, GID_BYTES)
        return RCL_RET_OK

    def _publish(self, _publisher: int, sent: object, _allocation: int) -> int:
        message = sent[0]  # type: ignore[index]
        self.published.append(ctypes.string_at(message.buffer, message.length))
        return RCL_RET_OK

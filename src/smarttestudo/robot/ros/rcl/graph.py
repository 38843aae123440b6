# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Wakes for changes of the ROS graph: new or removed publishers and subscribers."""

from __future__ import annotations

import ctypes
import os
import select
import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from ctypes import c_int64, c_size_t, c_void_p
from functools import partial
from typing import Any

from smarttestudo.domain.errors import RosError, said
from smarttestudo.robot.ros.message_types import message_type
from smarttestudo.robot.ros.rcl.bindings import RCL_RET_OK, Allocator, RclLibrary, loaded_librcl, rcl_function
from smarttestudo.robot.ros.rcl.subscription import UnusedCallbackGroup
from smarttestudo.robot.ros.rcl.wake_ups import RclWakeUps
from smarttestudo.robot.ros.ros_errors import ros_errors

SETTLE_S = 0.05
"""Discovery reports a node, its publishers and its subscribers one after the other: they are one change."""
TEST_TOPIC = "~/_self_test_graph"
"""Hidden and private; it exists for some milliseconds."""
TEST_TIMEOUT_S = 2.0
_TEST_TYPE = "builtin_interfaces/msg/Time"
_END_TIMEOUT_S = 2.0
_RCL_RET_TIMEOUT = 2
_FOREVER_NS = -1
_NOT_AT_ALL_NS = 0

# An rcl_wait_set_t is six times a pointer to entities and their number, then one to what is its own.
_WAIT_SET_WORDS = 13
_CONDITIONS_WORD = 3
_OWN_WORD = 12


class WaitSet:
    """Waits for guard conditions, by their addresses. Raises ``RosError``, as do its methods."""

    def __init__(self, library: RclLibrary, context: int, conditions: Sequence[int]) -> None:
        self._library = library
        self._conditions = conditions
        try:
            librcl = loaded_librcl()
            init = rcl_function(librcl, "rcl_wait_set_init", 1)
            self._fini = rcl_function(librcl, "rcl_wait_set_fini", 1)
            self._clear = rcl_function(librcl, "rcl_wait_set_clear", 1)
            self._add = rcl_function(librcl, "rcl_wait_set_add_guard_condition", 3)
            self._wait = rcl_function(librcl, "rcl_wait", 1)
        except (OSError, AttributeError) as error:
            raise RosError(f"librcl cannot be used directly: {error}") from error
        init.argtypes = [c_void_p, *[c_size_t] * 6, c_void_p, Allocator]
        self._wait.argtypes = [c_void_p, c_int64]
        # Zeros are what rcl_get_zero_initialized_wait_set returns; more than one has in any distribution.
        self._words = (c_size_t * (2 * _WAIT_SET_WORDS))()
        self._address = ctypes.addressof(self._words)
        self._require(init(self._address, 0, len(conditions), 0, 0, 0, 0, context, library.allocator))
        if self._words[_CONDITIONS_WORD] != len(conditions) or not self._words[_OWN_WORD]:
            # What is not understood is not given back either.
            raise RosError("the wait set of this librcl has a different layout")

    def wait(self, timeout_ns: int) -> bool:
        """Wait until one of the conditions is triggered, which this undoes; whether that was in time."""
        self._require(self._clear(self._address))
        for condition in self._conditions:
            self._require(self._add(self._address, condition, None))
        code = self._wait(self._address, timeout_ns)
        if code == _RCL_RET_TIMEOUT:
            self._library.reset_error()
            return False
        self._require(code)
        return True

    def close(self) -> None:
        """Give back what it holds."""
        self._fini(self._address)

    def _require(self, code: int) -> None:
        if code != RCL_RET_OK:
            raise self._library.error(code)


class GraphWatch:
    """A thread that counts each change of a node's graph up on ``event_fd``; ``error`` is why it ended.

    It waits ``settle_s`` for further changes before that, which are counted as one with the first.
    A guard condition has no callback, so a thread has to wait for it; librcl does so without Python's lock.
    Raises ``RosError`` where that does not work here.
    """

    def __init__(self, node: Any, library: RclLibrary, event_fd: int) -> None:
        self.error: RosError | None = None
        self.settle_s = 0.0
        self._node = node
        self._event_fd = event_fd
        self._ended = threading.Event()
        with ros_errors():
            self._end = node.create_guard_condition(_never_called, callback_group=UnusedCallbackGroup())
        try:
            graph = library.graph_guard_condition(node.handle.pointer)
            conditions = (graph, self._end.handle.pointer)
            self._wait_set = WaitSet(library, node.context.handle.pointer, conditions)
        except RosError:
            node.destroy_guard_condition(self._end)
            raise
        self._thread = threading.Thread(target=self._watch, name="graph", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Count nothing more."""
        self._ended.set()
        self._end.trigger()
        self._thread.join(_END_TIMEOUT_S)
        if not self._thread.is_alive():
            self._wait_set.close()
            self._node.destroy_guard_condition(self._end)

    def _watch(self) -> None:
        try:
            while not self._ended.is_set():
                self._wait_set.wait(_FOREVER_NS)
                if self._ended.wait(self.settle_s):
                    return
                self._wait_set.wait(_NOT_AT_ALL_NS)
                os.eventfd_write(self._event_fd, 1)
        except RosError as error:
            self.error = error
            os.eventfd_write(self._event_fd, 1)


class GraphEvents:
    """Calls ``changed`` when the graph of one of ``nodes`` has changed, among what ``wake_ups`` wake for.

    ``problem`` is why it does not, or no longer does.
    """

    priority = 1.0

    def __init__(
        self, nodes: Sequence[Any], library: RclLibrary, wake_ups: RclWakeUps, changed: Callable[[], None]
    ) -> None:
        self.problem: str | None = None
        self._changed = changed
        self._opened = ExitStack()
        self._watches: list[GraphWatch] = []
        event_fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._opened.callback(os.close, event_fd)
        try:
            for node in nodes:
                watch = GraphWatch(node, library, event_fd)
                self._opened.callback(watch.close)
                self._watches.append(watch)
                _require_event(node, event_fd)
                watch.settle_s = SETTLE_S
        except (RosError, AttributeError, TypeError, ctypes.ArgumentError) as error:
            # Also where the interface of rclpy is another one.
            self.problem = said(error)
            self.close()
            return
        wake_ups.add(event_fd, self)
        self._opened.callback(wake_ups.remove, event_fd)

    def serve(self, most: int) -> bool:  # noqa: ARG002 - many changes are one
        """Report a change; there is never more to do."""
        for watch in self._watches:
            if watch.error is not None:
                self.problem = str(watch.error)
        self._changed()
        return False

    def close(self) -> None:
        """Report nothing more."""
        self._opened.close()


def _require_event(node: Any, event_fd: int) -> None:
    """Change the graph and wait for the report. Raises ``RosError`` if none comes."""
    reported = select.poll()
    reported.register(event_fd, select.POLLIN)
    with ExitStack() as undone, ros_errors(TEST_TOPIC):
        publisher = node.create_publisher(message_type(_TEST_TYPE, TEST_TOPIC), TEST_TOPIC, 1)
        undone.callback(partial(node.destroy_publisher, publisher))
        if not reported.poll(TEST_TIMEOUT_S * 1000):
            raise RosError("changes of the graph are not reported")
    os.eventfd_read(event_fd)


def _never_called() -> None:
    """Callback that rclpy requires and never calls."""

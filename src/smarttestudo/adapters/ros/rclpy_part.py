# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rclpy itself must do beside the librcl path: services, /clock, events of publishers."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from typing import Any
from weakref import WeakSet

from rclpy.executors import TimeoutException

from smarttestudo.adapters.ros.rcl_library import RclLibrary
from smarttestudo.adapters.ros.rcl_subscription import Unattended
from smarttestudo.adapters.ros.rcl_wake_ups import RclWakeUps

LOOK_PERIOD_S = 0.2
"""How often rclpy's executor looks for what wakes nobody, and for new services."""


class RclpyPart:
    """Runs rclpy's executor when one of the node's services or subscriptions has something for it."""

    priority = 1.0

    def __init__(self, node: Any, executor: Any, library: RclLibrary, wake_ups: RclWakeUps) -> None:
        self._node = node
        self._executor = executor
        self._library = library
        self._wake_ups = wake_ups
        self._known: WeakSet[Any] = WeakSet()
        self._event_fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._look_s = time.monotonic()
        wake_ups.add(self._event_fd, self)

    def serve(self, most: int) -> bool:
        """Run up to ``most`` callbacks; whether there may be more."""
        for _ in range(most):
            try:
                task, _, _ = self._executor.wait_for_ready_callbacks(timeout_sec=0)
            except TimeoutException:
                return False
            task()
            if task.exception() is not None:
                raise task.exception()
        return True

    def look(self) -> None:
        """Do now and then what nothing wakes for."""
        if time.monotonic() >= self._look_s:
            self._look_s = time.monotonic() + LOOK_PERIOD_S
            self._attend()
            while self.serve(1):
                pass

    def close(self) -> None:
        """Run nothing more."""
        self._wake_ups.remove(self._event_fd)
        os.close(self._event_fd)

    def _attend(self) -> None:
        for service in self._new(self._node.services):
            self._library.wake_on_request(service.handle.pointer, self._event_fd)
        for subscription in self._new(self._node.subscriptions):
            if not isinstance(subscription.callback_group, Unattended):
                self._library.wake_on_message(subscription.handle.pointer, self._event_fd)

    def _new(self, entities: Any) -> Iterator[Any]:
        for entity in entities:
            if entity not in self._known:
                self._known.add(entity)
                yield entity

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A subscription whose messages librcl takes, past rclpy's executor."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from ctypes import c_void_p
from typing import Any

from rclpy.callback_groups import CallbackGroup

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Qos
from smarttestudo.robot.ros.message_types import message_type
from smarttestudo.robot.ros.qos import qos_profile
from smarttestudo.robot.ros.rcl.bindings import (
    RCL_RET_OK,
    RCL_RET_SUBSCRIPTION_TAKE_FAILED,
    InfoLayout,
    MessageInfo,
    RclLibrary,
)
from smarttestudo.robot.ros.rcl.buffers import RclBuffers, RclPayload
from smarttestudo.robot.ros.ros_errors import ros_errors

try:
    from rclpy.event_handler import SubscriptionEventCallbacks
except ImportError:
    # Its name in Humble, which later distributions have dropped.
    from rclpy.qos_event import SubscriptionEventCallbacks


class UnusedCallbackGroup(CallbackGroup):  # type: ignore[misc]
    """Entities that rclpy's executor leaves alone."""

    def can_execute(self, entity: Any) -> bool:  # noqa: ARG002 - of any entity
        """Never."""
        return False


class RclSubscription:
    """Takes messages, and counts new ones up on ``event_fd`` while it is to wake; ``pointer`` is librcl's.

    ``is_heard`` is whether any message came. All calls raise ``RosError``.
    """

    def __init__(self, node: Any, library: RclLibrary, topic: str, type_name: str, qos: Qos) -> None:
        self._node = node
        self._library = library
        self._topic = topic
        with ExitStack() as undone:
            self.event_fd = _opened_event(topic)
            undone.callback(os.close, self.event_fd)
            with ros_errors(topic):
                self._handle = node.create_subscription(
                    message_type(type_name, topic),
                    topic,
                    _never_called,
                    qos_profile(qos),
                    callback_group=UnusedCallbackGroup(),
                    event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
                    raw=True,
                )
            undone.pop_all()
        self.pointer: int = self._handle.handle.pointer
        self.is_heard = False

    def wake(self, *, wanted: bool) -> None:
        """Wake for new messages from now on, those that are already there included; or for none."""
        self._library.wake_on_message(self.pointer, self.event_fd if wanted else None)

    def call(self, function: c_void_p, argument: int) -> None:
        """Have a C function called for new messages from now on, those that are there included."""
        self._library.call_on_message(self.pointer, function, argument)

    def take(self, buffers: RclBuffers, info: MessageInfo) -> RclPayload | None:
        """The oldest message that waits, described by ``info``; ``None`` if there is none."""
        library = self._library
        code = library.take(self.pointer, buffers.next().address, info.address, None)
        if code == RCL_RET_OK:
            self.is_heard = True
            return buffers.lend()
        if code != RCL_RET_SUBSCRIPTION_TAKE_FAILED:
            raise library.error(code, self._topic)
        return None

    def close(self) -> None:
        """Receive nothing more."""
        with ExitStack() as closing, ros_errors(self._topic):
            closing.callback(os.close, self.event_fd)
            closing.callback(self._node.destroy_subscription, self._handle)
            self.wake(wanted=False)


def _opened_event(topic: str) -> int:
    try:
        return os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
    except OSError as error:
        # Each topic needs a descriptor, and a shell allows 1024.
        raise RosError(
            f"no messages can be waited for: {error.strerror}",
            place=topic,
            remedy="raise the limit of open files: ulimit -n",
        ) from error


def _never_called(message: object) -> None:
    """Callback that rclpy requires and never calls."""


MAX_PUBLISHERS = 256
"""Publishers that are remembered at once; beyond, all are counted anew."""


class MessageNumbers:
    """Numbers of one topic's messages, and what follows: how many were sent, lost, or came twice.

    ``sent`` counts from each publisher's first message that came. What is skipped while resting is not lost.
    """

    __slots__ = ("_gap_is_wanted", "_last", "_rests", "lost", "sent")

    def __init__(self) -> None:
        self.sent = 0
        self.lost = 0
        self._last: dict[bytes, int] = {}
        self._rests = False
        self._gap_is_wanted = False

    def pause(self) -> None:
        """From now on most messages are skipped."""
        self._rests = self._gap_is_wanted = True

    def resume(self) -> None:
        """From the next message on, none is skipped."""
        self._rests = False

    @property
    def skips(self) -> bool:
        """Whether messages are skipped, or were right before the next."""
        return self._rests or self._gap_is_wanted

    @property
    def last(self) -> Mapping[bytes, int]:
        """The last number of each publisher."""
        return self._last

    def go_on(self, last: Mapping[bytes, int]) -> None:
        """Go on after these last numbers."""
        self._last = dict(last)

    def is_new(self, publisher: bytes, number: int) -> bool:
        """Count message ``number`` of ``publisher``, unless it or a later one came before."""
        last = self._last.get(publisher)
        if last is None:
            if len(self._last) >= MAX_PUBLISHERS:
                self._last.clear()
            last = number - 1
        elif number <= last:
            return False
        self._last[publisher] = number
        self.sent += number - last
        if not self._gap_is_wanted:
            self.lost += number - last - 1
        self._gap_is_wanted = self._rests
        return True


class RclTaker:
    """Takes each message once, whichever subscription it comes by.

    ``publisher`` is that of the last one. ``failed`` is called with an error, and then there is no message.
    """

    __slots__ = ("_info", "_tells_publishers", "buffers", "failed", "numbers", "publisher")

    def __init__(self, library: RclLibrary, layout: InfoLayout, failed: Callable[[RosError], None]) -> None:
        self.failed = failed
        self.buffers = RclBuffers(library)
        self.numbers = MessageNumbers() if layout.is_numbered else None
        self.publisher: bytes | None = None
        self._info = MessageInfo(layout)
        self._tells_publishers = layout.gid_bytes > 0

    def take(self, subscription: RclSubscription) -> RclPayload | None:
        """The oldest message that waits; ``None`` if there is none."""
        try:
            while (payload := subscription.take(self.buffers, self._info)) is not None:
                if not self._tells_publishers:
                    return payload
                number, self.publisher = self._info.read()
                if self.numbers is None or self.numbers.is_new(self.publisher, number):
                    return payload
        except RosError as error:
            self.failed(error)
        return None

    def take_newest(self, subscription: RclSubscription) -> RclPayload | None:
        """The newest message that waits; ``None`` if there is none."""
        newest = None
        while (payload := self.take(subscription)) is not None:
            newest = payload
        return newest

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The source of a topic as the librcl path receives it: subscriptions whose messages rclpy never sees."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from ctypes import c_void_p
from dataclasses import replace
from typing import Any

from rclpy.callback_groups import CallbackGroup

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Qos, Receive
from smarttestudo.robot.ros.message_types import message_type
from smarttestudo.robot.ros.qos import qos_profile
from smarttestudo.robot.ros.rcl.bindings import (
    RCL_RET_OK,
    RCL_RET_SUBSCRIPTION_TAKE_FAILED,
    InfoLayout,
    MessageInfo,
    RclBuffers,
    RclLibrary,
    RclPayload,
)
from smarttestudo.robot.ros.rcl.wake_ups import RclWakeUps
from smarttestudo.robot.ros.ros_errors import ros_errors

try:
    from rclpy.event_handler import SubscriptionEventCallbacks
except ImportError:
    # Its name in Humble, which later distributions have dropped.
    from rclpy.qos_event import SubscriptionEventCallbacks

MAX_PUBLISHERS = 256
"""Publishers that are remembered at once; beyond, all are counted anew."""
PAUSED_DEPTH = 2
"""With a queue of one, Fast DDS finds nothing in one take of three while messages come."""


class UnusedCallbackGroup(CallbackGroup):  # type: ignore[misc]
    """Entities that rclpy's executor leaves alone."""

    def can_execute(self, entity: Any) -> bool:  # noqa: ARG002 - of any entity
        """Never."""
        return False


class RclSubscription:
    """Takes messages, and counts new ones up on ``event_fd`` while it is to wake; ``pointer`` is librcl's.

    ``has_received`` is whether there was any message. All calls raise ``RosError``.
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
        self.has_received = False

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
            self.has_received = True
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


class MessageNumbers:
    """Numbers of one topic's messages, and what follows: how many were sent, lost, or received twice.

    ``sent`` counts from the first message received of each publisher, whose last number ``last`` has. What is
    skipped in a pause is not lost.
    """

    __slots__ = ("_gap_is_wanted", "_is_paused", "last", "lost", "sent")

    def __init__(self) -> None:
        self.sent = 0
        self.lost = 0
        self.last: dict[bytes, int] = {}
        self._is_paused = False
        self._gap_is_wanted = False

    def pause(self) -> None:
        """Most messages are skipped from now on."""
        self._is_paused = self._gap_is_wanted = True

    def resume(self) -> None:
        """From the next message on, none is skipped."""
        self._is_paused = False

    @property
    def skips(self) -> bool:
        """Whether messages are skipped, or were right before the next."""
        return self._is_paused or self._gap_is_wanted

    def go_on(self, last: Mapping[bytes, int]) -> None:
        """Go on after these last numbers."""
        self.last = dict(last)

    def is_new(self, publisher: bytes, number: int) -> bool:
        """Count message ``number`` of ``publisher``, unless it or a later one was received before."""
        last = self.last.get(publisher)
        if last is None:
            if len(self.last) >= MAX_PUBLISHERS:
                self.last.clear()
            last = number - 1
        elif number <= last:
            return False
        self.last[publisher] = number
        self.sent += number - last
        if not self._gap_is_wanted:
            self.lost += number - last - 1
        self._gap_is_wanted = self._is_paused
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


class RclSource:
    """Delivers what its subscription takes, in the order of ``priority`` among all subscriptions.

    While another takes what comes, it delivers nothing.

    To pause it changes to a subscription with a short queue, and to resume, to one with a long queue. Both
    are received until the new one has its first message; the numbers of the messages identify duplicates.
    """

    def __init__(
        self,
        subscribe: Callable[[Qos], RclSubscription],
        qos: Qos,
        receive: Receive,
        *,
        taker: RclTaker,
        wake_ups: RclWakeUps,
        priority: float,
    ) -> None:
        self.priority = priority
        self._subscribe = subscribe
        self._qos = qos
        self._receive = receive
        self._taker = taker
        self._wake_ups = wake_ups
        self._pauses = False
        self._is_armed = False
        self._kept: RclPayload | None = None
        self._successor: RclSubscription | None = None
        self._end_relay: Callable[[], None] | None = None
        self._subscription = self._open(qos)

    @property
    def sent(self) -> int | None:
        """Messages that the source has sent since the first received; ``None`` if they are not numbered."""
        numbers = self._taker.numbers
        return None if numbers is None else numbers.sent

    @property
    def dropped(self) -> int:
        """Messages that were lost on their way or in a full queue, as far as they are numbered."""
        numbers = self._taker.numbers
        return 0 if numbers is None else numbers.lost

    @property
    def numbers(self) -> MessageNumbers | None:
        """The numbers of its messages, if they have any."""
        return self._taker.numbers

    def hand_over(self, end_relay: Callable[[], None]) -> RclSubscription | None:
        """Let another take what comes, until ``take_back``: by which subscription; ``None``: not now.

        ``end_relay`` is called before the subscription is closed, and is to call ``take_back``.
        """
        numbers = self._taker.numbers
        if numbers is None or numbers.skips or self._pauses or self._successor is not None:
            return None
        self._end_relay = end_relay
        self.stop_waking()
        return self._subscription

    def stop_waking(self) -> None:
        """Call nothing for new messages; whatever was called for them has returned."""
        self._subscription.wake(wanted=False)

    def take_back(self) -> None:
        """Deliver again what comes, and what was announced to the other and not taken."""
        self._end_relay = None
        self._wake(self._subscription, wanted=True)

    def serve(self, most: int) -> bool:
        """Deliver up to ``most`` messages; whether there may be more."""
        if self._end_relay is not None:
            return False
        if self._is_paused and not self._is_armed:
            # What came just before the pause would be held back as the final message, a period too long.
            return False
        taker, subscription = self._taker, self._subscription
        for _ in range(most):
            payload = taker.take(subscription)
            if payload is None:
                return self._successor is not None and self._hand_over(self._successor)
            self._receive(payload, taker.publisher)
            if self._is_paused:
                self._kept = None
                self._is_armed = False
                self._wake(subscription, wanted=False)
                return False
        return True

    def pause(self) -> None:
        if not self._pauses and self._taker.numbers is not None:
            self._taker.numbers.pause()
            self._pauses = True
            self._succeed(replace(self._qos, depth=PAUSED_DEPTH))

    def arm(self) -> None:
        if self._is_paused:
            self._is_armed = True
            self._kept = self._taker.take_newest(self._subscription) or self._kept
            self._wake(self._subscription, wanted=True)

    def take_pending(self) -> bool:
        kept, self._kept = self._kept, None
        if kept is None:
            return False
        self._receive(kept, self._taker.publisher)
        return True

    def resume(self) -> None:
        if self._pauses and self._taker.numbers is not None:
            self._taker.numbers.resume()
            self._pauses = self._is_armed = False
            self.take_pending()
            self._wake(self._subscription, wanted=True)
            self._succeed(self._qos)

    @property
    def _is_paused(self) -> bool:
        return self._pauses and self._successor is None

    def close(self) -> None:
        if self._end_relay is not None:
            self._end_relay()
        self._kept = None
        self._pauses = False
        self._close(self._subscription)
        if self._successor is not None:
            self._close(self._successor)
        self._wake_ups.forget(self)
        self._taker.buffers.close()

    def _succeed(self, qos: Qos) -> None:
        """Change to ``qos``, or stay with it, if that was not yet left for good."""
        if self._successor is None:
            try:
                self._successor = self._open(qos)
            except RosError as error:
                # Then the queue stays as long as it was.
                self._taker.failed(error)
            return
        self._close(self._successor)
        self._successor = None
        if self._pauses:
            self._wake(self._subscription, wanted=False)

    def _hand_over(self, successor: RclSubscription) -> bool:
        payload = self._taker.take(successor)
        if payload is not None:
            self._receive(payload, self._taker.publisher)
        if successor.has_received:
            self._close(self._subscription)
            self._subscription, self._successor = successor, None
            self._wake(successor, wanted=not self._pauses)
        return payload is not None

    def _wake(self, subscription: RclSubscription, *, wanted: bool) -> None:
        try:
            subscription.wake(wanted=wanted)
        except RosError as error:
            self._taker.failed(error)

    def _open(self, qos: Qos) -> RclSubscription:
        subscription = self._subscribe(qos)
        self._wake_ups.add(subscription.event_fd, self)
        subscription.wake(wanted=True)
        return subscription

    def _close(self, subscription: RclSubscription) -> None:
        self._wake_ups.remove(subscription.event_fd)
        subscription.close()

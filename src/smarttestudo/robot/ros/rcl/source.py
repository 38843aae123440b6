# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A source, as the librcl path receives it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Qos, Receive
from smarttestudo.robot.ros.rcl.buffers import RclPayload
from smarttestudo.robot.ros.rcl.subscription import MessageNumbers, RclSubscription, RclTaker
from smarttestudo.robot.ros.rcl.wake_ups import RclWakeUps

RESTING_DEPTH = 2
"""With a queue of one, Fast DDS finds nothing in one take of three while messages come."""


class RclSource:
    """Delivers what its subscription takes, in the order of ``priority`` among all subscriptions.

    While another takes what comes, it delivers nothing.

    To rest it changes to a subscription with a short queue, and to work again, to one with a long queue. Both
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
        self._is_to_rest = False
        self._is_armed = False
        self._kept: RclPayload | None = None
        self._successor: RclSubscription | None = None
        self._end_relay: Callable[[], None] | None = None
        self._subscription = self._open(qos)

    @property
    def sent(self) -> int | None:
        """Messages that the source has sent since the first that came; ``None`` if they are not numbered."""
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
        if numbers is None or numbers.skips or self._is_to_rest or self._successor is not None:
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
        if self._rests and not self._is_armed:
            # What came just before it rests would be held back as the final message, a period too long.
            return False
        taker, subscription = self._taker, self._subscription
        for _ in range(most):
            payload = taker.take(subscription)
            if payload is None:
                return self._successor is not None and self._hand_over(self._successor)
            self._receive(payload, taker.publisher)
            if self._rests:
                self._kept = None
                self._is_armed = False
                self._wake(subscription, wanted=False)
                return False
        return True

    def pause(self) -> None:
        """Wake for no message from now on."""
        if not self._is_to_rest and self._taker.numbers is not None:
            self._taker.numbers.pause()
            self._is_to_rest = True
            self._succeed(replace(self._qos, depth=RESTING_DEPTH))

    def arm(self) -> None:
        """Receive the next message, then rest on; the newest that came while resting is kept for now."""
        if self._rests:
            self._is_armed = True
            self._kept = self._taker.take_newest(self._subscription) or self._kept
            self._wake(self._subscription, wanted=True)

    def take_pending(self) -> bool:
        """Receive what ``arm`` kept, since nothing newer came; whether there was anything."""
        kept, self._kept = self._kept, None
        if kept is None:
            return False
        self._receive(kept, self._taker.publisher)
        return True

    def resume(self) -> None:
        """Receive every message again."""
        if self._is_to_rest and self._taker.numbers is not None:
            self._taker.numbers.resume()
            self._is_to_rest = self._is_armed = False
            self.take_pending()
            self._wake(self._subscription, wanted=True)
            self._succeed(self._qos)

    @property
    def _rests(self) -> bool:
        return self._is_to_rest and self._successor is None

    def close(self) -> None:
        """Receive nothing more."""
        if self._end_relay is not None:
            self._end_relay()
        self._kept = None
        self._is_to_rest = False
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
        if self._is_to_rest:
            self._wake(self._subscription, wanted=False)

    def _hand_over(self, successor: RclSubscription) -> bool:
        payload = self._taker.take(successor)
        if payload is not None:
            self._receive(payload, self._taker.publisher)
        if successor.is_heard:
            self._close(self._subscription)
            self._subscription, self._successor = successor, None
            self._wake(successor, wanted=not self._is_to_rest)
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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Relays of topics that are taken and published by relay.c."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import c_void_p
from functools import partial
from typing import Any

from rclpy.utilities import get_rmw_implementation_identifier

from smarttestudo.domain.compiled_relay import CompiledRelay, Copying, MessageCopy, RelayCounts, RelayState
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Publisher, Subscription
from smarttestudo.robot.ros.rcl.bindings import InfoLayout, RclLibrary
from smarttestudo.robot.ros.rcl.message_copies import CopiedSource, MessageCopies
from smarttestudo.robot.ros.rcl.publisher import RclPublisher
from smarttestudo.robot.ros.rcl.relay_library import (
    RelayFunctions,
    RelayLibrary,
    RelaySettings,
    c_ns,
    python_ns,
)
from smarttestudo.robot.ros.rcl.subscription import MessageNumbers, RclSource

TAKES_ON_CALLBACK = "rmw_fastrtps"
"""The middleware whose callbacks may take messages; with another one, the topic's thread does."""


class RclRelays:
    """Makes relays on subscriptions and publishers of librcl's path, as ``CompiledRelays``.

    ``is_simulated`` says whether the clock is, which a relay does not read; ``failed`` gets errors.
    ``copies`` are those of the messages of all relays.
    """

    def __init__(
        self,
        relays: RelayLibrary,
        library: RclLibrary,
        layout: InfoLayout,
        is_simulated: Callable[[], bool],
        failed: Callable[[RosError], None],
    ) -> None:
        self._relays = relays
        self.copies = MessageCopies(failed)
        self._is_simulated = is_simulated
        self._failed = failed
        self._gid_bytes = layout.gid_bytes
        self._begun: set[RclRelay] = set()
        self._settings = relay_settings(library, layout)

    @property
    def can_relay(self) -> bool:
        """Whether there may be any now: relays read the system's clock."""
        return not self._is_simulated()

    def serves(self, subscription: Subscription, publisher: Publisher | None) -> bool:
        """Whether there may be a relay between these two, or one that publishes nothing."""
        is_published = publisher is None or isinstance(publisher, RclPublisher)
        return isinstance(subscription, RclSource) and is_published

    def begin(
        self,
        subscription: Subscription,
        publisher: Publisher | None,
        state: Callable[[], RelayState],
        ended: Callable[[RelayState], None],
        copying: Copying,
    ) -> CompiledRelay | None:
        """Relay from ``state`` on; ``None``: not yet."""
        assert isinstance(subscription, RclSource)
        assert publisher is None or isinstance(publisher, RclPublisher)
        copies = RelayCopies(self.copies, subscription, self._gid_bytes, copying)
        relay = RclRelay(self._relays, subscription, publisher, self._failed, self._gid_bytes, copies=copies)

        def forget(last: RelayState) -> None:
            self._begun.discard(relay)
            ended(last)

        if not relay.begin(self._settings, state, forget):
            return None
        self._begun.add(relay)
        return relay

    def deliver(self, steady_ns: int) -> None:
        """Give the copies that were made by ``steady_ns``."""
        self.copies.deliver(steady_ns)

    def close(self) -> None:
        """End all relays."""
        for relay in list(self._begun):
            relay.end()
        self.copies.close()


def relay_settings(library: RclLibrary, layout: InfoLayout) -> dict[str, Any]:
    """Settings that all relays have in common."""
    return {
        "rcl": RelayFunctions(**library.relay_functions),
        "allocator": library.allocator,
        "gid_bytes": layout.gid_bytes,
        "takes_on_callback": get_rmw_implementation_identifier().startswith(TAKES_ON_CALLBACK),
    }


class RelayCopies:
    """Copies of the messages of one source, each given once, and counted by the source."""

    def __init__(self, copies: MessageCopies, source: RclSource, gid_bytes: int, copying: Copying) -> None:
        self._copies = copies
        self._source = source
        self._gid_bytes = gid_bytes
        self._copying = copying
        self._sources: list[CopiedSource] = []

    @property
    def counts(self) -> bool:
        """Whether the source's messages are counted by their copies."""
        return self._copying.received is not None

    def begin(self, settings: RelaySettings) -> None:
        """Have a relay of ``settings`` copy what it takes, or what it lets pass."""
        copies, copying = self._copies, self._copying
        if copying.received is not None:
            taken = copies.of_taken(
                c_void_p(settings.rcl.take),
                settings.subscription,
                self._gid_bytes,
                partial(self._receive, copying.received),
                has_payload=copying.has_payload,
            )
            settings.rcl.take, settings.subscription = copies.take, taken.address
            self._sources.append(taken)
        on_passed = copying.passed
        if on_passed is not None:
            passed = copies.of_passed(self._gid_bytes, lambda _, copy: on_passed(copy))
            settings.rcl.publish, settings.publisher = copies.publish, passed.address
            settings.publishes_at_once = settings.gives_gid = True
            self._sources.append(passed)

    def end(self, sent: int) -> None:
        """Give all that was copied; of so many messages that were sent, what was not copied is lost."""
        if self._sources:
            self._copies.remove(self._sources)
        numbers = self._source.numbers
        if self.counts and numbers is not None and sent > numbers.sent:
            numbers.lost += sent - numbers.sent
            numbers.sent = sent

    def _receive(self, receive: Callable[[MessageCopy], None], number: int, copy: MessageCopy) -> None:
        numbers = self._source.numbers
        if numbers is not None and numbers.is_new(copy.publisher, number):
            receive(copy)


class RclRelay:
    """One topic that is relayed by relay.c."""

    def __init__(
        self,
        library: RelayLibrary,
        source: RclSource,
        publisher: RclPublisher | None,
        failed: Callable[[RosError], None],
        gid_bytes: int,
        *,
        copies: RelayCopies,
    ) -> None:
        self._library = library
        self._source = source
        self._publisher = publisher
        self._failed = failed
        self._gid_bytes = gid_bytes
        self._period_ns = 0
        self._errors = 0
        self._has_thread = False
        self._relay: int | None = None
        self._copies = copies

    def begin(
        self, settings: dict[str, Any], state: Callable[[], RelayState], ended: Callable[[RelayState], None]
    ) -> bool:
        """Begin, if the source is ready for it."""
        library, source, numbers = self._library, self._source, self._source.numbers
        subscription = source.hand_over(self.end)
        if subscription is None or numbers is None:
            return False
        self._ended = ended
        start = state()
        if not numbers.last.keys() >= {
            stream.publisher for stream in start.streams if stream.held is not None
        }:
            # The last number of a publisher was forgotten, and its last word must not be.
            ended(start)
            source.take_back()
            return False
        self._period_ns = start.period_ns
        all_settings = self._all_settings(settings, subscription.pointer, start, numbers)
        self._copies.begin(all_settings)
        if self._publisher is not None:
            self._publisher.serve(self.end)
        self._relay = relay = library.new(all_settings)
        streams = {stream.publisher: stream for stream in start.streams}
        for gid, number in numbers.last.items():
            library.add_stream(relay, streams.get(gid), gid, number)
        self._has_thread = bool(library.start(relay))
        try:
            if self._has_thread:
                subscription.call(library.on_message, relay)
                return True
        except RosError as error:
            self._failed(error)
        self.end()
        return False

    def _all_settings(
        self, common: dict[str, Any], subscription: int, start: RelayState, numbers: MessageNumbers
    ) -> RelaySettings:
        publisher = self._publisher
        return RelaySettings(
            **common,
            subscription=subscription,
            publisher=None if publisher is None else publisher.pointer,
            period_ns=c_ns(start.period_ns),
            publishes_at_once=publisher is not None
            and not publisher.is_reliable
            and common["takes_on_callback"],
            counts=RelayCounts(
                arrived=start.counts.arrived,
                relayed=start.counts.relayed,
                sent=numbers.sent,
                lost=numbers.lost,
                now_ns=start.now_ns,
            ),
        )

    def set_pace(self, period_ns: int) -> None:
        """Follow another pace from now on."""
        if self._relay is not None and period_ns != self._period_ns:
            self._period_ns = period_ns
            self._library.set_pace(self._relay, period_ns)

    def counts(self) -> RelayCounts:
        """The counts as of now."""
        assert self._relay is not None
        return self._read(self._relay)

    def end(self) -> None:
        """Relay nothing more; what was not taken yet comes to the source as before."""
        relay, library, numbers = self._relay, self._library, self._source.numbers
        if relay is None or numbers is None:
            return
        self._relay = None
        self._source.stop_waking()
        if self._has_thread:
            library.stop(relay)
        if self._publisher is not None:
            self._publisher.serve(None)
        counts, streams = self._read(relay), library.streams(relay)
        self._copies.end(counts.sent)
        numbers.go_on({bytes(stream.gid[: self._gid_bytes]): stream.number for stream in streams})
        state = RelayState(
            now_ns=counts.now_ns,
            period_ns=python_ns(self._period_ns),
            streams=[stream.paced_stream(self._gid_bytes) for stream in streams if stream.is_open],
            counts=counts,
        )
        library.free(relay)
        self._ended(state)
        self._source.take_back()

    def _read(self, relay: int) -> RelayCounts:
        counts, numbers = self._library.counts(relay), self._source.numbers
        if numbers is not None and not self._copies.counts:
            numbers.sent, numbers.lost = counts.sent, counts.lost
        if counts.errors > self._errors:
            self._errors = counts.errors
            error = counts.error.decode("utf-8", "replace").partition("\n")[0]
            place = None if self._publisher is None else self._publisher.topic
            self._failed(RosError(f"librcl: {error}", place=place))
        return counts

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of what operators send to robots, over Zenoh."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace

import zenoh

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.link import CommandTopic
from smarttestudo.domain.robot import Publisher
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.commands import CommandedRobot, CommandReceiver, CommandSender
from smarttestudo.link.protocol.keys import ALL_ACCEPTS, MAX_ROBOTS, Boot, boot_of
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.session import OPERATOR, OtherVersions


class CommandInbox:
    """Publishes what operators send, in the thread in which it comes, and reports to them.

    ``clock`` gives ns that pass while the machine is suspended, too.
    """

    def __init__(
        self,
        session: zenoh.Session,
        boot: Boot,
        topics: Sequence[str],
        warn: Callable[[str], None],
        clock: Callable[[], int],
    ) -> None:
        self.has_operator = False
        """Whether an operator's end that sends anything is connected."""
        self._warn = warn
        self._clock = clock
        self._key = boot.command_key
        self._receiver = CommandReceiver(topics)
        self._publishers: dict[str, Publisher | None] = dict.fromkeys(topics)
        self._failures: set[str] = set()
        self._lock = threading.Lock()
        self._versions = OtherVersions(warn)
        self._worker = Worker(
            "link-accept", lambda error: warn(f"the link accepts nothing more: {error}"), self._poll
        )
        # A report that does not get through is followed by another that says all that it said.
        self._reports = session.declare_publisher(
            boot.accepts_key,
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.REAL_TIME,
            express=True,
        )
        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = (
            self._reports.declare_matching_listener(self._match),
            session.declare_subscriber(self._key, self._on_command),
        )
        self._worker.start()

    @property
    def topics(self) -> list[CommandTopic]:
        with self._lock:
            return self._receiver.topics

    @property
    def malformed(self) -> int:
        """Frames that were not readable, or of no accepted topic."""
        return self._receiver.malformed

    def sent_names(self) -> list[tuple[str, ...]]:
        """The names that each operator's end sends, of the ends that were heard lately."""
        with self._lock:
            return self._receiver.sent_names(self._clock())

    def follow(
        self, topic: str, type_name: str | None, publisher: Publisher | None, problem: str | None = None
    ) -> None:
        """From now on give ``publisher`` the messages of ``topic``, which are of that type."""
        with self._lock:
            self._receiver.follow(topic, type_name, problem)
            self._publishers[topic] = publisher
        self._worker.wake()

    def close(self) -> None:
        """Deliver nothing more; the session is to be closed then."""
        with self._lock:
            self._publishers = dict.fromkeys(self._publishers)
        self._worker.close()

    def _match(self, status: zenoh.MatchingStatus) -> None:
        self.has_operator = status.matching

    def _on_command(self, sample: zenoh.Sample) -> None:
        # Access control denies this key; a wider one, which includes it, passes there.
        if str(sample.key_expr) != self._key:
            return
        data = sample.payload.to_bytes()
        self._versions.check(OPERATOR, data)
        with self._lock:
            delivery = self._receiver.receive(data, self._clock())
            publisher = None if delivery is None else self._publishers[delivery.topic]
            if delivery is not None and publisher is not None:
                try:
                    publisher.publish(delivery.payload)
                except TestudoError as error:
                    self._receiver.fail(delivery.topic)
                    self._say(str(error))
        self._worker.wake()

    def _say(self, line: str) -> None:
        if line not in self._failures:
            self._failures.add(line)
            self._warn(line)

    def _poll(self) -> float:
        """Report where that is due; after how many seconds to poll again."""
        with self._lock:
            now_ns = self._clock()
            wake_ns = self._receiver.wake_ns
            report = self._receiver.next_report(now_ns) if wake_ns <= now_ns else None
        if report is None:
            return (wake_ns - now_ns) / NS_PER_S
        self._reports.put(report)
        return 0.0


class CommandOutbox:
    """Sends messages of ``names`` to robots that accept them; ``pump`` is to be called ten times a second.

    ``clock`` gives ns that pass while the machine is suspended, too.
    """

    def __init__(
        self,
        session: zenoh.Session,
        names: Sequence[str],
        warn: Callable[[str], None],
        clock: Callable[[], int],
    ) -> None:
        self.names = tuple(names)
        self._session = session
        self._warn = warn
        self._clock = clock
        self._senders: dict[Boot, CommandSender] = {}
        self._has_failed = False
        self._lock = threading.Lock()
        self._kept = session.declare_subscriber(ALL_ACCEPTS, self._on_report)

    def robots(self) -> list[CommandedRobot]:
        with self._lock:
            now_ns = self._clock()
            return [
                CommandedRobot(
                    boot=boot,
                    topics=sender.topics,
                    counts={topic: replace(counts) for topic, counts in sender.counts.items()},
                    round_trip_ms=sender.round_trip_ms,
                )
                for boot, sender in self._senders.items()
                if sender.is_present(now_ns)
            ]

    def send(self, boot: Boot, topic: str, publisher: Hashable, payload: bytes) -> bool:
        """Have a message sent instead of an earlier one of its publisher; whether it is small enough."""
        with self._lock:
            sender = self._senders.get(boot)
            is_taken = sender is None or sender.put(topic, publisher, payload, self._clock())
            self._pump()
        return is_taken

    def pump(self) -> None:
        with self._lock:
            self._pump()

    def _on_report(self, sample: zenoh.Sample) -> None:
        boot = boot_of(str(sample.key_expr))
        if boot is None:
            return
        with self._lock:
            now_ns = self._clock()
            sender = self._senders.get(boot) or self._add(boot, now_ns)
            if sender is not None:
                sender.handle_report(sample.payload.to_bytes(), now_ns)
            self._pump()

    def _add(self, boot: Boot, now_ns: int) -> CommandSender | None:
        if len(self._senders) >= MAX_ROBOTS:
            gone = next(
                (gone_key for gone_key, sender in self._senders.items() if not sender.is_present(now_ns)),
                None,
            )
            if gone is None:
                return None
            del self._senders[gone]
        sender = self._senders[boot] = CommandSender(self.names, lambda: secrets.randbits(64))
        return sender

    def _pump(self) -> None:
        for boot, sender in self._senders.items():
            while (data := sender.next_command(self._clock())) is not None:
                self._put(boot, data)

    def _put(self, boot: Boot, data: bytes) -> None:
        try:
            # What waits would be old: what the link does not take now is dropped.
            self._session.put(
                boot.command_key,
                data,
                congestion_control=zenoh.CongestionControl.DROP,
                priority=zenoh.Priority.REAL_TIME,
                express=True,
            )
        except zenoh.ZError as error:
            if not self._has_failed:
                self._has_failed = True
                self._warn(f"{boot.robot} is sent nothing: {error}")

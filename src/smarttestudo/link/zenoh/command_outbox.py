# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The operator's end of what is sent to robots, over Zenoh."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace

import zenoh

from smarttestudo.link.protocol.command_sender import CommandedRobot, CommandSender
from smarttestudo.link.protocol.keys import ALL_ACCEPTS, MAX_ROBOTS, Boot, boot_of


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
        """The robots that were heard lately."""
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
        """Send what is due."""
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
            gone = next((one for one, sender in self._senders.items() if not sender.is_present(now_ns)), None)
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

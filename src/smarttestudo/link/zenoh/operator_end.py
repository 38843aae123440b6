# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The operator's end of the links of all robots, over Zenoh."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.robot import Qos
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.datagrams import (
    DATAGRAM_OFFERS,
    DATAGRAM_REQUESTS,
    DATAGRAM_VERSION,
    FORGOTTEN_AFTER_NS,
    PING_PERIOD_NS,
    DatagramRequest,
)
from smarttestudo.link.protocol.keys import ALL_BOOTS, ALL_DATA, MAX_ROBOTS, Boot, boot_of
from smarttestudo.link.protocol.messages import Announcement
from smarttestudo.link.protocol.receiver import KEEP_ALIVE_NS, LinkReceiver, ReceiverCounts
from smarttestudo.link.protocol.repair import DATAGRAM_BYTES
from smarttestudo.link.protocol.status_stream import Record
from smarttestudo.link.protocol.wire import other_version
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.arrivals import EventQueue, LinkEvent, RobotPresence, StreamSaid
from smarttestudo.link.zenoh.commands import CommandOutbox
from smarttestudo.link.zenoh.compression import decompress
from smarttestudo.link.zenoh.incidents import LinkIncidents
from smarttestudo.link.zenoh.queries import QueryClient, Reply
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.link.zenoh.session import OtherVersions, robot_peer
from smarttestudo.link.zenoh.statuses import StatusListener
from smarttestudo.pacing.cdr import string_message

if TYPE_CHECKING:
    from smarttestudo.link.zenoh.datagrams import Datagrams, Peer

STATUS_STREAM = StreamInfo(
    topic=STATUS_TOPIC, type_name="std_msgs/msg/String", qos=Qos(reliable=True, transient_local=True, depth=1)
)
"""The stream as which statuses arrive."""
_LEFT_AFTER_NS = 3 * PING_PERIOD_NS
"""A robot of which no datagram came for so long is not there by datagrams alone."""
_LONGEST_AGAIN_NS = 16 * NS_PER_S
_STATUS_NUMBER = 0
"""No stream of the robot's end has it."""


@dataclass(slots=True, eq=False)
class _Robot:
    """A run of a robot's end; those that are gone are kept, as an outage takes a robot away for a while."""

    boot: Boot
    receiver: LinkReceiver
    is_present: bool = True
    has_token: bool = True
    """Whether the reliable link says that it is there; one that moves may be there by datagrams alone."""
    reported_ns: int = 0
    """When it was last reported over the reliable link."""
    ask_ns: int = 0
    """When to ask for a key for datagrams."""
    again_ns: int = NS_PER_S
    lock: threading.Lock = field(default_factory=threading.Lock)


class OperatorEnd:
    """Finds robots, receives what they send, and reports it to them; no thread waits for who reads it."""

    def __init__(
        self,
        session: zenoh.Session,
        warn: Callable[[str], None],
        clock: Callable[[], int],
        most_waiting_bytes: int,
        predicts: frozenset[str] = frozenset(),
        *,
        receiver: int | None = None,
    ) -> None:
        """``predicts`` are the topics that who reads here reckons where the robot's end does so too.

        ``receiver`` is the number by which robots know this end.
        """
        self.unknown = 0
        """Chunks of robots that are not known here."""
        self.commands: CommandOutbox | None = None
        """Messages to robots, where any are sent."""
        self._session = session
        self._warn = warn
        self._clock = clock
        self._predicts = predicts
        self._receiver = secrets.randbits(64) if receiver is None else receiver
        self._arrivals = EventQueue(most_waiting_bytes)
        self._robots: dict[str, _Robot] = {}
        self._said_twice: set[str] = set()
        self._was_full = False
        self._lock = threading.Lock()
        self._has_status: set[Boot] = set()
        self._datagrams: Datagrams | None = None
        self._versions = OtherVersions(warn)
        self._poll_ns = 0
        self._worker = Worker("link-report", lambda error: warn(f"robots get no report: {error}"), self._poll)
        self._statuses = StatusListener(session, self._on_status, self._versions, self._worker.wake)
        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = (
            session.declare_subscriber(ALL_DATA, self._on_chunk),
            session.liveliness().declare_subscriber(ALL_BOOTS, self._on_token, history=True),
        )
        self._worker.start()

    def take_datagrams(self, options: LinkOptions) -> None:
        """Ask robots from now on to send what they relay as datagrams."""
        from smarttestudo.link.zenoh.datagrams import Datagrams  # noqa: PLC0415  needs cryptography

        datagrams = Datagrams(
            options, self._clock, self._on_datagram, lambda _reached: None, self._warn, is_robot=False
        )
        self._client, self._datagrams = QueryClient(self._session), datagrams
        self._worker.wake()

    def wait(self, timeout_s: float) -> list[LinkEvent]:
        """The events since the last call, in their order, as soon as there is one; else nothing."""
        return self._arrivals.wait(timeout_s)

    def incidents(self) -> LinkIncidents:
        """The incidents of the robots that are heard; to be closed before this end."""
        return LinkIncidents(QueryClient(self._session), "here")

    @property
    def dropped(self) -> int:
        """Events that gave way because ``wait`` was not called for long."""
        return self._arrivals.dropped

    def counts(self) -> Mapping[Boot, ReceiverCounts]:
        return {robot.boot: replace(robot.receiver.counts) for robot in self._present()}

    def close(self) -> None:
        """Receive nothing more; the session is to be closed then."""
        self._worker.close()
        if self._datagrams is not None:
            self._datagrams.close()

    def _on_datagram(self, peer: Peer, data: bytes) -> None:
        robot = self._robots.get(peer.name)
        if robot is None or not robot.is_present:
            self.unknown += 1
            return
        with robot.lock:
            found = robot.receiver.receive_datagram(data, self._clock())
            wake_ns = robot.receiver.wake_ns
            for one in found:
                self._put(robot, one)
        if wake_ns < self._poll_ns:
            self._worker.wake()

    def _put(self, robot: _Robot, found: Announcement | ReceivedMessage) -> None:
        if isinstance(found, Announcement):
            name, number = robot.boot
            self._arrivals.put(StreamSaid(robot=name, boot=number, number=found.stream, info=found.info))
        else:
            self._arrivals.put(found)

    def _ask_for_datagrams(self, robot: _Robot, now_ns: int) -> None:
        """Ask for a key while no datagram comes, ever later: an older robot's end does not answer."""
        datagrams, boot = self._datagrams, robot.boot
        if datagrams is None or now_ns < robot.ask_ns or datagrams.is_heard(boot.key, FORGOTTEN_AFTER_NS):
            return
        robot.ask_ns, robot.again_ns = now_ns + robot.again_ns, min(2 * robot.again_ns, _LONGEST_AGAIN_NS)
        request = DatagramRequest(receiver=self._receiver, version=DATAGRAM_VERSION, port=datagrams.port)

        def answered(reply: Reply) -> None:
            if isinstance(reply, bytes):
                with suppress(LinkError):
                    offer = DATAGRAM_OFFERS.from_bytes(reply)
                    datagrams.add(boot.key, offer.connection, offer.key, offer.port)

        self._client.get(boot.datagrams_key, DATAGRAM_REQUESTS.to_bytes(request), answered)

    def _on_chunk(self, sample: zenoh.Sample) -> None:
        robot = self._robots.get(str(sample.key_expr).removesuffix("/data"))
        if robot is None or not robot.is_present:
            self.unknown += 1
            return
        data = sample.payload.to_bytes()
        if other_version(data) is not None:
            self._versions.check(robot_peer(robot.boot), data)
        with robot.lock:
            found = robot.receiver.receive(data, self._clock())
            wake_ns = robot.receiver.wake_ns
            if found is not None:
                self._put(robot, found)
        if wake_ns < self._poll_ns:
            self._worker.wake()

    def _on_status(self, boot: Boot, record: Record, _size_bytes: int) -> None:
        """A status is another message of the robot for who reads here."""
        name, number = boot
        if boot not in self._has_status:
            self._has_status.add(boot)
            said = StreamSaid(robot=name, boot=number, number=_STATUS_NUMBER, info=STATUS_STREAM)
            self._arrivals.put(said)
        text = json_text(record, ascii_only=False)
        message = ReceivedMessage(
            robot=name,
            stream=STATUS_STREAM,
            payload=string_message(text),
            offered_ns=0,
            age_ns=None,
            boot=number,
        )
        self._arrivals.put(message)

    def _on_token(self, sample: zenoh.Sample) -> None:
        boot = boot_of(str(sample.key_expr))
        if boot is None:
            return
        has_token = sample.kind == zenoh.SampleKind.PUT
        with self._lock:
            known = self._robots.get(boot.key)
            if has_token == (known is not None and known.has_token):
                return
            robot = known or self._add(boot)
            if robot is None:
                return
            robot.has_token = has_token
            robot.ask_ns, robot.again_ns = 0, NS_PER_S
            is_present = has_token or self._is_heard(robot)
            is_news = known is None or known.is_present != is_present
            robot.is_present = is_present
        if is_news:
            self._say_presence(robot)
        (self._statuses.add if has_token else self._statuses.remove)(boot)
        if not has_token:
            self._has_status.discard(boot)
        self._worker.wake()
        if has_token:
            self._warn_of_namesakes(boot.robot)

    def _say_presence(self, robot: _Robot) -> None:
        name, boot = robot.boot
        self._arrivals.put(RobotPresence(robot=name, boot=boot, is_present=robot.is_present))
        if robot.is_present:
            self._say_streams(robot)

    def _is_heard(self, robot: _Robot) -> bool:
        return self._datagrams is not None and self._datagrams.is_heard(robot.boot.key, _LEFT_AFTER_NS)

    def _leave_unheard(self, robot: _Robot) -> None:
        """Have a robot be gone that the reliable link lost, once its datagrams end as well."""
        with self._lock:
            if robot.has_token or not robot.is_present or self._is_heard(robot):
                return
            robot.is_present = False
        self._say_presence(robot)

    def _say_streams(self, robot: _Robot) -> None:
        """Say what a robot that is back has: whoever reads may have given it up for another of its name."""
        name, boot = robot.boot
        with robot.lock:
            for number, info in robot.receiver.streams.items():
                self._arrivals.put(StreamSaid(robot=name, boot=boot, number=number, info=info))

    def _add(self, boot: Boot) -> _Robot | None:
        if len(self._robots) >= MAX_ROBOTS:
            gone = next((key for key, robot in self._robots.items() if not robot.is_present), None)
            if gone is None:
                if not self._was_full:
                    self._was_full = True
                    self._warn(f"{boot.robot} is not received: there are {MAX_ROBOTS} robots already")
                return None
            del self._robots[gone]
            if self._datagrams is not None:
                self._datagrams.remove(gone)
        receiver = LinkReceiver(boot.robot, self._receiver, decompress, self._predicts, boot=boot.number)
        robot = self._robots[boot.key] = _Robot(boot, receiver)
        return robot

    def _warn_of_namesakes(self, name: str) -> None:
        count = sum(robot.boot.robot == name and robot.has_token for robot in self._present())
        if count > 1 and name not in self._said_twice:
            self._said_twice.add(name)
            self._warn(f"{count} robots are called {name}: give each a name of its own with --robot")

    def _present(self) -> list[_Robot]:
        with self._lock:
            return [robot for robot in self._robots.values() if robot.is_present]

    def _poll(self) -> float:
        """Report where that is due, and ask for statuses; after how many seconds to poll again."""
        now_ns = self._clock()
        # Whatever is due before that from here on wakes the thread.
        poll_ns = self._poll_ns = now_ns + KEEP_ALIVE_NS
        for robot in self._present():
            self._leave_unheard(robot)
            self._ask_for_datagrams(robot, now_ns)
            poll_ns = min(poll_ns, self._report(robot, now_ns))
        self._poll_ns = poll_ns
        return min(max(0, poll_ns - self._clock()) / NS_PER_S, self._statuses.poll())

    def _peer(self, robot: _Robot) -> Peer | None:
        return None if self._datagrams is None else self._datagrams.peer(robot.boot.key)

    def _report(self, robot: _Robot, now_ns: int) -> int:
        """Send the report of a robot where one is due; when the next is."""
        receiver = robot.receiver
        with robot.lock:
            is_due, has_news = receiver.wake_ns <= now_ns, receiver.has_news
            report = receiver.next_report(now_ns) if is_due else None
            wake_ns = receiver.wake_ns
            if is_due and has_news:
                # Most likely more comes, which is due then and need not wake the thread first.
                wake_ns = min(wake_ns, now_ns + receiver.report_period_ns)
            peer = self._peer(robot) if is_due and receiver.is_by_datagrams else None
        is_small = report is not None and len(report) <= DATAGRAM_BYTES
        if report is not None and is_small and peer is not None and self._datagrams is not None:
            self._datagrams.send(peer, report)
            # The reliable link says that somebody is there where datagrams come through no more.
            if has_news and now_ns - robot.reported_ns < KEEP_ALIVE_NS:
                return wake_ns
        if report is not None:
            robot.reported_ns = now_ns
            try:
                # A report that does not get through is followed by another that says all that it said.
                self._session.put(
                    robot.boot.report_key,
                    report,
                    congestion_control=zenoh.CongestionControl.DROP,
                    priority=zenoh.Priority.REAL_TIME,
                    express=True,
                )
            except zenoh.ZError as error:
                if not self._worker.is_closed:
                    self._warn(f"{robot.boot.robot} gets no report: {error}")
        return wake_ns

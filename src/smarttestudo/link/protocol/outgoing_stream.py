# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One stream of the robot's end: what of it waits, and what may not have arrived."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Hashable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from smarttestudo.domain.link import LinkNeeds, MessageOrigin, StreamCounts
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.coded_video import VideoGroup

LOSING_NS = 60 * NS_PER_S
"""For how long a topic that lost a message is said to lose some."""


class Encoded(NamedTuple):
    """A message as it travels."""

    data: bytes
    is_compressed: bool = False


Encode = Callable[[int, bytes], Encoded]
"""Makes of a message of a stream what travels."""


def plain(_stream: int, payload: bytes) -> Encoded:
    return Encoded(payload)


@dataclass(slots=True, eq=False)
class OutgoingMessage:
    """A message that waits or is being sent; ``encoded`` is what travels, from the first chunk on.

    A message that ``is_kept`` is sent again until it arrives. A message with an ``origin`` goes to who keeps
    what is missed. ``unsettled`` counts the sessions that ended before it was known whether it arrived in
    them. One that ``begins_group`` of coded video can be decoded without those before it.
    """

    stream: int
    number: int
    payload: bytes
    offered_ns: int
    is_kept: bool
    lane: Hashable = None
    origin: MessageOrigin | None = None
    encoded: Encoded | None = None
    offset: int = 0
    unsettled: int = 0
    begins_group: bool = False

    @property
    def rest_bytes(self) -> int:
        return len(self.payload if self.encoded is None else self.encoded.data) - self.offset


@dataclass(slots=True, eq=False)
class SentMessage:
    """A message of a session by datagrams, from its first part on; its parts are known by their offsets.

    It is the ``turn``-th of its stream in the session, ``before`` of those before it arrive in order, and it
    may be one of these. ``ends`` says where each copy of a part ends in the session, ``missing`` which parts
    are to be sent again. It ``is_over`` once it has arrived, or nothing more can become of it.
    """

    stream: OutgoingStream
    message: OutgoingMessage
    turn: int
    before: int
    is_in_order: bool
    parts: int
    ends: dict[int, list[int]] = field(default_factory=dict)
    arrived: set[int] = field(default_factory=set)
    missing: deque[int] = field(default_factory=deque)
    whole_ns: int | None = None
    """When its last part was sent first."""
    was_repaired: bool = False
    given_up: LossReason | None = None
    is_over: bool = False

    @property
    def has_arrived(self) -> bool:
        return len(self.arrived) == self.parts


class LossReason(Enum):
    """Why a message of which parts were lost is not sent again."""

    REPLACED = "replaced"
    LATE = "late"


@dataclass(slots=True, eq=False)
class OutgoingStream:
    """One stream: ``slots`` has messages that newer ones of their ``lanes`` may replace, ``queue`` others.

    ``video`` is there of coded video: its last group, broken where a frame of it gave way. ``repairs`` have
    parts that are to be sent again, the oldest first. The stream waits until ``announcement`` has arrived.
    """

    number: int
    needs: LinkNeeds
    latched: deque[OutgoingMessage] | None
    slots: dict[int, OutgoingMessage] = field(default_factory=dict)
    lanes: dict[Hashable, deque[int]] = field(default_factory=dict)
    slots_bytes: int = 0
    queue: deque[OutgoingMessage] = field(default_factory=deque)
    begun: OutgoingMessage | None = None
    queued_bytes: int = 0
    floor_due_ns: int = 0
    is_floor_begun: bool = False
    next_number: int = 0
    sent: int = 0
    replaced: int = 0
    overflowed: int = 0
    overflowed_ns: int | None = None
    video: VideoGroup | None = None
    repairs: deque[SentMessage] = field(default_factory=deque)
    announcement: OutgoingMessage | None = None
    repaired: int = 0
    lost_replaced: int = 0
    lost_late: int = 0
    sent_bytes: int = 0
    repair_bytes: int = 0

    @property
    def has_work(self) -> bool:
        """Whether anything waits or is being sent."""
        return self.begun is not None or bool(self.queue) or bool(self.slots) or bool(self.repairs)

    def repair(self, sent: SentMessage) -> None:
        """Have the missing parts of a message sent again, before later ones."""
        if sent in self.repairs:
            return
        place = sum(other.turn < sent.turn for other in self.repairs)
        self.repairs.insert(place, sent)

    def lose(self, sent: SentMessage) -> None:
        """Count a message that was given up and did not arrive."""
        if sent.given_up is LossReason.REPLACED:
            self.lost_replaced += 1
        else:
            self.lost_late += 1

    @property
    def waiting(self) -> Iterator[OutgoingMessage]:
        """The messages that were not sent whole."""
        if self.begun is not None:
            yield self.begun
        yield from self.queue
        yield from self.slots.values()

    @property
    def next_message(self) -> OutgoingMessage:
        """The message that goes next; there must be one."""
        if self.repairs:
            return self.repairs[0].message
        if self.begun is not None:
            return self.begun
        return self.next_waiting

    @property
    def next_waiting(self) -> OutgoingMessage:
        """The first message of those that have not begun; there must be one."""
        if not self.slots:
            return self.queue[0]
        slot = next(iter(self.slots.values()))
        return self.queue[0] if self.queue and self.queue[0].offered_ns <= slot.offered_ns else slot

    def is_urgent(self, now_ns: int) -> bool:
        """Whether it goes before others: latched, or below its floor."""
        if self.latched is not None:
            return True
        return self.needs.floor_hz > 0 and (self.is_floor_begun or now_ns >= self.floor_due_ns)

    def begin(self, now_ns: int) -> OutgoingMessage:
        """Take the message that goes next out of what waits."""
        message = self.next_waiting
        if self.slots.get(message.number) is message:
            self.take_slot(message.number)
        else:
            self.take_queued()
        self.begun = message
        floor_hz = self.needs.floor_hz
        self.is_floor_begun = floor_hz > 0 and now_ns >= self.floor_due_ns
        if self.is_floor_begun:
            # A grid with a credit of one, so that a message that begins late makes no later one too many.
            period_ns = int(NS_PER_S / floor_hz)
            self.floor_due_ns = max(self.floor_due_ns, now_ns - period_ns) + period_ns
        return message

    def queue_latched_again(self, under_way: Collection[OutgoingMessage]) -> None:
        """Have all latched messages go once more, in their order; who has them knows their numbers."""
        latched = frozenset(self.latched or ())
        for message in latched.difference(self.queue, under_way, [self.begun]):
            # It arrived or gave way, and what became of it is known.
            message.origin = None
        if self.begun in latched:
            self.begun, self.is_floor_begun = None, False
        self.queue = deque([*(one for one in self.queue if one not in latched), *(self.latched or ())])
        self.queued_bytes = sum(len(one.payload) for one in self.queue)
        for message in latched:
            message.offset = 0

    def put_queued(self, message: OutgoingMessage, *, is_first: bool = False) -> None:
        """Have a message wait that none replaces, behind all others of its kind or before them."""
        if is_first:
            self.queue.appendleft(message)
        else:
            self.queue.append(message)
        self.queued_bytes += len(message.payload)

    def take_queued(self) -> OutgoingMessage:
        message = self.queue.popleft()
        self.queued_bytes -= len(message.payload)
        return message

    def put_slot(self, message: OutgoingMessage) -> None:
        """Have a message wait that newer ones of its lane may replace."""
        self.slots[message.number] = message
        self.lanes.setdefault(message.lane, deque()).append(message.number)
        self.slots_bytes += len(message.payload)

    def take_slot(self, number: int) -> OutgoingMessage:
        message = self.slots.pop(number)
        lane = self.lanes[message.lane]
        lane.remove(number)
        if not lane:
            del self.lanes[message.lane]
        self.slots_bytes -= len(message.payload)
        return message

    def counts(self, now_ns: int) -> StreamCounts:
        return StreamCounts(
            sent=self.sent,
            replaced=self.replaced,
            overflowed=self.overflowed,
            queued_bytes=self.queued_bytes + self.slots_bytes,
            is_losing=self.overflowed_ns is not None and now_ns - self.overflowed_ns < LOSING_NS,
            repaired=self.repaired,
            lost_replaced=self.lost_replaced,
            lost_late=self.lost_late,
            sent_bytes=self.sent_bytes,
            repair_bytes=self.repair_bytes,
        )

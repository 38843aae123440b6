# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The ring: the last messages of every topic that rules record, and the incidents cut from them."""

from __future__ import annotations

import mmap
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain

from smarttestudo.domain.incident import Missing, MissingReason
from smarttestudo.domain.timing import SteadyTime
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.incidents.latched import Gone, LatchedSamples, holds_static_frames, nobody
from smarttestudo.incidents.missing import (
    add_loss,
    add_unsubscribed,
    missing_for_memory,
    unsubscribed,
    without,
)
from smarttestudo.incidents.sink import Incident, IncidentSink, Past, Store
from smarttestudo.incidents.topic_ring import BlockPool, GivenUp, InOrder, SourceMessage, TopicRing
from smarttestudo.language.rule_set import RecordRequest, RuleSet
from smarttestudo.loop.step import Trigger, written

MAX_OPEN_INCIDENTS = 100
MAX_WINDOWS = 10
"""To how many windows an incident is extended at most."""
FLICKER_NS = NS_PER_S // 2
"""How long after a beginning the next one extends its incident, though the window was shorter."""
_UNCOUNTED = 1 / 20
"""What part of the memory is for what is not counted: ends of blocks, copies while an incident is written."""
_MOST_TO_WRITE_BYTES = 1_000_000
"""Measured: what writing the first incident takes for good. Of a small memory, as much as is not counted."""
_LEAST_BLOCK_BYTES = 16_384
_FREE_BLOCKS = 16
_BLOCKS = 8192
"""How many blocks all memory is, where it is large: a system allows a process some ten thousand of them."""


@dataclass(slots=True, kw_only=True, eq=False)
class _Window:
    """Window of an incident until the steady time ``end_ns``, which beginnings extend as far as ``limit_ns``.

    ``recording`` is that of the rules in force, ``None`` where they have it no more. Its block began to hold
    last at ``begun_ns``, on the clock at ``begun_stamp_ns``. ``topics``, latched ones too, are kept.
    ``missing`` was known at a beginning, ``lost`` has since been lost, by topic.
    """

    incident: Incident
    recording: RecordRequest | None
    topics: frozenset[str]
    begun_ns: int
    begun_stamp_ns: int
    end_ns: int
    to_ns: int
    limit_ns: int
    missing: list[Missing] = field(default_factory=list)
    lost: dict[str, list[Missing]] = field(default_factory=dict)

    @property
    def over_ns(self) -> int:
        """The last time at which a beginning extends it: messages since its end are still in the rings."""
        return max(self.end_ns, self.begun_ns + min(self.incident.recording.before_ns, FLICKER_NS))

    def is_extended_by(self, recording: RecordRequest, now_ns: int) -> bool:
        """Whether a beginning now is a further moment of its incident."""
        return self.recording is recording and now_ns + recording.after_ns <= self.limit_ns

    def all_missing(self) -> tuple[Missing, ...]:
        return (*self.missing, *chain.from_iterable(self.lost.values()))


class IncidentRecorder:
    """Keeps messages in memory, at most ``memory_bytes`` of them, and cuts incidents out of them.

    Each topic is kept for as long as some recording of it asks for. When memory is short, the topic that
    takes the most gives up its oldest message, so that small topics stay whole; what a window lacks of it
    is counted, for which 24 bytes of each message are kept. What is given up goes to ``store``, if there is
    one. Latched messages that count are never given up. A message of the window is in the incident once.

    A block that begins to hold while the window of its incident is open, or within half a second of the
    last beginning, extends that, to at most ``MAX_WINDOWS`` windows. A later one begins another incident.

    A clock that jumps back counts as one that stood still, so that a window keeps its length; a jump ahead is
    to be left out of ``time``. ``refused`` counts incidents not begun, as ``MAX_OPEN_INCIDENTS`` were open,
    ``further_moments`` beginnings that extended one.
    """

    def __init__(
        self,
        rule_set: RuleSet,
        sink: IncidentSink,
        memory_bytes: int,
        start_ns: int,
        *,
        rules_sha256: str = "",
        store: Store | None = None,
    ) -> None:
        self._sink = sink
        self._store = store
        uncounted_bytes = int(memory_bytes * _UNCOUNTED)
        self._memory_bytes = memory_bytes - uncounted_bytes - min(uncounted_bytes, _MOST_TO_WRITE_BYTES)
        self._pool = BlockPool(_block_bytes(memory_bytes), _FREE_BLOCKS)
        self.time = SteadyTime(start_ns)
        self._start_ns = self.time.now_ns
        self._number = 0
        self._rings: dict[str, TopicRing] = {}
        self._latched: dict[str, LatchedSamples] = {}
        self._lapsed: set[str] = set()
        self._named: frozenset[str] = frozenset()
        self._ring_bytes = 0
        self._latched_bytes: dict[str, int] = {}
        self._open: Sequence[_Window] = ()
        self.open_topics: frozenset[str] = frozenset()
        """The topics that windows keep which are open, whatever the rules ask for by now."""
        self.refused = 0
        self.further_moments = 0
        self.change_rules(rule_set, rules_sha256)

    @property
    def held_bytes(self) -> int:
        """Bytes in memory for all messages."""
        return self._ring_bytes + sum(self._latched_bytes.values())

    @property
    def held_messages(self) -> int:
        """How many messages are kept, except for latched ones."""
        return sum(len(ring) for ring in self._rings.values())

    @property
    def topics(self) -> int:
        """How many topics are kept, latched ones included."""
        return len(self._rings.keys() | self._latched.keys())

    @property
    def open_incidents(self) -> int:
        """How many windows are open."""
        return len(self._open)

    @property
    def next_number(self) -> int:
        """Number of the message that comes next."""
        return self._number + 1

    @property
    def next_wake_ns(self) -> int | None:
        """When, on the clock, the next window is over."""
        if not self._open:
            return None
        return self.time.on_clock(min(window.over_ns for window in self._open) + 1)

    def change_rules(self, rule_set: RuleSet, rules_sha256: str = "") -> None:
        """Keep what these rules ask for; windows that are open stay so."""
        self._rules_sha256 = rules_sha256
        for window in self._open:
            if window.recording is not None:
                window.recording = _recording_now(window.incident, rule_set)
        horizons: dict[str, int] = {}
        for block in rule_set.blocks:
            for recording in block.recordings:
                for topic in recording.topics:
                    horizons[topic] = max(horizons.get(topic, 0), recording.before_ns)
        self._longest_ns = max(horizons.values(), default=0)
        known, self._rings = self._rings, {}
        for topic, horizon_ns in horizons.items():
            ring = known[topic] if topic in known else TopicRing(topic, horizon_ns, self._pool)
            self._rings[topic] = ring
            kept_ns = self.time.now_ns - ring.horizon_ns
            if horizon_ns > ring.horizon_ns and ring.since is not None and ring.since[0] < kept_ns:
                # Nobody asked for what arrived before that, so it is gone.
                ring.since = (kept_ns, self.time.on_clock(kept_ns))
            ring.horizon_ns = horizon_ns
        self._ring_bytes = sum(ring.held_bytes for ring in self._rings.values())
        self._named = frozenset((*rule_set.relayed, *rule_set.topics_read, *rule_set.recorded))
        for topic in [topic for topic in self._latched if not self._may_be_latched(topic)]:
            # Nobody may be subscribed to it any more.
            del self._latched[topic]
            self._latched_bytes.pop(topic, None)
            self._lapsed.add(topic)

    def keeps(self, topic: str) -> bool:
        """Whether messages of ``topic`` are to be taken."""
        return topic in self._rings or topic in self._latched or topic in self.open_topics

    def on_subscribed(self, topic: str, now_ns: int, *, transient_local: bool, gone: Gone = nobody) -> None:
        """Take messages of ``topic`` as they come, if kept; what ``gone`` ones latched counts no more."""
        self.time.advance(now_ns)
        if (ring := self._rings.get(topic)) is not None and ring.since is None:
            ring.since = (self.time.now_ns, now_ns)
        # Also while nothing is recorded: what is latched does not come again with rules that record.
        if topic not in self._latched and (transient_local or holds_static_frames(topic)):
            self._add_latched(topic)
        if (samples := self._latched.get(topic)) is not None:
            samples.end(gone(samples.publishers), self.time.now_ns)
            self._forget_replaced(topic, samples)

    def on_message(self, topic: str, stamp_ns: int, payload: bytes, publisher: Hashable = None) -> None:
        """Take a message of a topic that is kept, which arrived at ``stamp_ns`` on the clock."""
        self.advance(stamp_ns)
        now_ns = self.time.now_ns
        self._number += 1
        message = SourceMessage(self._number, topic, stamp_ns, payload)
        samples = self._latched.get(topic)
        if samples is not None:
            samples.add(message, publisher, now_ns)
            self._forget_replaced(topic, samples)
        ring = self._rings.get(topic)
        if ring is not None:
            before = ring.held_bytes
            ring.add(message, now_ns)
            ring.forget_before(now_ns - ring.horizon_ns)
            self._ring_bytes += ring.held_bytes - before
        if self.held_bytes > self._memory_bytes:
            self._make_room(now_ns)
        if self._open:
            is_latched = samples is not None
            keeping = [
                window.incident
                for window in self._open
                if now_ns <= window.end_ns and (is_latched or topic in window.topics)
            ]
            if keeping:
                self._sink.write(message, keeping)

    def lose(self, topic: str, messages: int, since_ns: int, now_ns: int) -> None:
        """Note messages of a topic that were lost before they arrived, between two stamps of the clock."""
        self.advance(now_ns)
        lost = Missing(
            topic=topic, reason=MissingReason.LOST, messages=messages, from_ns=since_ns, to_ns=now_ns
        )
        ring = self._rings.get(topic)
        if ring is not None:
            ring.lose(lost, self.time.now_ns)
        for window in self._open:
            if topic in window.topics and self.time.now_ns <= window.end_ns:
                add_loss(window.lost.setdefault(topic, []), lost)

    def begin(self, trigger: Trigger) -> None:
        """Open or extend the windows of a block that begins to hold; what it read was taken before."""
        self.advance(trigger.stamp_ns)
        now_ns = self.time.now_ns
        for recording in trigger.block.recordings:
            known = next((window for window in self._open if window.is_extended_by(recording, now_ns)), None)
            if known is not None:
                self._extend(known, trigger, recording)
            elif len(self._open) >= MAX_OPEN_INCIDENTS:
                self.refused += 1
            else:
                self._begin(trigger, recording)

    def advance(self, now_ns: int) -> None:
        """Time passed: close the windows that are over."""
        steady_ns = self.time.advance(now_ns)
        if self._open and any(window.over_ns < steady_ns for window in self._open):
            over = [window for window in self._open if window.over_ns < steady_ns]
            self._note_open([window for window in self._open if window.over_ns >= steady_ns])
            for window in over:
                self._sink.end(window.incident, window.all_missing())

    def finish(self, now_ns: int) -> None:
        """No more messages come: close all windows."""
        self.advance(now_ns)
        for window in self._open:
            ended = (
                Missing(
                    topic=topic, reason=MissingReason.ENDED, messages=None, from_ns=now_ns, to_ns=window.to_ns
                )
                for topic in sorted(set(window.incident.recording.topics))
            )
            self._sink.end(
                window.incident, (*window.all_missing(), *(ended if window.end_ns > self.time.now_ns else ()))
            )
        self._note_open(())

    def _note_open(self, windows: Sequence[_Window]) -> None:
        self._open = windows
        self.open_topics = frozenset().union(*(window.topics for window in windows))

    def _may_be_latched(self, topic: str) -> bool:
        return topic in self._named or holds_static_frames(topic)

    def _forget_replaced(self, topic: str, samples: LatchedSamples) -> None:
        samples.forget_before(self.time.now_ns - self._longest_ns)
        self._latched_bytes[topic] = samples.held_bytes

    def _add_latched(self, topic: str) -> None:
        if self._may_be_latched(topic):
            self._latched[topic] = samples = LatchedSamples(topic)
            if topic in self._lapsed:
                self._lapsed.remove(topic)
                samples.complete_since_ns = self.time.now_ns

    def _begin(self, trigger: Trigger, recording: RecordRequest) -> None:
        now_ns = self.time.now_ns
        from_ns = now_ns - recording.before_ns
        incident = Incident(
            trigger=trigger,
            recording=recording,
            from_ns=trigger.stamp_ns - recording.before_ns,
            to_ns=trigger.stamp_ns + recording.after_ns,
            rules_sha256=self._rules_sha256,
        )
        window = _Window(
            incident=incident,
            recording=recording,
            topics=frozenset((*recording.topics, *self._latched)),
            begun_ns=now_ns,
            begun_stamp_ns=trigger.stamp_ns,
            end_ns=now_ns + recording.after_ns,
            to_ns=incident.to_ns,
            limit_ns=from_ns + MAX_WINDOWS * (recording.before_ns + recording.after_ns),
        )
        window.missing += self._unsubscribed(recording, from_ns, incident.from_ns, trigger.stamp_ns)
        for topic, samples in self._latched.items():
            complete_ns = samples.complete_since_ns
            if topic not in self._rings and complete_ns is not None and complete_ns > from_ns:
                window.missing.append(unsubscribed(topic, incident.from_ns, self.time.on_clock(complete_ns)))
        past = self._past(window, from_ns, counting=True)
        latched = sorted(
            sample for samples in self._latched.values() for sample in samples.counting_at(from_ns)
        )
        self._sink.begin(incident, replace(past, latched=latched))
        self._note_open((*self._open, window))

    def _extend(self, window: _Window, trigger: Trigger, recording: RecordRequest) -> None:
        now_ns = self.time.now_ns
        self.further_moments += 1
        for missing in self._unsubscribed(
            recording, window.begun_ns, window.begun_stamp_ns, trigger.stamp_ns
        ):
            add_unsubscribed(window.missing, missing)
        past = Past()
        if window.end_ns < now_ns:
            past = self._past(window, window.end_ns + 1, counting=False)
        window.begun_ns, window.begun_stamp_ns = now_ns, trigger.stamp_ns
        window.end_ns = now_ns + recording.after_ns
        # A clock that was set back makes no window shorter.
        window.to_ns = max(window.to_ns, trigger.stamp_ns + recording.after_ns)
        self._sink.extend(window.incident, trigger, window.to_ns, past)

    def _past(self, window: _Window, from_ns: int, *, counting: bool) -> Past:
        """Messages from ``from_ns`` on until a beginning of ``window``, which notes what it lacks of those.

        That may be latched messages, too, which were ``counting`` at ``from_ns``.
        """
        rings = {
            topic: self._rings[topic] for topic in window.incident.recording.topics if topic in self._rings
        }
        held = {topic: ring.held_since(from_ns) for topic, ring in rings.items()}
        # Latched ones of the window that no ring holds.
        inside = sorted(
            sample
            for topic, samples in self._latched.items()
            for sample in samples.since(from_ns)
            if topic not in held or not held[topic].holds(sample.number)
        )
        gone = {topic: ring.given_up_since(from_ns) for topic, ring in rings.items()}
        given_up = self._given_up(gone, inside, from_ns, counting=counting)
        window.missing += missing_for_memory(given_up)
        for topic, ring in rings.items():
            for lost in ring.lost_since(from_ns):
                add_loss(window.lost.setdefault(topic, []), lost)
        return Past(from_ns=from_ns, messages=InOrder((*held.values(), inside)), given_up=given_up)

    def _unsubscribed(
        self, recording: RecordRequest, from_ns: int, from_stamp_ns: int, to_stamp_ns: int
    ) -> Iterator[Missing]:
        """Parts of the time before a beginning, from a steady time on, without a subscription to a topic."""
        for topic in recording.topics:
            ring = self._rings.get(topic)
            if ring is None:
                continue
            if ring.since is not None:
                if ring.since[0] > from_ns:
                    yield unsubscribed(topic, from_stamp_ns, ring.since[1])
            elif self.time.now_ns == self._start_ns:
                yield unsubscribed(topic, from_stamp_ns, to_stamp_ns)
            else:
                yield unsubscribed(topic, from_stamp_ns, to_stamp_ns, MissingReason.UNPUBLISHED)

    def _given_up(
        self,
        gone: Mapping[str, Sequence[GivenUp]],
        inside: Sequence[SourceMessage],
        from_ns: int,
        *,
        counting: bool,
    ) -> dict[str, Sequence[GivenUp]]:
        """Messages of a window that memory gave up, by topic: ``gone`` from the rings less ``inside``."""
        found = {topic: without(each, topic, inside) for topic, each in gone.items()}
        for topic, samples in self._latched.items():
            # A ring knows what arrived in the window.
            lacking = [
                sample
                for sample in samples.given_up_of(from_ns)
                if (counting if sample.at_ns < from_ns else topic not in gone)
            ]
            if lacking:
                found[topic] = (*lacking, *found.get(topic, ()))
        return found

    def _make_room(self, now_ns: int) -> None:
        for ring in self._rings.values():
            ring.forget_before(now_ns - ring.horizon_ns)
        self._ring_bytes = sum(ring.held_bytes for ring in self._rings.values())
        while self.held_bytes > self._memory_bytes:
            largest = max(self._rings.values(), key=lambda ring: len(ring) and ring.held_bytes, default=None)
            topic = max(self._latched, key=lambda topic: self._latched[topic].replaced_bytes, default="")
            if topic and self._latched[topic].replaced_bytes > (largest.held_bytes if largest else 0):
                self._give_up_latched(topic, now_ns)
            elif largest:
                before = largest.held_bytes
                at_ns, message = largest.give_up_oldest()
                if self._store is not None:
                    self._store(message, at_ns + largest.horizon_ns, now_ns)
                self._ring_bytes += largest.held_bytes - before
            else:
                break

    def _give_up_latched(self, topic: str, now_ns: int) -> None:
        samples = self._latched[topic]
        replaced_ns, message = samples.give_up_oldest()
        self._latched_bytes[topic] = samples.held_bytes
        # What is in a ring goes to the store from there.
        if self._store is not None and topic not in self._rings:
            self._store(message, replaced_ns + self._longest_ns, now_ns)


def _recording_now(incident: Incident, rule_set: RuleSet) -> RecordRequest | None:
    """The recording of an incident in other rules, if its rule is written there as it was."""
    former, form = replace(incident.recording, line=0), written(incident.trigger.block)
    recordings = (
        recording for block in rule_set.blocks if written(block) == form for recording in block.recordings
    )
    return next((recording for recording in recordings if replace(recording, line=0) == former), None)


def _block_bytes(memory_bytes: int) -> int:
    """Whole pages: of others, the system takes the rest, too."""
    pages = -(-max(_LEAST_BLOCK_BYTES, memory_bytes // _BLOCKS) // mmap.PAGESIZE)
    return pages * mmap.PAGESIZE

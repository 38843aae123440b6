# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop over a recording, in virtual time: what the operator would have received."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.type_definitions import rules_for
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.decision import AnyDecision, Decision, about_rates
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import TOPIC_PLACEHOLDER
from smarttestudo.domain.observation import SourceChanged, Undecodable
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import (
    TWO_TYPES,
    Channel,
    RecordingReader,
    RecordingWriter,
    Storage,
    robots_own,
)
from smarttestudo.domain.status import ThinningDoubt
from smarttestudo.domain.units import LAST_STAMP_NS, NS_PER_S, counted
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.decision_log import decision_text
from smarttestudo.loop.inputs import GraphInput, LoopInput, MessageInput, WakeInput
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.loop.statistics import RelayStatistics
from smarttestudo.pacing.cdr import string_message
from smarttestudo.pacing.sample import WhenSlow, is_patch
from smarttestudo.replays.incidents import IncidentCutter, IncidentRequest, incident_cutter
from smarttestudo.replays.outcome import ReplayOutcome, topic_outcome
from smarttestudo.replays.topics import (
    ReplayTopics,
    absent_topics,
    decisions_channel,
    earlier_topics,
    replay_topics,
    require_decodable,
)

_REPORTS = 200
_REDEFINED_INCIDENT = "incidents hold messages of its first definition only; left out of them"


def _ignore(_: object) -> None:
    """Do nothing."""


_WHY_UNKNOWN = "NaN, said to be unknown, or no such field"
_WHY_UNREAD = "a long double, which ROS 2 lacks in Python"


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayRequest:
    """An opened recording, the rules, and the folder of the new recording, if there is to be one.

    Of topics in ``predict``, receivers show dead reckoning. ``output_topic`` names output topics, with
    ``{topic}`` for the source's full name. ``decided`` is given decisions about topics in order, some at a
    time, ``logged`` all decisions, ``report`` the share of the recording that is done, 0 … 1. Where there is
    a ``writer``, it takes what is relayed, and no recording is made; ``arrived`` is shown every message,
    ``stepped`` the time and the loop whenever that may have changed. ``incidents`` asks for what the rules
    record. Messages of topics in ``left_out`` are not relayed: nothing must depend on them. The replay ends
    at ``until_ns``, if that is before the recording does, and ``ended`` is shown that time and the loop. A
    new recording also has the decisions, on the topic of a live run; those that the recording may have are
    left out.
    """

    recording: RecordingReader
    rule_set: RuleSet
    output: Path | None
    profile: Profile = field(default_factory=Profile)
    when_slow: WhenSlow = WhenSlow.PASS
    storage: Storage = Storage.SQLITE3
    output_topic: str = TOPIC_PLACEHOLDER
    budget_kb_per_s: float | None = None
    predict: Collection[str] = ()
    decided: Callable[[Sequence[Decision]], None] = _ignore
    logged: Callable[[Sequence[AnyDecision]], None] = _ignore
    report: Callable[[float], None] = _ignore
    writer: RecordingWriter | None = None
    arrived: Callable[[Channel, int, bytes], None] | None = None
    stepped: Callable[[int, RelayLoop], None] | None = None
    incidents: IncidentRequest | None = None
    left_out: Collection[str] = ()
    until_ns: int = LAST_STAMP_NS
    ended: Callable[[int, RelayLoop], None] | None = None

    @property
    def is_recorded(self) -> bool:
        """Whether there is to be a new recording."""
        return self.writer is None and self.output is not None


def replay(request: ReplayRequest) -> ReplayOutcome:
    """Run the loop over the recording and write what it relays.

    Raises:
        RecordingError: a check reads a topic of unknown type; the output exists or cannot be written.
        UsageError: ``output_topic`` gives no valid names.
    """
    (outcome,) = replay_together([request])
    return outcome


def replay_together(requests: Sequence[ReplayRequest]) -> list[ReplayOutcome]:
    """Replay each of the requests, which have one recording, in one pass over it.

    Raises:
        RecordingError, UsageError: as ``replay``.
    """
    started_s = time.perf_counter()
    recording = requests[0].recording
    decoder = RosbagDecoder()
    with ExitStack() as opened:
        runs = [_Run.of(_by_what_is_recorded(request), decoder, opened) for request in requests]
        for run in runs:
            run.begin()
        _pass_messages(recording, runs, decoder)
        for run in runs:
            run.end()
    wall_seconds = time.perf_counter() - started_s
    return [run.outcome(wall_seconds) for run in runs]


def _by_what_is_recorded(request: ReplayRequest) -> ReplayRequest:
    """``request`` with its rules as they are where the topics of the recording are there."""
    rule_set = rules_for(request.rule_set, request.recording.channels, request.output_topic)
    return replace(request, rule_set=rule_set)


def _pass_messages(recording: RecordingReader, runs: Sequence[_Run], decoder: RosbagDecoder) -> None:
    """Show every message to all runs; what several of them need decoded is decoded once."""
    decoded = frozenset[str]().union(*(run.decoded for run in runs))
    takes = [run.on_message for run in runs]
    until_ns = max(run.until_ns for run in runs)
    for channel, stamp_ns, payload in recording.messages():
        if stamp_ns > until_ns:
            break
        message = _decoded(decoder, channel, payload) if channel.topic in decoded else None
        for take in takes:
            take(channel, stamp_ns, payload, message)


def _decoded(decoder: RosbagDecoder, channel: Channel, payload: bytes) -> object:
    try:
        return decoder.decode(channel, payload)
    except RecordingError:
        return Undecodable()


def _output(
    request: ReplayRequest, declared_bytes: Mapping[str, int]
) -> AbstractContextManager[RecordingWriter]:
    if not request.is_recorded or request.output is None:
        return nullcontext(request.writer or _Nowhere())
    return create_recording(
        request.output,
        storage=request.storage,
        declared_bytes=declared_bytes,
        custom_data=request.recording.custom_data,
    )


class _Nowhere:
    """A writer that keeps nothing."""

    def add(self, _channel: Channel) -> None:
        """Nothing is written."""

    def write(self, _channel: Channel, _stamp_ns: int, _payload: bytes) -> None:
        """Nothing is written."""


class _Run:
    """Drives the loop of one request with the messages of the recording and the time between them."""

    @classmethod
    def of(cls, request: ReplayRequest, decoder: RosbagDecoder, opened: ExitStack) -> _Run:
        """The run for ``request``, whose output lasts as long as ``opened``."""
        recording, rule_set = request.recording, request.rule_set
        channels = robots_own(recording.channels)
        require_decodable(channels, rule_set, decoder)
        topics = replay_topics(channels, rule_set, decoder, request.output_topic)
        declared_bytes = {
            topics.outputs[topic].topic: size
            for topic, size in recording.declared_bytes.items()
            if topic in topics.outputs
        }
        loop = RelayLoop(
            rule_set,
            request.profile,
            recording.start_ns,
            request.when_slow,
            request.budget_kb_per_s,
            reckoned=request.predict,
        )
        writer = opened.enter_context(_output(request, declared_bytes))
        cutter = opened.enter_context(
            incident_cutter(request.incidents, rule_set, topics.sources, recording.start_ns)
        )
        for channel in topics.outputs.values():
            writer.add(channel)
        return cls(request, loop, writer, topics, decoder, cutter=cutter)

    def __init__(
        self,
        request: ReplayRequest,
        loop: RelayLoop,
        writer: RecordingWriter,
        topics: ReplayTopics,
        decoder: RosbagDecoder,
        *,
        cutter: IncidentCutter | None,
    ) -> None:
        self.decoded: frozenset[str] = frozenset()
        """The topics whose messages must come decoded, once the run began."""
        self._decisions = 0
        self._untold: list[AnyDecision] = []
        self._decisions_channel = decisions_channel() if request.is_recorded else None
        self.until_ns = request.until_ns
        self._request = request
        self._loop = loop
        self._writer = writer
        self._topics = topics
        self._decoder = decoder
        self._needed: Mapping[str, Channel] = {}
        self._declared_bytes = request.recording.declared_bytes
        self._report_ns = 0
        self._left_out: Counter[tuple[str, str]] = Counter()
        self._cutter = cutter
        if cutter is not None:
            cutter.begin(loop.triggers)

    def begin(self) -> None:
        """Say which sources there are."""
        sources = tuple(
            SourceChanged(
                topic=topic,
                publishers=1,
                transient_local=channel.transient_local,
                type_name=channel.type_name,
                is_standard=topic not in self._topics.redefined,
            )
            for topic, channel in self._topics.sources.items()
        )
        start_ns = self._request.recording.start_ns
        self._write(self._handled(GraphInput(stamp_ns=start_ns, sources=sources)))
        self._needed = self._sources_needed()
        self.decoded = frozenset(topic for topic in self._needed if self._loop.needs_decoded(topic))

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes, message: object) -> None:
        """Take a message of the recording, decoded where that is needed."""
        topic, request, loop = channel.topic, self._request, self._loop
        if request.arrived is not None:
            request.arrived(channel, stamp_ns, payload)
        if self._cutter is not None:
            self._cut(self._cutter, channel, stamp_ns, payload)
        source = self._needed.get(topic)
        if source is None or source.type_name != channel.type_name:
            self._left_out[topic, TWO_TYPES] += source is not None
            return
        if stamp_ns >= self._report_ns:
            self._report_ns = stamp_ns + self._report(stamp_ns)
        wake_ns = loop.next_wake_ns
        if wake_ns is not None and wake_ns < stamp_ns:
            self._wake_before(stamp_ns)
        declared_bytes = self._declared_bytes
        size_bytes = declared_bytes[topic] if topic in declared_bytes else len(payload)
        redefined = None if source is channel else channel
        relayed = self._handled(MessageInput(stamp_ns, topic, payload, size_bytes, message, None, redefined))
        if relayed:
            self._write(relayed)
        if request.stepped is not None:
            request.stepped(stamp_ns, loop)

    def _handled(self, given: LoopInput) -> Sequence[Relayed]:
        """Relayed messages of an input, whose incidents have begun."""
        relayed = self._loop.handle(given)
        if self._cutter is not None and self._loop.triggers:
            self._cutter.begin(self._loop.triggers)
        if self._decisions_channel is not None:
            self._record_decisions(self._decisions_channel)
        return relayed

    def _record_decisions(self, channel: Channel) -> None:
        """Write what was decided, before any message that passes because of it."""
        for decision in self._loop.take_all_decisions():
            self._untold.append(decision)
            self._writer.write(channel, decision.stamp_ns, string_message(decision_text(decision)))

    def _cut(self, cutter: IncidentCutter, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Let incidents have the message, if it means what they say of the topic."""
        source = self._topics.sources.get(channel.topic)
        if source is None:
            return
        if source is channel:
            self._wake_before(stamp_ns)
            cutter.on_message(channel, stamp_ns, payload)
        elif source.type_name == channel.type_name and cutter.keeps(channel.topic):
            self._left_out[channel.topic, _REDEFINED_INCIDENT] += 1

    def end(self) -> None:
        """The recording ended: let go what was held back, each at its time."""
        end_ns = min(self._request.recording.end_ns, self.until_ns)
        self._wake_before(end_ns + 1)
        if self._request.ended is not None:
            self._request.ended(end_ns, self._loop)
        self._write(self._loop.finish(end_ns))
        if self._cutter is not None:
            self._cutter.finish(end_ns)
        self._report(end_ns)

    def outcome(self, wall_seconds: float) -> ReplayOutcome:
        """Result of the run."""
        recording, topics = self._request.recording, self._topics
        return ReplayOutcome(
            topics={
                topic: topic_outcome(
                    statistics,
                    output_topic=topics.output_topics[topic],
                    declared=topic in recording.declared_bytes,
                )
                for topic, statistics in self._loop.relays.statistics.items()
            },
            decisions=self._decisions,
            notices=(
                *absent_topics(self._request.rule_set, {one.topic for one in recording.channels}),
                *earlier_topics(
                    recording.channels, self._request.rule_set, is_written=self._request.is_recorded
                ),
                *recording.notices(),
                *self._notices(),
            ),
            duration_s=(recording.end_ns - recording.start_ns) / NS_PER_S,
            wall_seconds=wall_seconds,
            incidents=() if self._cutter is None else tuple(path.name for path in self._cutter.written),
        )

    def _doubts(self, topic: str, statistics: RelayStatistics) -> Iterator[str]:
        """Why ``topic`` is not shown as its rate says."""
        video, source, arrived = (
            statistics.video,
            self._topics.sources.get(topic),
            statistics.arrived.messages,
        )
        left_out = arrived - (statistics.relayed.messages - statistics.repeated)
        of_all, doubt = f"of {counted(arrived, 'message')}", ThinningDoubt.NO_KEY_FRAME
        if video is not None and not video.keys and not math.isinf(statistics.target.rate_hz):
            yield f"{topic}: {doubt.value}: {doubt.details}"
        elif video is not None and left_out:
            groups = counted(video.keys, "group")
            yield f"{topic}: coded video: beginnings of its {groups} pass, without {left_out} {of_all}"
        elif source is not None and is_patch(source.type_name) and left_out:
            doubt = ThinningDoubt.PATCHES
            yield f"{topic}: {left_out} {of_all}: {doubt.value}: {doubt.details}"

    def _notices(self) -> Iterator[str]:
        """Losses and oddities, one line each."""
        if self._cutter is not None:
            yield from self._cutter.notices()
        if self._loop.knowledge.floors_broke_budget:
            yield "the floors alone took more than the budget at times; floors win"
        for (topic, why), count in (+self._left_out).items():
            yield f"{topic}: {why}: {counted(count, 'message')}"
        for topic, count in self._loop.knowledge.undecodable.items():
            why = f"what checks read was unknown{self._decoder.reason(topic)}"
            yield f"{topic}: {counted(count, 'message')} could not be decoded; {why}"
        for signal, count in self._loop.knowledge.unknown_values.items():
            why = _WHY_UNREAD if signal in self._topics.unread else _WHY_UNKNOWN
            yield f"{signal}: unknown in {counted(count, 'message')} ({why})"
        for topic, statistics in self._loop.relays.statistics.items():
            yield from self._doubts(topic, statistics)
            if statistics.unreadable:
                unread = counted(statistics.unreadable, "message")
                why = "could not be compared with the receiver's picture, without a value"
                yield f"{topic}: {unread} {why}, and count for no bound of it"
        for topic, count in self._loop.relays.discarded.items():
            if count:
                yield f"{topic}: {counted(count, 'message')} met none of the topic it is paced with"

    def _sources_needed(self) -> dict[str, Channel]:
        """The sources that are relayed or that checks read; the loop need not know of the others."""
        rule_set = self._request.rule_set
        needed = {*rule_set.relayed, *rule_set.topics_read}
        needed.difference_update(self._request.left_out)
        return {topic: channel for topic, channel in self._topics.sources.items() if topic in needed}

    def _wake_before(self, stamp_ns: int) -> None:
        """Let the loop do, each at its time, what it has to do before ``stamp_ns``."""
        while (wake_ns := self._loop.next_wake_ns) is not None and wake_ns < stamp_ns:
            self._write(self._handled(WakeInput(stamp_ns=wake_ns)))
            if self._request.stepped is not None:
                self._request.stepped(wake_ns, self._loop)

    def _write(self, relayed: Iterable[Relayed]) -> None:
        for topic, stamp_ns, payload, *_, redefined in relayed:
            output = self._topics.outputs[topic]
            if redefined is not None:
                output = replace(redefined, topic=output.topic)
            # What was held back goes out after the last message, where there may be no time left.
            self._writer.write(output, min(stamp_ns, LAST_STAMP_NS), payload[:])

    def _report(self, stamp_ns: int) -> int:
        """Hand on decisions and progress; how many ns of the recording to go until the next time."""
        decisions, self._untold = [*self._untold, *self._loop.take_all_decisions()], []
        if decisions:
            self._decisions += len(decisions)
            self._request.decided(about_rates(decisions))
            self._request.logged(decisions)
        recording = self._request.recording
        duration_ns = max(recording.end_ns - recording.start_ns, 1)
        self._request.report((stamp_ns - recording.start_ns) / duration_ns)
        return duration_ns // _REPORTS

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rules would have done to a bag."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.adapters.rosbag import RosbagDecoder, open_recording
from smarttestudo.adirf.checks import CheckContext, check_rules
from smarttestudo.adirf.document import read_document
from smarttestudo.adirf.rule_set import RuleSet, compile_rules
from smarttestudo.composition.optimize_tiers import tier_rates_for
from smarttestudo.composition.replay import ReplayRequest, replay
from smarttestudo.composition.replay_outcome import ReplayOutcome
from smarttestudo.composition.ruler.checked_text import CheckedText, Draft, RefusedTextError
from smarttestudo.composition.ruler.replay_watch import ArrivalWatch, CountingWriter
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import RecordingReader
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.visualizer.page import PathPoint
from smarttestudo.visualizer.trace import TraceAccumulator

MAX_BINS = 300
MAX_DECISIONS = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicTrial:
    """One topic before and after; the bins are messages per second, ``bin_s`` seconds each."""

    topic: str
    before_kb: float
    after_kb: float
    before_messages: int
    after_messages: int
    target_hz: float | None
    before_hz_bins: tuple[float, ...]
    after_hz_bins: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A bag under rules. ``decisions`` are the first 2000, of ``decision_count`` in all."""

    duration_s: float
    bin_s: float
    topics: tuple[TopicTrial, ...]
    decisions: tuple[Decision, ...]
    decision_count: int
    path: tuple[PathPoint, ...]
    notices: tuple[str, ...]

    @property
    def before_kb(self) -> float:
        """What the relayed topics carried in the bag."""
        return sum(topic.before_kb for topic in self.topics)

    @property
    def after_kb(self) -> float:
        """What of it the rules would have sent."""
        return sum(topic.after_kb for topic in self.topics)

    @property
    def saved_percent(self) -> float:
        """How much less that is; 0 where nothing was carried."""
        return 100 * (1 - self.after_kb / self.before_kb) if self.before_kb else 0.0


def try_rules(draft: Draft, bag: Path, report: Callable[[float], None]) -> Trial:
    """Replay ``bag`` under ``draft``; nothing is written. ``report`` is told the share done.

    Raises:
        RefusedTextError: the rules have errors.
        RecordingError: the bag cannot be read.
    """
    decisions: list[Decision] = []
    with open_recording(bag) as recording:
        watch = ArrivalWatch(recording, RosbagDecoder())
        writer = CountingWriter(recording.declared_bytes)
        outcome = replay(
            ReplayRequest(
                recording=recording,
                rule_set=_compiled(draft, recording),
                output=Path(),
                profile=draft.profile() or Profile(),
                decided=lambda some: decisions.extend(some[: MAX_DECISIONS - len(decisions)]),
                report=report,
                writer=writer,
                arrived=watch.arrived,
            )
        )
        bins = _bins(recording.start_ns, recording.end_ns)
        return _trial(watch, writer, outcome, tuple(decisions), bins)


def _compiled(draft: Draft, recording: RecordingReader) -> RuleSet:
    profile = draft.profile()
    bag_topics = {channel.topic: channel.type_name for channel in recording.channels}
    document = read_document(draft.text, draft.name)
    findings = check_rules([document.result], CheckContext(profile=profile, bag_topics=bag_topics))
    checked = CheckedText(document=document, findings=tuple(findings))
    if checked.has_errors:
        raise RefusedTextError(checked)
    files = [document.result.file]
    return compile_rules(files, resolve_topic, tier_rates_for(files, profile, resolve_topic))


def _trial(
    watch: ArrivalWatch,
    writer: CountingWriter,
    outcome: ReplayOutcome,
    decisions: tuple[Decision, ...],
    bins: _Bins,
) -> Trial:
    return Trial(
        duration_s=outcome.duration_s,
        bin_s=float(bins.width_s),
        topics=tuple(
            _topic(topic, watch.traces, writer.traces, target_hz=one.target_hz, bins=bins)
            for topic, one in outcome.topics.items()
            if topic in watch.traces
        ),
        decisions=decisions,
        decision_count=outcome.decisions,
        path=tuple(watch.path),
        notices=outcome.notices,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bins:
    """Stretches of ``width_s`` whole seconds of the epoch."""

    first_s: int
    seconds: int
    width_s: int

    def rates_hz(self, trace: TraceAccumulator) -> tuple[float, ...]:
        counts = [0] * -(-self.seconds // self.width_s)
        for bin_ in trace.bins():
            at = (bin_.second - self.first_s) // self.width_s
            # What is held back to the end is relayed after it.
            counts[min(at, len(counts) - 1)] += bin_.messages
        return tuple(count / self.width_s for count in counts)


def _bins(start_ns: int, end_ns: int) -> _Bins:
    first_s = start_ns // NS_PER_S
    seconds = end_ns // NS_PER_S - first_s + 1
    return _Bins(first_s=first_s, seconds=seconds, width_s=max(-(-seconds // MAX_BINS), 1))


def _topic(
    topic: str,
    before: Mapping[str, TraceAccumulator],
    after: Mapping[str, TraceAccumulator],
    *,
    target_hz: float | None,
    bins: _Bins,
) -> TopicTrial:
    arrived, relayed = before[topic], after.get(topic, TraceAccumulator())
    return TopicTrial(
        topic=topic,
        before_kb=arrived.size_bytes / BYTES_PER_KB,
        after_kb=relayed.size_bytes / BYTES_PER_KB,
        before_messages=arrived.messages,
        after_messages=relayed.messages,
        target_hz=target_hz,
        before_hz_bins=bins.rates_hz(arrived),
        after_hz_bins=bins.rates_hz(relayed),
    )

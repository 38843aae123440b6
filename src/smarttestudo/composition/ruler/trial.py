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
from smarttestudo.composition.ruler.replay_watch import (
    MAX_TURNS,
    ArrivalWatch,
    BlockTurns,
    CountingWriter,
    TruthWatch,
)
from smarttestudo.composition.ruler.trial_loss import LossWatch, TrialLoss
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import RecordingReader
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.visualizer.floor import PathPoint
from smarttestudo.visualizer.loss.course import Stretches
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
    """A bag under rules. ``decisions`` are the first 2000, of ``decision_count`` in all.

    The bins are ``bin_s`` long; the first begins at ``first_bin_s``, which is 0 or less.
    """

    duration_s: float
    bin_s: float
    first_bin_s: float
    topics: tuple[TopicTrial, ...]
    decisions: tuple[Decision, ...]
    decision_count: int
    path: tuple[PathPoint, ...]
    blocks: tuple[BlockTurns, ...]
    loss: TrialLoss
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
        rule_set, profile = _compiled(draft, recording), draft.profile() or Profile()
        loss = LossWatch(recording, rule_set, profile)
        watches = _Watches(
            arrivals=ArrivalWatch(recording, RosbagDecoder(), loss),
            writer=CountingWriter(recording.declared_bytes, loss),
            truths=TruthWatch(rule_set, recording.start_ns),
            loss=loss,
        )
        outcome = replay(
            ReplayRequest(
                recording=recording,
                rule_set=rule_set,
                output=Path(),
                profile=profile,
                decided=lambda some: decisions.extend(some[: MAX_DECISIONS - len(decisions)]),
                report=report,
                writer=watches.writer,
                arrived=watches.arrivals.arrived,
                stepped=watches.truths.stepped,
            )
        )
        bins = _bins(recording.start_ns, recording.end_ns)
        return _trial(watches, outcome, tuple(decisions), bins)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Watches:
    """Who looks on while the bag is replayed."""

    arrivals: ArrivalWatch
    writer: CountingWriter
    truths: TruthWatch
    loss: LossWatch


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


def _trial(watches: _Watches, outcome: ReplayOutcome, decisions: tuple[Decision, ...], bins: _Bins) -> Trial:
    traces = watches.arrivals.traces
    loss = watches.loss.loss(bins.stretches)
    cut = (f"rules turned more than {MAX_TURNS:,} times; which of them hold is known of the first",)
    notices = (*outcome.notices, *loss.notices, *(cut if watches.truths.is_cut else ()))
    return Trial(
        duration_s=outcome.duration_s,
        bin_s=float(bins.width_s),
        first_bin_s=bins.offset_s,
        topics=tuple(
            _topic(topic, traces, watches.writer.traces, target_hz=one.target_hz, bins=bins)
            for topic, one in outcome.topics.items()
            if topic in traces
        ),
        decisions=decisions,
        decision_count=outcome.decisions,
        path=tuple(watches.arrivals.path),
        blocks=watches.truths.blocks,
        loss=loss,
        notices=tuple(dict.fromkeys(notices)),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bins:
    """Stretches of ``width_s`` whole seconds of the epoch, for a recording that starts at ``start_ns``."""

    start_ns: int
    seconds: int
    width_s: int

    @property
    def first_s(self) -> int:
        """The second of the epoch in which the first one begins."""
        return self.start_ns // NS_PER_S

    @property
    def offset_s(self) -> float:
        """When the first one begins, counted from the recording's start."""
        return (self.first_s * NS_PER_S - self.start_ns) / NS_PER_S

    @property
    def count(self) -> int:
        """How many there are."""
        return -(-self.seconds // self.width_s)

    @property
    def stretches(self) -> Stretches:
        """The same in ns."""
        return Stretches(first_ns=self.first_s * NS_PER_S, width_ns=self.width_s * NS_PER_S, count=self.count)

    def rates_hz(self, trace: TraceAccumulator) -> tuple[float, ...]:
        """The rate in each; what is held back to the end is relayed after it, and counts in the last."""
        counts = [0] * self.count
        for bin_ in trace.bins():
            at = (bin_.second - self.first_s) // self.width_s
            counts[min(at, len(counts) - 1)] += bin_.messages
        return tuple(count / self.width_s for count in counts)


def _bins(start_ns: int, end_ns: int) -> _Bins:
    seconds = end_ns // NS_PER_S - start_ns // NS_PER_S + 1
    return _Bins(start_ns=start_ns, seconds=seconds, width_s=max(-(-seconds // MAX_BINS), 1))


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

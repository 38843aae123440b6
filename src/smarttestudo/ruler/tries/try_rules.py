# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Try of rules on a bag."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo.accuracy.reconstruction import TimeBins
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.statistics import TraceAccumulator
from smarttestudo.bags.type_definitions import recorded_types
from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.domain.decision import Decision, Reason, bound_texts
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import RecordingReader, robots_own
from smarttestudo.domain.units import NS_PER_S, counted, grouped
from smarttestudo.editing import read_document
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.replays.incidents import IncidentRequest
from smarttestudo.replays.outcome import ReplayOutcome, TopicOutcome
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.recordings import READING
from smarttestudo.ruler.job import Report, job
from smarttestudo.ruler.rules.document import CheckedText, Draft, RefusedTextError, require_usable
from smarttestudo.ruler.tries.loss import (
    LossWatch,
    TriedRecording,
    TryHeadline,
    TryLoss,
    worst_field,
    worst_topic,
)
from smarttestudo.ruler.tries.watches import (
    ArrivalWatch,
    BlockTurns,
    CountingWriter,
    IncidentTally,
    TruthWatch,
    TryIncident,
)
from smarttestudo.rules.rule_sets import RuleSource, known_types, sha256_of_rules

MAX_BINS = 300
# A name outside the project, and rules with errors.
_REFUSED = (403, 409)


@dataclass(frozen=True, slots=True, kw_only=True)
class TryLimits:
    """How much of a long bag is kept: decisions, turns, messages that the loss counts, and incidents."""

    decisions: int = 2000
    turns: int = 5000
    samples: int = 5_000_000
    incidents: int = 200


class TryRequest(Draft, frozen=True, kw_only=True):
    """Rules and a bag; ``run`` names the try in ``Progress`` messages of ``/ws``."""

    bag: str
    run: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class TryTopic:
    """One relayed topic of the bag; ``*_hz_bins`` are messages a second before and after, bin by bin."""

    topic: str
    outcome: TopicOutcome
    before_hz_bins: tuple[float, ...]
    after_hz_bins: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TryDecision:
    """Another rate of a topic, or another deciding block, ``t`` seconds after the bag's start.

    ``from_hz`` and ``to_hz`` are null for Full; the first decision of a topic (``start``) has no ``from_hz``.
    ``line`` and ``rule`` are the deciding block's, null where none decided. ``bounds`` say which bound of
    each property holds then, what decided it, and whether that is in doubt.
    """

    t: float
    topic: str
    start: bool
    from_hz: float | None
    to_hz: float | None
    reason: Reason
    rule: str | None
    line: int | None
    bounds: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TryAnswer(TryHeadline):
    """Result of a try of rules on a bag.

    Times are seconds since the bag's start. ``…_bins`` have one value for each ``bin_s`` seconds; the first
    begins at ``first_bin_s``, 0 or less. ``decisions`` are the first 2000 of ``decision_count``; ``path`` is
    ``[seconds, x, y]`` in metres where the bag has odometry. ``incidents`` are the first 200 that the rules
    would have recorded, null where no rule records anything.
    """

    bin_s: float
    first_bin_s: float
    decisions: tuple[TryDecision, ...]
    decision_count: int
    topics: tuple[TryTopic, ...]
    path: tuple[tuple[float, float, float], ...]
    blocks: tuple[BlockTurns, ...]
    loss: TryLoss
    incidents: tuple[TryIncident, ...] | None


def try_rules(
    draft: Draft, bag: Path, report: Callable[[float], None], limits: TryLimits | None = None
) -> TryAnswer:
    """Replay ``bag`` under ``draft``; nothing is written. ``report`` gets the share done.

    Raises:
        RefusedTextError: the rules have errors.
        RecordingError: the bag cannot be read.
    """
    limits = limits or TryLimits()
    decisions: list[Decision] = []
    with open_recording(bag) as recording:
        rule_set, profile = compiled_for(draft, recording), draft.profile() or Profile()
        loss = LossWatch(recording, rule_set, profile, max_samples=limits.samples)
        watches = _Watches(
            arrivals=ArrivalWatch(recording, RosbagDecoder(), loss),
            writer=CountingWriter(recording.declared_bytes, loss),
            truths=TruthWatch(rule_set, recording.start_ns, max_turns=limits.turns),
            loss=loss,
            incidents=IncidentTally(limits.incidents) if rule_set.recorded else None,
        )
        outcome = replay(
            ReplayRequest(
                recording=recording,
                rule_set=rule_set,
                output=Path(),
                profile=profile,
                decided=lambda some: decisions.extend(some[: limits.decisions - len(decisions)]),
                report=report,
                writer=watches.writer,
                arrived=watches.arrivals.arrived,
                stepped=watches.truths.stepped,
                incidents=watches.incident_request(draft),
            )
        )
        bins = _bins(recording.start_ns, recording.end_ns)
        cuts = _cuts(watches, outcome, decisions, limits)
        return _answer(watches, outcome, tuple(decisions), bins, cuts)


@job("POST /api/try", reads=True, limit=READING)
def try_on(request: TryRequest, folder: ProjectFolder, report: Report) -> TryAnswer:
    """Replay a bag of the project under rules; errors as of ``try_rules``."""
    require_usable(request)
    tried = try_rules(request, folder.bag(request.bag), report)
    return replace(tried, notices=tuple(map(folder.shown, tried.notices)))


def _not_tried(error: TestudoError) -> TriedRecording:
    """Why a recording cannot be tried, which costs no other of its folder; a refusal is an error."""
    if getattr(error, "status", None) in _REFUSED:
        raise error
    return TriedRecording(headline=None, problem=error.cause, remedy=error.remedy or "")


# A folder is tried one recording after the other.
@job("POST /api/try/headline", reads=True, limit=READING, repeats=True, failed=_not_tried)
def headline(request: TryRequest, folder: ProjectFolder, report: Report) -> TriedRecording:
    """The headline of ``try_on``."""
    return TriedRecording(headline=try_on(request, folder, report).headline())


@dataclass(frozen=True, slots=True, kw_only=True)
class _Watches:
    """Watches of one replay."""

    arrivals: ArrivalWatch
    writer: CountingWriter
    truths: TruthWatch
    loss: LossWatch
    incidents: IncidentTally | None

    def incident_request(self, draft: Draft) -> IncidentRequest | None:
        """Request to the replay for incidents, if a rule records any."""
        if self.incidents is None:
            return None
        return IncidentRequest(into=self.incidents.opened, rules_sha256=sha256_of_rules(draft.text))


def compiled_for(draft: Draft, recording: RecordingReader) -> RuleSet:
    """The rules of ``draft`` for the topics of ``recording``; ``RefusedTextError`` if they have errors."""
    profile = draft.profile()
    found = recorded_types(robots_own(recording.channels))
    types = known_types(found, profile)
    document = read_document(draft.text, draft.name)
    findings = check_rules(
        [document.result], CheckContext(profile=profile, bag_topics=found.topics, types=types)
    )
    checked = CheckedText(document=document, findings=tuple(findings))
    if checked.has_errors:
        raise RefusedTextError(checked)
    return RuleSource(files=(document.result.file,), profile=profile).compiled(types)


def _answer(
    watches: _Watches,
    outcome: ReplayOutcome,
    decisions: tuple[Decision, ...],
    bins: _Bins,
    cuts: Iterable[str],
) -> TryAnswer:
    traces, tally = watches.arrivals.traces, watches.incidents
    loss = watches.loss.loss(bins.bins)
    notices = (*outcome.notices, *watches.loss.notices(), *cuts)
    topics = tuple(
        TryTopic(
            topic=topic,
            outcome=one,
            before_hz_bins=bins.rates_hz(traces[topic]),
            after_hz_bins=bins.rates_hz(watches.writer.traces.get(topic, TraceAccumulator())),
        )
        for topic, one in outcome.topics.items()
        if topic in traces
    )
    before_kb = sum(one.outcome.in_kb for one in topics)
    after_kb = sum(one.outcome.out_kb for one in topics)
    return TryAnswer(
        duration_s=outcome.duration_s,
        bin_s=float(bins.width_s),
        first_bin_s=bins.offset_s,
        before_kb=before_kb,
        after_kb=after_kb,
        percent=100 * (1 - after_kb / before_kb) if before_kb else 0.0,
        worst_topic=worst_topic(loss),
        worst_field=worst_field(loss),
        crossings=sum(one.crossings for one in loss.crossings),
        missed_crossings=sum(one.received.missed for one in loss.crossings),
        decisions=tuple(map(_decision, decisions)),
        decision_count=outcome.decisions,
        topics=topics,
        path=tuple((point.t_s, point.x_m, point.y_m) for point in watches.arrivals.path),
        blocks=watches.truths.blocks,
        loss=loss,
        incidents=None if tally is None else tally.incidents(bins.start_ns),
        notices=tuple(dict.fromkeys(notices)),
    )


def _decision(one: Decision) -> TryDecision:
    return TryDecision(
        t=round(one.t_s, 6),
        topic=one.topic,
        start=one.from_rate is None,
        from_hz=None if one.from_rate is None else one.from_rate.to_json(),
        to_hz=one.planned.rate.to_json(),
        reason=one.planned.reason,
        rule=one.planned.rule,
        line=one.planned.line,
        bounds=bound_texts(one.planned.within, one.planned.bound_reasons),
    )


def _cuts(
    watches: _Watches, outcome: ReplayOutcome, decisions: Sequence[Decision], limits: TryLimits
) -> Iterator[str]:
    truths, incidents = watches.truths, watches.incidents
    if outcome.decisions > len(decisions):
        yield (
            f"only the first {grouped(len(decisions))} decisions are shown; "
            f"those after {grouped(decisions[-1].t_s, 1)} s are left out"
        )
    if truths.cut_s is not None:
        after = f"their states after {grouped(truths.cut_s, 1)} s are left out"
        yield f"rules changed their state more than {grouped(limits.turns)} times; {after}"
    if incidents is not None and incidents.count > limits.incidents:
        all_of_them = counted(incidents.count, "incident")
        yield f"only the first {grouped(limits.incidents)} of {all_of_them} are shown"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bins:
    """TimeBins of ``width_s`` whole seconds of the epoch, for a recording that starts at ``start_ns``."""

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
    def bins(self) -> TimeBins:
        """The same in ns."""
        return TimeBins(first_ns=self.first_s * NS_PER_S, width_ns=self.width_s * NS_PER_S, count=self.count)

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

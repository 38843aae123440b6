# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A replay as one page: both recordings side by side, and every decision."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from smarttestudo import __version__
from smarttestudo.adapters.rosbag import open_recording
from smarttestudo.domain.decision import Decision
from smarttestudo.visualizer.page import Fact, PageInput, RuleText, render_page
from smarttestudo.visualizer.run_pair import compare_runs, paired_series
from smarttestudo.visualizer.statistics import RecordingSpan, TopicStatistics, topic_statistics
from smarttestudo.visualizer.trace import TraceAccumulator

_MESSAGES_PER_REPORT = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportRequest:
    """Both recordings, the monitored name of each relayed source, and what was decided by which rules."""

    bag: Path
    output: Path
    monitored: Mapping[str, str]
    decisions: Sequence[Decision]
    rule_texts: Mapping[str, str]
    report: Callable[[float], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Measured:
    """A recording's topics, by the source's name."""

    span: RecordingSpan
    traces: Mapping[str, TraceAccumulator]
    declared: frozenset[str]

    def statistics(self, span: RecordingSpan) -> dict[str, TopicStatistics]:
        return {
            topic: topic_statistics(trace, span, declared=topic in self.declared)
            for topic, trace in self.traces.items()
        }


def replay_report(request: ReportRequest) -> str:
    """The page as HTML, of the relayed topics. Reads both recordings once more.

    Raises:
        RecordingError: one of them cannot be read.
    """
    sources = {topic: topic for topic in request.monitored}
    before = _measure(request.bag, sources, request.report)
    after = _measure(request.output, {name: topic for topic, name in request.monitored.items()}, _ignore)
    return render_page(
        PageInput(
            title=f"Replay of {request.bag.resolve().name}",
            duration_s=before.span.duration_s,
            comparison=compare_runs(
                before.statistics(before.span),
                after.statistics(before.span),
                request.decisions,
                end_s=before.span.duration_s,
            ),
            series=paired_series(before.traces, after.traces, before.span),
            decisions=tuple(request.decisions),
            rules=tuple(RuleText(path=path, text=text) for path, text in request.rule_texts.items()),
            provenance=(
                Fact(label="SmartTestudo", value=__version__),
                Fact(label="Recording", value=str(request.bag)),
                Fact(label="Monitored recording", value=str(request.output)),
            ),
        )
    )


def _measure(path: Path, source_of: Mapping[str, str], report: Callable[[float], None]) -> _Measured:
    """Count the messages of the recording at ``path`` whose topic's source ``source_of`` names."""
    with open_recording(path) as recording:
        span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
        declared_bytes = recording.declared_bytes
        names = [channel.topic for channel in recording.channels if channel.topic in source_of]
        traces = {name: TraceAccumulator() for name in names}
        duration_ns = max(span.end_ns - span.start_ns, 1)
        for count, (channel, stamp_ns, payload) in enumerate(recording.messages()):
            trace = traces.get(channel.topic)
            if trace is not None:
                trace.add(stamp_ns, declared_bytes.get(channel.topic, len(payload)))
            if count % _MESSAGES_PER_REPORT == 0:
                report((stamp_ns - span.start_ns) / duration_ns)
    return _Measured(
        span=span,
        traces={source_of[name]: trace for name, trace in traces.items()},
        declared=frozenset(source_of[name] for name in names if name in declared_bytes),
    )


def _ignore(_: float) -> None:
    """The monitored recording is read in no time."""

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The tables and figures of the thesis's evaluation, of a demo's run, and the names of their files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.statistics import RecordingSpan, TraceAccumulator, topic_statistics
from smarttestudo.domain.recording import Channel
from smarttestudo.files.whole_file import whole_file
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.report.comparison_tables import RunNames, bandwidth_as_in_thesis, frequency_as_in_thesis
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.table import Table, csv_table, markdown_table
from smarttestudo.simulation.messages import RobotTopic

FREQUENCY_TABLE = "table-7.1-frequency"
BANDWIDTH_TABLE = "table-7.2-bandwidth"
ZONES_FIGURE = "zones.png"
_FIGURE_NAMES = RunNames(before="Without adaptive monitoring", after="With it")


def figure_names() -> Mapping[str, str]:
    """The file of each figure: of a topic's rate by the topic, of the zones by an empty name.

    The static frames are no topic of the thesis.
    """
    topics = (topic.value for topic in RobotTopic if topic is not RobotTopic.TF_STATIC)
    of_topics = {topic: f"frequency{topic.replace('/', '-')}.png" for topic in topics}
    return {**of_topics, "": ZONES_FIGURE}


def file_names() -> frozenset[str]:
    """All that a demo may write into the folder."""
    tables = (f"{name}.{form}" for name in (FREQUENCY_TABLE, BANDWIDTH_TABLE) for form in ("md", "csv"))
    return frozenset({*tables, *figure_names().values()})


def thesis_writer(when_slow: WhenSlow) -> Callable[[RunReport, Path, Path, RuleSet], None]:
    """A function that writes Tables 7.1 and 7.2, the rate of each topic over time, and the map of zones.

    It takes the report of a run with ``when_slow``, the new folder to write into, and what was recorded under
    which rules. It raises ``OutputFileError`` where a file cannot be written. A missing package is known now,
    before the drive begins.
    """
    from smarttestudo.report.figures.draw import draw_topics  # noqa: PLC0415  matplotlib takes a second

    def write(report: RunReport, folder: Path, baseline: Path, rule_set: RuleSet) -> None:
        folder.mkdir()
        other_hz = _frequencies_otherwise(baseline, rule_set, when_slow)
        tables = {
            FREQUENCY_TABLE: frequency_as_in_thesis(report.comparison, when_slow, other_hz),
            BANDWIDTH_TABLE: bandwidth_as_in_thesis(report.comparison),
        }
        for name, table in tables.items():
            _write(table, folder, name)
        draw_topics(replace(report, names=_FIGURE_NAMES), folder, figure_names())

    return write


class _Counts:
    """The writer of a recording of which only the counts are kept, by topic."""

    def __init__(self) -> None:
        self.by_topic: dict[str, TraceAccumulator] = {}

    def add(self, channel: Channel) -> None:
        self.by_topic.setdefault(channel.topic, TraceAccumulator())

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        self.add(channel)
        self.by_topic[channel.topic].add(stamp_ns, len(payload))


def _frequencies_otherwise(baseline: Path, rule_set: RuleSet, when_slow: WhenSlow) -> Mapping[str, float]:
    """Frequencies in Hz, by topic, with the other way for targets above their sources."""
    other = WhenSlow.PASS if when_slow is WhenSlow.REPEAT else WhenSlow.REPEAT
    counts = _Counts()
    with open_recording(baseline) as recording:
        replay(
            ReplayRequest(
                recording=recording, rule_set=rule_set, output=baseline, when_slow=other, writer=counts
            )
        )
        span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
    return {topic: topic_statistics(trace, span).binned_hz for topic, trace in counts.by_topic.items()}


def _write(table: Table[Any], folder: Path, name: str) -> None:
    for form, text in (("md", markdown_table(table)), ("csv", csv_table(table))):
        with whole_file(folder / f"{name}.{form}", "the table") as write:
            write(text)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The frequency and the bandwidth table of a comparison, and the two as in the thesis (Riccardi 2025)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.report.table import Column, Table, change, decimals

if TYPE_CHECKING:
    from smarttestudo.bags.comparison import Comparison, TopicComparison
    from smarttestudo.bags.statistics import TopicStatistics

DECLARED = "declared"
_TOPIC: Column[TopicComparison] = Column("Topic", "", lambda pair: pair.topic, is_text=True)
_CHANGE: Column[TopicComparison] = Column("Change", "%", lambda pair: pair.change_percent, change)
_RATE_NOTE = "Hz: mean count of the 1 s bins from first to last message."
_TARGET_NOTE = (
    " Target: planned rate, weighted by time. Mean: (n − 1) / (last − first) of {}. "
    "Error: that mean against the target, or the source's mean where that is less."
)
_FRAMES_NOTE = " Of transforms and other named streams the target is that of each, and there is no error."
BANDWIDTH_NOTE = "1 KB is 1000 bytes; 1 KB/s is 8 kbit/s."
DECLARED_NOTE = "declared: the size that the recording declares for its messages, not the one it holds."


@dataclass(frozen=True, slots=True, kw_only=True)
class RunNames:
    """The names of the two runs of a comparison in headings."""

    before: str = "Source"
    after: str = "SmartTestudo"


def frequency_table(comparison: Comparison, names: RunNames | None = None) -> Table[TopicComparison]:
    """The rate of each topic in both runs, its change, and how near it came to its target if there is any."""
    names = names or RunNames()
    targets = [pair.target for pair in comparison.topics if pair.target is not None]
    note = _RATE_NOTE
    if targets:
        note += _TARGET_NOTE.format(names.after)
    if any(target.attainable_hz is None for target in targets):
        note += _FRAMES_NOTE
    return Table(
        title="Frequency",
        columns=tuple(_frequency_columns(names, has_targets=bool(targets))),
        rows=comparison.topics,
        footnotes=(note,),
    )


def _frequency_columns(names: RunNames, *, has_targets: bool) -> Iterator[Column[TopicComparison]]:
    yield _TOPIC
    yield Column(names.before, "Hz", lambda pair: _binned_hz(pair.before))
    yield Column(names.after, "Hz", lambda pair: _binned_hz(pair.after))
    yield _CHANGE
    if has_targets:
        yield Column("Target", "Hz", lambda pair: pair.target.planned_hz if pair.target else None)
        yield Column("Mean", "Hz", lambda pair: pair.after.mean_hz if pair.target and pair.after else None)
        yield Column("Error", "%", lambda pair: pair.error_percent, decimals(2, signed=True))


def bandwidth_table(comparison: Comparison, names: RunNames | None = None) -> Table[TopicComparison]:
    """The bandwidth of each topic in both runs with its change, and the sum; declared sizes are labelled."""
    declared = any(map(_is_declared, comparison.topics))
    return Table(
        title="Bandwidth",
        columns=tuple(_bandwidth_columns(comparison, names or RunNames(), declared=declared)),
        rows=comparison.topics,
        footnotes=(BANDWIDTH_NOTE, DECLARED_NOTE) if declared else (BANDWIDTH_NOTE,),
    )


def _bandwidth_columns(
    comparison: Comparison, names: RunNames, *, declared: bool
) -> Iterator[Column[TopicComparison]]:
    before, after = comparison.before_kb_per_s, comparison.after_kb_per_s
    changed = comparison.bandwidth_change_percent
    sizes = "mixed" if declared else "recorded"
    yield Column("Topic", "", lambda pair: pair.topic, is_text=True, sums=("All topics",))
    yield Column(names.before, "KB/s", lambda pair: _kb_per_s(pair.before), sums=(before,))
    yield Column(names.after, "KB/s", lambda pair: _kb_per_s(pair.after), sums=(after,))
    yield Column("Change", "%", lambda pair: pair.bandwidth_change_percent, change, sums=(changed,))
    yield Column("Sizes", "", _sizes, is_text=True, sums=(sizes,))


def _sizes(pair: TopicComparison) -> str:
    return DECLARED if _is_declared(pair) else "recorded"


def _is_declared(pair: TopicComparison) -> bool:
    return any(side is not None and side.declared for side in (pair.before, pair.after))


def _binned_hz(side: TopicStatistics | None) -> float | None:
    return None if side is None else side.binned_hz


def _kb_per_s(side: TopicStatistics | None) -> float | None:
    return None if side is None else side.kb_per_s


THESIS_CHANGE_PERCENT: Mapping[str, float] = MappingProxyType(
    {
        "/camera/camera_info": -89.5,
        "/camera/image_raw": -89.6,
        "/imu": -94.7,
        "/joint_states": -38.9,
        "/scan": 18.0,
        "/tf": -66.4,
    }
)
"""The changes of frequencies that the thesis reports, as far as they are known here."""

_KBIT_PER_KB = 8
_DEFAULT, _ADAPTIVE = "Default", "Adaptive"
_THESIS_RATE_NOTE = (
    "Frequency: mean count of the 1 s bins from the first to the last message, as in the thesis."
)
_THESIS_NOTE = "Thesis: the change that the thesis reports, where that is known here."
_OTHERWISE = {WhenSlow.REPEAT: "Passed once", WhenSlow.PASS: "Repeated"}
_WHEN_SLOW_NOTES = {
    WhenSlow.REPEAT: (
        "Where a target is above its source, the newest message is repeated, as in the thesis. "
        "Passed once: the change where it is not (--when-slow pass)."
    ),
    WhenSlow.PASS: (
        "No message is repeated. Repeated: the change where the newest is, wherever a target is above its "
        "source, as in the thesis (--when-slow repeat)."
    ),
}
_KBIT_NOTES = (
    "1 kbit is 1000 bits.",
    "The thesis counts by 1024 in places: its absolute numbers differ by that, its changes do not.",
)
_BANDWIDTH_AS_IN_THESIS: tuple[Column[TopicComparison], ...] = (
    _TOPIC,
    Column(_DEFAULT, "kbit/s", lambda pair: _kbit_per_s(pair.before)),
    Column(_ADAPTIVE, "kbit/s", lambda pair: _kbit_per_s(pair.after)),
    Column("Change", "%", lambda pair: pair.bandwidth_change_percent, change),
)


def frequency_as_in_thesis(
    comparison: Comparison, when_slow: WhenSlow, other_hz: Mapping[str, float]
) -> Table[TopicComparison]:
    """Table 7.1: the frequency of each topic that both runs have, and its change beside the thesis's.

    ``when_slow`` is what the run did where a target is above its source; ``other_hz`` has the frequencies
    where it does the other.
    """

    def otherwise(pair: TopicComparison) -> float | None:
        before_hz, after_hz = _binned_hz(pair.before), other_hz.get(pair.topic)
        return 100 * (after_hz / before_hz - 1) if before_hz and after_hz is not None else None

    return Table(
        title="Table 7.1: frequency of each topic",
        columns=(
            _TOPIC,
            Column(_DEFAULT, "Hz", lambda pair: _binned_hz(pair.before)),
            Column(_ADAPTIVE, "Hz", lambda pair: _binned_hz(pair.after)),
            _CHANGE,
            Column("Thesis", "%", lambda pair: THESIS_CHANGE_PERCENT.get(pair.topic), change),
            Column(_OTHERWISE[when_slow], "%", otherwise, change),
        ),
        rows=_in_both(comparison),
        footnotes=(_THESIS_RATE_NOTE, _THESIS_NOTE, _WHEN_SLOW_NOTES[when_slow]),
    )


def bandwidth_as_in_thesis(comparison: Comparison) -> Table[TopicComparison]:
    """Table 7.2: the bandwidth of each topic that both runs have, in kbit/s, and its change."""
    return Table(
        title="Table 7.2: bandwidth of each topic",
        columns=_BANDWIDTH_AS_IN_THESIS,
        rows=_in_both(comparison),
        footnotes=_KBIT_NOTES,
    )


def _in_both(comparison: Comparison) -> Sequence[TopicComparison]:
    return [pair for pair in comparison.topics if pair.before is not None and pair.after is not None]


def _kbit_per_s(side: TopicStatistics | None) -> float | None:
    kb_per_s = _kb_per_s(side)
    return None if kb_per_s is None else _KBIT_PER_KB * kb_per_s

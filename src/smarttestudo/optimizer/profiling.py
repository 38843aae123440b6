# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles from what was measured: sizes, rates, and the rates that accuracies need."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from smarttestudo.domain.profile import AccuracyTiers, LevelledProperty
from smarttestudo.domain.rate import MAX_RATE_HZ, MIN_SOURCE_HZ, RATE_STEP_HZ, SLOW_HZ
from smarttestudo.domain.rate_meter import Flow, Intervals
from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import BYTES_PER_KB, counted
from smarttestudo.language.properties import gauges_for, properties_for_bounds
from smarttestudo.optimizer.wording import kb_text
from smarttestudo.pacing.bound import HEARTBEAT_HZ
from smarttestudo.pacing.cdr import STREAM_TYPES, StreamReader
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.streams import MAX_STREAMS, messages_per_hz
from smarttestudo.pacing.topic_pacer import Accuracy, TopicPacer

PROPOSED_BOUNDS: Mapping[LevelledProperty, tuple[float, ...]] = MappingProxyType(
    {
        LevelledProperty.POSITION: (0.5, 0.2, 0.1, 0.05, 0.02, 0.01),
        LevelledProperty.ORIENTATION: (20.0, 10.0, 5.0, 3.0, 2.0, 1.0),
        LevelledProperty.POSITIONS: (0.2, 0.1, 0.05, 0.03, 0.02, 0.01),
    }
)
"""α0 … α5 in m, degrees and rad: a first guess that only an engineer can replace by a better one."""


def levelled_properties(type_name: str) -> tuple[LevelledProperty, ...]:
    """The levelled properties of messages of ``type_name``."""
    names = {spec.name for spec in properties_for_bounds().get(type_name, ())}
    return tuple(one for one in LevelledProperty if one.value in names)


def bounds_need_hz(passed: Sequence[int], messages: int, source_hz: float) -> tuple[float, ...]:
    """The share of a source of ``source_hz`` that bounds need, the widest first: ``passed`` of ``messages``.

    A wider bound than another one may need a message more by chance: it counts as the tighter one does.
    """
    counts = list(itertools.accumulate(reversed(passed), min))
    return tuple(source_hz * count / messages for count in reversed(counts))


class AccuracyMeasure:
    """How many messages of one topic pass at each accuracy: with hold, the heartbeat, and no ceiling.

    Memory does not depend on how many messages there are.
    """

    __slots__ = ("_gauged", "_reader", "messages")

    def __init__(self, type_name: str, known: Mapping[LevelledProperty, AccuracyTiers]) -> None:
        """``known`` are accuracies that the engineer chose; others are proposed."""
        self.messages = 0
        self._reader = StreamReader(type_name)
        self._gauged = [
            _Gauged(type_name, one, known[one].bounds if one in known else PROPOSED_BOUNDS[one])
            for one in levelled_properties(type_name)
        ]

    def record(self, stamp_ns: int, payload: bytes) -> None:
        """Pace a serialized message; stamps never fall, but for a clock that jumps back."""
        self.messages += 1
        frames = self._reader.streams(payload)
        for one in self._gauged:
            one.offer(payload, frames, stamp_ns)

    @property
    def unread(self) -> int:
        """How many messages could not be read: as on a robot, they passed at each accuracy."""
        return max((one.unread for one in self._gauged), default=0)

    def tiers(self, source_hz: float) -> dict[LevelledProperty, AccuracyTiers]:
        """The accuracies with what they need of a source of ``source_hz``."""
        return {
            one.levelled: AccuracyTiers(
                bounds=one.bounds, needs_hz=bounds_need_hz(one.passed, self.messages, source_hz)
            )
            for one in self._gauged
            if self.messages
        }


class _Gauged:
    """One property, with a pacer for each of its accuracies."""

    __slots__ = ("_pacers", "_picture", "bounds", "levelled", "passed", "unread")

    def __init__(self, type_name: str, levelled: LevelledProperty, bounds: tuple[float, ...]) -> None:
        self.levelled = levelled
        self.bounds = bounds
        self.passed = [0] * len(bounds)
        self.unread = 0
        gauges = gauges_for(type_name, [levelled.value])
        self._picture = Estimate(gauges, reckons=False)
        self._pacers = [TopicPacer(kind=_kind(type_name)) for _ in bounds]
        for pacer, bound in zip(self._pacers, bounds, strict=True):
            picture = Estimate(gauges, reckons=False)
            accuracy = Accuracy(
                estimate=picture, bounds={levelled.value: bound}, heartbeat_hz=HEARTBEAT_HZ, records={}
            )
            pacer.set_accuracy(accuracy, 0)
            pacer.set_rate(math.inf, 0)

    def offer(self, payload: bytes, frames: tuple[str, ...], now_ns: int) -> None:
        sample = Sample(payload, len(payload), frames=frames)
        sample.readings = self._picture.read(payload, None, now_ns)
        self.unread += None in sample.readings
        for number, pacer in enumerate(self._pacers):
            for _, passes in pacer.wake_until(now_ns):
                self.passed[number] += len(passes)
            self.passed[number] += len(pacer.offer(sample, now_ns))


def _kind(type_name: str) -> StreamKind:
    return StreamKind.of(type_name=type_name, transient_local=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class TierProposal:
    """τ0 … τ5 in Hz, and where they come from, as a comment in a profile says it."""

    tiers_hz: tuple[float, ...]
    origin: str


class TopicMeasure:
    """Sizes and intervals of one topic's messages, counted one by one in constant memory.

    ``is_declared`` says that the sizes are not those of the messages but what the recording declares.
    ``known`` are accuracies that the engineer chose, ``publishers`` how many the topic is known to have.
    ``lost_share`` is the share of its messages that was lost before it could be counted.
    """

    __slots__ = (
        "_accuracy",
        "_flow",
        "_intervals",
        "_streams",
        "is_declared",
        "largest_bytes",
        "lost_share",
        "publishers",
        "type_name",
    )

    def __init__(
        self,
        type_name: str,
        *,
        is_standard: bool = True,
        is_declared: bool = False,
        publishers: int = 1,
        known: Mapping[LevelledProperty, AccuracyTiers] = MappingProxyType({}),
    ) -> None:
        self.type_name = type_name
        is_gauged = is_standard and levelled_properties(type_name)
        self._accuracy = AccuracyMeasure(type_name, known) if is_gauged else None
        self.is_declared = is_declared
        self.publishers = publishers
        self.largest_bytes = 0
        self.lost_share = 0.0
        self._flow = Flow()
        self._intervals = Intervals()
        self._streams = StreamCount(type_name) if is_standard and type_name in STREAM_TYPES else None

    @property
    def needs_payload(self) -> bool:
        """Whether messages are to be recorded with their payload."""
        return self._accuracy is not None or self._streams is not None

    @property
    def streams(self) -> float:
        """How many messages pass at 1 Hz, as each stream that they name has that."""
        return 1.0 if self._streams is None else self._streams.streams

    def record(self, stamp_ns: int, size_bytes: int, payload: bytes | None = None) -> None:
        """Count a message; its accuracies and streams need the serialized message."""
        if self._streams is not None and payload is not None:
            self._streams.record(payload)
        if self._accuracy is not None and payload is not None:
            self._accuracy.record(stamp_ns, payload)
        self._flow.record(stamp_ns, size_bytes)
        self.largest_bytes = max(self.largest_bytes, size_bytes)
        self._intervals.record(stamp_ns)

    @property
    def messages(self) -> int:
        return self._flow.messages

    @property
    def message_kb(self) -> float | None:
        """The mean size in KB; ``None`` without messages."""
        return self._flow.size_bytes / self.messages / BYTES_PER_KB if self.messages else None

    @property
    def largest_kb(self) -> float:
        return self.largest_bytes / BYTES_PER_KB

    @property
    def kb(self) -> float:
        """All messages together, in KB."""
        return self._flow.size_bytes / BYTES_PER_KB

    @property
    def source_hz(self) -> float | None:
        """(n − 1) / (last − first), and what was lost; ``None`` where that is not defined."""
        came_hz = self._flow.mean_hz
        return None if came_hz is None else came_hz / (1 - self.lost_share)

    @property
    def accuracies(self) -> Mapping[LevelledProperty, AccuracyTiers]:
        """The accuracies of the levels, with the rates that they need; none where there is no rate."""
        source_hz = self.source_hz
        return {} if self._accuracy is None or source_hz is None else self._accuracy.tiers(source_hz)

    @property
    def unread(self) -> int:
        """How many messages could not be read for the accuracies, and count as needed by each."""
        return 0 if self._accuracy is None else self._accuracy.unread

    @property
    def jitter_s(self) -> float | None:
        """The standard deviation of the intervals in seconds; ``None`` below two intervals."""
        return self._intervals.jitter_s


class StreamCount:
    """How many streams the messages of a topic name, for each that one of them names."""

    __slots__ = ("_messages", "_named", "_names", "_reader")

    def __init__(self, type_name: str) -> None:
        self._reader = StreamReader(type_name)
        self._names: set[str] = set()
        self._messages = self._named = 0

    def record(self, payload: bytes) -> None:
        names = self._reader.streams(payload)
        if len(self._names) < MAX_STREAMS:
            self._names.update(names)
        self._messages += bool(names)
        self._named += len(names)

    @property
    def streams(self) -> float:
        """How many messages pass at 1 Hz."""
        return messages_per_hz(len(self._names), messages=self._messages, named=self._named)


TIER_SHARES = (0.05, 0.1, 0.25, 0.5, 0.8, 1.0)
"""τ0 … τ5 as shares of the source's rate: a first guess that only an engineer can replace by a better one."""

_TIERS_GUESSED = "# The levels are guesses from the rates; docs/quality-levels.md says how to choose them."
_TIERS_FROM_LOSS = (
    "# The levels come from the loss at each rate (docs/loss.md), those in % of source_hz "
    "from the rate alone."
)
_NEEDS_ORIGIN = f"with hold, a heartbeat of {HEARTBEAT_HZ:g} Hz and no ceiling, for movements as these"
_DIGITS = 3
_SMALL = 1e-3
_MS_PER_S = 1000.0


def proposed_tiers_hz(source_hz: float) -> tuple[float, ...]:
    """Six rising thresholds for a source of ``source_hz``, in three significant digits."""
    return tuple(rounded(share * source_hz) for share in TIER_SHARES)


def profile_text(
    measures: Mapping[str, TopicMeasure],
    *,
    duration_s: float,
    measured_in: str,
    proposals: Mapping[str, TierProposal] | None = None,
) -> str:
    """A profile in TOML of the topics measured in ``duration_s`` seconds.

    Topics in ``proposals`` get those tiers, the others shares of their rate.
    """
    proposals = proposals or {}
    # A comment in TOML is one line of what can be seen.
    measured_in = visible(measured_in)
    total_kb_per_s = sum(one.kb for one in measures.values()) / duration_s if duration_s > 0 else 0.0
    lines = [
        f"# Measured by testudo profile in {measured_in}: {duration_s:.1f} s, "
        f"{counted(len(measures), 'topic')}, {kb_text(total_kb_per_s)} KB/s in all.",
        _TIERS_FROM_LOSS if proposals else _TIERS_GUESSED,
        "# budget_kb_per_s = 1000.0  # what your link carries; the optimizer needs it",
    ]
    for topic, measure in measures.items():
        lines += ["", f"[topics.{json.dumps(topic)}]", *_entries(measure, proposals.get(topic), duration_s)]
    return "\n".join([*lines, ""])


def _entries(measure: TopicMeasure, proposal: TierProposal | None, duration_s: float) -> Iterator[str]:
    yield f"type = {json.dumps(measure.type_name)}"
    if measure.publishers > 1:
        yield f"# {measure.publishers} publishers, measured together; live, each of them has the topic's rate"
    if not measure.message_kb:
        yield "# no messages, or empty ones: no size, no rate"
        return
    plural = "message" if measure.messages == 1 else "messages"
    declared = ", declared by the recording" if measure.is_declared else ""
    yield (
        f"message_kb = {_number(measure.message_kb)}  # mean of {measure.messages} {plural}, "
        f"the largest {_number(measure.largest_kb)}{declared}"
    )
    if measure.source_hz is None:
        # Such a topic still comes: a robot says where its sensors are once.
        source_hz = rounded(min(measure.messages / duration_s, SLOW_HZ) if duration_s > 0 else SLOW_HZ)
        messages = counted(measure.messages, "message")
        yield f"source_hz = {_number(source_hz)}  # {messages} at one time: no levels, Full for optimize"
        return
    if measure.lost_share:
        lost = f"{100 * measure.lost_share:.0f} % of its messages"
        yield f"# {lost} were lost on their way here; the rate counts them"
    source_hz = rounded(measure.source_hz)
    if not MIN_SOURCE_HZ <= source_hz <= MAX_RATE_HZ:
        yield f"# no rate, no levels: {source_hz:g} Hz is none that a source has; did the clock jump?"
        return
    yield f"source_hz = {_number(source_hz)}  # {_intervals(measure)}"
    if measure.streams > 1:
        streams = rounded(measure.streams)
        yield f"streams = {_number(streams)}  # each has the topic's rate, as far as the source sends it"
        proposal = proposal or _by_shares(rounded(source_hz / streams))
    proposal = proposal or _by_shares(source_hz)
    if min(proposal.tiers_hz) < RATE_STEP_HZ:
        yield f"# too slow for levels: a rate has at least {RATE_STEP_HZ} Hz"
        return
    yield f"tiers_hz = {_numbers(proposal.tiers_hz)}  # {proposal.origin}"
    unread = f"; {counted(measure.unread, 'message')} could not be read and passed" if measure.unread else ""
    for one, tiers in measure.accuracies.items():
        yield f"{one.tiers_key} = {_numbers(tiers.bounds)}  # of {one.value}"
        if tiers.needs_hz is not None and tiers.needs_hz[0] >= RATE_STEP_HZ:
            needs_hz = [min(rounded(rate), source_hz) for rate in tiers.needs_hz]
            yield f"{one.needs_key} = {_numbers(needs_hz)}  # {_NEEDS_ORIGIN}{unread}"


def _by_shares(source_hz: float) -> TierProposal:
    shares = ", ".join(f"{100 * share:g}" for share in TIER_SHARES)
    return TierProposal(tiers_hz=proposed_tiers_hz(source_hz), origin=f"{shares} % of source_hz")


def _intervals(measure: TopicMeasure) -> str:
    mean_s = 1 / measure.source_hz if measure.source_hz else 0.0
    text = f"(n - 1) / (last - first); intervals of {_MS_PER_S * mean_s:.1f} ms"
    return (
        text
        if measure.jitter_s is None
        else f"{text}, jitter (standard deviation) {_MS_PER_S * measure.jitter_s:.1f} ms"
    )


def rounded(number: float) -> float:
    """``number`` in three significant digits."""
    return float(f"{number:.{_DIGITS}g}")


def _numbers(numbers: Iterable[float]) -> str:
    return f"[{', '.join(map(_number, numbers))}]"


def _number(number: float) -> str:
    return f"{round(number, 6) if number >= _SMALL else float(f'{number:.6g}')!r}"

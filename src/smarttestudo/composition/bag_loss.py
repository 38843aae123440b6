# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the operator lost between two recordings of one run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from smarttestudo.adapters.rosbag import open_recording
from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.composition.bag_measure import measure_bag
from smarttestudo.composition.recorded_samples import (
    RecordedSamples,
    TopicReading,
    read_samples,
    require_numbers,
)
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.bag_comparison import BagComparison, compare_bags
from smarttestudo.visualizer.bag_summary import BagSummary
from smarttestudo.visualizer.loss.crossings import thresholds_of
from smarttestudo.visualizer.loss.fields import Field, fields_of
from smarttestudo.visualizer.loss.fixed_rates import Source, best_fixed_rates
from smarttestudo.visualizer.loss.measure import (
    SharedTopic,
    crossing_losses,
    field_losses,
    image_losses,
    topic_loss,
)
from smarttestudo.visualizer.loss.report import Carried, LossReport
from smarttestudo.visualizer.loss.samples import TopicSamples
from smarttestudo.visualizer.topic_selection import select_topics

_ENDS_EARLY_S = 2.0


def _ignore(_: float) -> None:
    """Nobody wants to know."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LossQuestion:
    """What is asked of two recordings.

    ``mapping`` pairs topics as for ``compare_bags``. ``topics`` are names or patterns, empty for all;
    ``fields`` are more fields than the default ones, by topic of A. ``rule_set`` gives the thresholds,
    ``profile`` tiers and priorities for the third arm. ``report`` is told the share done, 0 … 1.
    """

    mapping: Mapping[str, str] = field(default_factory=dict)
    topics: Sequence[str] = ()
    fields: Mapping[str, Sequence[str]] = field(default_factory=dict)
    rule_set: RuleSet | None = None
    profile: Profile = field(default_factory=Profile)
    report: Callable[[float], None] = _ignore


def measure_loss(a: Path, b: Path, question: LossQuestion | None = None) -> LossReport:
    """The loss between ``a``, as sent, and ``b``, as received, in the time of ``a``.

    Each recording is read twice: once for its sizes, which costs little, once for its payloads.

    Raises:
        RecordingError: one cannot be read or is empty; they share no topic or no time; a field or topic that
            was asked for does not exist.
    """
    question = question or LossQuestion()
    sent, received = measure_bag(a, _ignore), measure_bag(b, _ignore)
    select_topics(tuple(question.mapping), sent.statistics, place=sent.name)
    select_topics(tuple(question.mapping.values()), received.statistics, place=received.name)
    compared = compare_bags(sent, received, question.mapping)
    _require_common_time(sent, received)
    return _Measurement(compared, question).report()


class _Measurement:
    """The reading of two recordings whose topics are paired."""

    def __init__(self, compared: BagComparison, question: LossQuestion) -> None:
        self._a, self._b = compared.a, compared.b
        self._question = question
        self._partners = {
            pair.topic: pair.after_topic
            for pair in compared.comparison.topics
            if pair.before and pair.before.messages and pair.after_topic
        }
        self._asked = self._topics_asked(compared)
        rule_set = question.rule_set
        self._thresholds = thresholds_of(rule_set) if rule_set else ()

    def report(self) -> LossReport:
        """Read both, and count what was lost."""
        sent = self._read(self._a, self._sent_readings(), share=(0.0, 0.7))
        require_numbers(sent.topics, self._question.fields)
        received = self._read(self._b, self._received_readings(sent.topics), share=(0.7, 1.0))
        topics = self._shared(sent.topics, received.topics)
        shown = [shared for shared in topics if shared.topic in self._asked]
        return LossReport(
            a=self._a.name,
            b=self._b.name,
            duration_s=self._a.span.duration_s,
            topics=tuple(topic_loss(shared) for shared in shown),
            fields=tuple(loss for shared in shown for loss in field_losses(shared)),
            crossings=tuple(loss for shared in shown for loss in crossing_losses(shared, self._thresholds)),
            images=tuple(loss for shared in shown for loss in image_losses(shared)),
            carried=Carried(
                sent_bytes=sum(shared.sent.size_bytes for shared in topics),
                received_bytes=sum(shared.received.size_bytes for shared in topics),
                fixed_bytes=sum(shared.fixed_bytes for shared in topics),
            ),
            notices=(*self._a.notices, *self._b.notices, *sent.notices, *received.notices, *self._notices()),
        )

    def _topics_asked(self, compared: BagComparison) -> frozenset[str]:
        shared = frozenset(self._partners)
        unpaired = set(self._question.fields).difference(shared)
        patterns = [*self._question.topics, *unpaired]
        if not patterns:
            return shared
        place = f"{compared.a.name}, {compared.b.name}"
        chosen = select_topics(patterns, {*shared, *filter(None, self._partners.values())}, place=place)
        return frozenset(topic for topic, partner in self._partners.items() if {topic, partner} & chosen)

    def _sent_readings(self) -> dict[str, TopicReading]:
        readings = {}
        for topic in self._partners:
            choose = partial(
                _choose_fields,
                asked=tuple(self._question.fields.get(topic, ())),
                needed=tuple(one.signal.property for one in self._thresholds if one.signal.topic == topic),
            )
            readings[topic] = self._reading(topic, choose if topic in self._asked else None)
        return readings

    def _received_readings(self, sent: Mapping[str, TopicSamples]) -> dict[str, TopicReading]:
        """Only fields that were found in A, and only of the same type, are read."""
        return {
            partner: self._reading(topic, partial(_same_fields, sent[topic]) if sent[topic].fields else None)
            for topic, partner in self._partners.items()
        }

    def _reading(
        self, topic: str, choose_fields: Callable[[str, object], Sequence[Field]] | None
    ) -> TopicReading:
        return TopicReading(
            choose_fields=choose_fields, level_unit=self._question.profile.topic(topic).level_unit
        )

    def _read(
        self, bag: BagSummary, readings: Mapping[str, TopicReading], share: tuple[float, float]
    ) -> RecordedSamples:
        def report(done: float) -> None:
            self._question.report(share[0] + (share[1] - share[0]) * done)

        span = self._a.span
        with open_recording(Path(bag.name)) as recording:
            return read_samples(
                recording, readings, start_ns=span.start_ns, end_ns=span.end_ns, report=report
            )

    def _shared(
        self, sent: Mapping[str, TopicSamples], received: Mapping[str, TopicSamples]
    ) -> list[SharedTopic]:
        sources = [
            Source(
                topic=topic,
                size_bytes=sent[topic].size_bytes,
                mean_hz=sent[topic].mean_hz,
                entry=self._question.profile.topic(topic),
            )
            for topic in self._partners
        ]
        budget_bytes = sum(samples.size_bytes for samples in received.values())
        rates_hz = best_fixed_rates(sources, budget_bytes)
        end_ns = self._a.span.end_ns
        return [
            SharedTopic(
                sent=sent[topic],
                received=received[partner],
                fixed=sent[topic].at_rate(rates_hz[topic], end_ns),
                fixed_hz=rates_hz[topic],
                end_ns=end_ns,
            )
            for topic, partner in self._partners.items()
        ]

    def _notices(self) -> Iterator[str]:
        early_s = (self._a.span.end_ns - self._b.span.end_ns) / NS_PER_S
        if early_s > _ENDS_EARLY_S:
            yield f"{self._b.name}: ends {early_s:.1f} s before {self._a.name}; nothing came in that time"
        for topic in sorted({one.signal.topic for one in self._thresholds}.difference(self._partners)):
            yield f"{topic}: a check reads it, which {self._b.name} lacks; its crossings are left out"


def _choose_fields(
    type_name: str, message: object, *, asked: Sequence[str], needed: Sequence[str]
) -> Sequence[Field]:
    return fields_of(type_name, message, asked=asked, needed=needed)


def _same_fields(sent: TopicSamples, type_name: str, _: object) -> Sequence[Field]:
    return sent.fields if type_name == sent.channel.type_name else ()


def _require_common_time(a: BagSummary, b: BagSummary) -> None:
    if b.span.end_ns < a.span.start_ns or a.span.end_ns < b.span.start_ns:
        raise RecordingError(
            f"it has no time in common with {a.name}",
            place=b.name,
            remedy="give two recordings of one run; `testudo replay` makes the second from the first",
        )

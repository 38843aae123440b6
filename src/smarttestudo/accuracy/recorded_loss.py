# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the operator lost between two recordings of one run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from smarttestudo.accuracy.bounds import BoundLoss, bounded_topics, needs_decisions
from smarttestudo.accuracy.crossings import thresholds_of
from smarttestudo.accuracy.fixed_rates import Source, best_fixed_rates
from smarttestudo.accuracy.loss_report import Carried, LossReport
from smarttestudo.accuracy.measure import (
    SharedTopic,
    crossing_losses,
    field_losses,
    image_losses,
    topic_loss,
)
from smarttestudo.accuracy.recorded_bounds import BoundQuestion, judge_bounds
from smarttestudo.accuracy.recorded_samples import (
    RecordedSamples,
    TopicReading,
    read_samples,
    require_numbers,
)
from smarttestudo.accuracy.samples import BULK_TYPES, Field, TopicSamples, fields_of
from smarttestudo.bags.bag_comparison import BagComparison, compare_bags
from smarttestudo.bags.bag_summary import BagSummary
from smarttestudo.bags.measure import measure_bag
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.rule_set import RuleSet

_ENDS_EARLY_S = 2.0


def _ignore(_: float) -> None:
    """Nobody wants to know."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LossQuestion:
    """What is asked of two recordings.

    ``mapping`` pairs topics as for ``compare_bags``. ``topics`` are names or patterns, empty for all;
    ``fields`` are more fields than the default ones, by topic of A. ``rule_set`` gives the thresholds and the
    bounds, ``decisions`` which of the bounds in blocks were in force; of topics in ``predict`` B's receiver
    shows dead reckoning. ``profile`` has tiers and priorities for the third arm. ``report`` gets the share
    done, 0 … 1.
    """

    mapping: Mapping[str, str] = field(default_factory=dict)
    topics: Sequence[str] = ()
    fields: Mapping[str, Sequence[str]] = field(default_factory=dict)
    rule_set: RuleSet | None = None
    decisions: Sequence[Decision] = ()
    predict: Collection[str] = ()
    profile: Profile = field(default_factory=Profile)
    report: Callable[[float], None] = _ignore


def measure_loss(a: Path, b: Path, question: LossQuestion | None = None) -> LossReport:
    """The loss between ``a``, as sent, and ``b``, as received, in the time of ``a``.

    Each recording is read twice: once for its sizes, which costs little, once for its payloads; where the
    rules have bounds, once more for these.

    Raises:
        RecordingError: one cannot be read or is empty; they share no topic or no time; a field or topic that
            was asked for does not exist.
    """
    sent, received = measure_bag(a, _ignore), measure_bag(b, _ignore)
    return loss_of_measured((a, sent), (b, received), question or LossQuestion())


def loss_of_measured(
    a: tuple[Path, BagSummary], b: tuple[Path, BagSummary], question: LossQuestion
) -> LossReport:
    """What ``measure_loss`` gives of two recordings whose sizes were measured. Raises as it does."""
    (path_a, sent), (path_b, received) = a, b
    select_topics(tuple(question.mapping), sent.statistics, place=sent.name)
    select_topics(tuple(question.mapping.values()), received.statistics, place=received.name)
    compared = compare_bags(sent, received, question.mapping)
    _require_common_time(sent, received)
    return _Measurement(path_a, path_b, compared, question).report()


class _Measurement:
    """The reading of two recordings whose topics are paired."""

    def __init__(self, a: Path, b: Path, compared: BagComparison, question: LossQuestion) -> None:
        self._paths = a, b
        self._a, self._b = compared.a, compared.b
        self._question = question
        self._partners = {
            pair.topic: pair.after_topic
            for pair in compared.comparison.topics
            if pair.before and pair.before.messages and pair.after_topic
        }
        self._asked = self._topics_asked()
        rule_set = question.rule_set
        self._thresholds = thresholds_of(rule_set) if rule_set else ()

    def report(self) -> LossReport:
        """Read both, and count what was lost."""
        path_a, path_b = self._paths
        bounded = self._bounded()
        share = 0.6 if bounded else 1.0
        sent = self._read(path_a, self._sent_readings(), share=(0.0, 0.7 * share))
        require_numbers(sent.topics, self._question.fields)
        received = self._read(path_b, self._received_readings(sent.topics), share=(0.7 * share, share))
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
            bounds=self._bounds(bounded, sent.topics, share) if bounded else (),
            carried=Carried(
                sent_bytes=sum(shared.sent.size_bytes for shared in topics),
                received_bytes=sum(shared.received.size_bytes for shared in topics),
                fixed_bytes=sum(shared.fixed_bytes for shared in topics),
            ),
            notices=(*sent.notices, *received.notices, *self._notices(topics)),
        )

    def _bounded(self) -> list[str]:
        """The topics asked for whose bounds can be judged: where a block has a word, decisions must tell."""
        rule_set = self._question.rule_set
        topics = sorted(bounded_topics(rule_set) & self._asked) if rule_set else []
        return [
            topic
            for topic in topics
            if rule_set and (self._question.decisions or not needs_decisions(rule_set, topic))
        ]

    def _bounds(
        self, topics: Sequence[str], sent: Mapping[str, TopicSamples], share: float
    ) -> tuple[BoundLoss, ...]:
        question = self._question
        if question.rule_set is None:
            return ()
        asked = BoundQuestion(
            rule_set=question.rule_set,
            decisions=question.decisions,
            channels={topic: sent[topic].channel for topic in topics},
            partners=self._partners,
            predict=question.predict,
            profile=question.profile,
        )
        return judge_bounds(*self._paths, asked, lambda done: question.report(share + (1 - share) * done))

    def _topics_asked(self) -> frozenset[str]:
        """The shared topics, by A's name, that are to be shown."""
        partners = self._partners
        asked = select_topics(tuple(self._question.fields), partners, place=self._a.name)
        if not self._question.topics:
            return frozenset(partners)
        place = f"{self._a.name}, {self._b.name}"
        chosen = select_topics(self._question.topics, {*partners, *partners.values()}, place=place)
        return asked | {topic for topic, partner in partners.items() if {topic, partner} & chosen}

    def _sent_readings(self) -> dict[str, TopicReading]:
        return {
            topic: self._sent_reading(topic) if topic in self._asked else TopicReading()
            for topic in self._partners
        }

    def _sent_reading(self, topic: str) -> TopicReading:
        asked = tuple(self._question.fields.get(topic, ()))
        needed = tuple(one.signal.property for one in self._thresholds if one.signal.topic == topic)
        return TopicReading(
            choose_fields=partial(_choose_fields, asked=asked, needed=needed),
            undecoded_types=frozenset() if asked or needed else BULK_TYPES,
            level_unit=self._question.profile.topic(topic).level_unit,
        )

    def _received_readings(self, sent: Mapping[str, TopicSamples]) -> dict[str, TopicReading]:
        """Only fields that were found in A, and only of the same type, are read."""
        return {
            partner: TopicReading(
                choose_fields=partial(_same_fields, sent[topic]) if sent[topic].fields else None,
                level_unit=self._question.profile.topic(topic).level_unit,
            )
            for topic, partner in self._partners.items()
        }

    def _read(
        self, path: Path, readings: Mapping[str, TopicReading], share: tuple[float, float]
    ) -> RecordedSamples:
        def report(done: float) -> None:
            self._question.report(share[0] + (share[1] - share[0]) * done)

        span = self._a.span
        with open_recording(path) as recording:
            return read_samples(
                recording, readings, start_ns=span.start_ns, end_ns=span.end_ns, report=report
            )

    def _shared(
        self, sent: Mapping[str, TopicSamples], received: Mapping[str, TopicSamples]
    ) -> list[SharedTopic]:
        partners = {topic: name for topic, name in self._partners.items() if sent[topic].stamps_ns}
        sources = [
            Source(
                topic=topic,
                size_bytes=sent[topic].size_bytes,
                mean_hz=sent[topic].mean_hz,
                entry=self._question.profile.topic(topic),
            )
            for topic in partners
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
            for topic, partner in partners.items()
        ]

    def _notices(self, topics: Sequence[SharedTopic]) -> Iterator[str]:
        for shared in topics:
            sent, received = shared.sent.channel.type_name, shared.received.channel.type_name
            if sent != received:
                yield (
                    f"{shared.topic}: {sent} in {self._a.name} and {received} in {self._b.name}; "
                    "its fields are not compared"
                )
        early_s = (self._a.span.end_ns - self._b.span.end_ns) / NS_PER_S
        if early_s > _ENDS_EARLY_S:
            yield f"{self._b.name}: ends {early_s:.1f} s before {self._a.name}; nothing came in that time"
        for topic in sorted({one.signal.topic for one in self._thresholds}.difference(self._partners)):
            yield f"{topic}: a check reads it, which {self._b.name} lacks; its crossings are left out"
        yield from self._bound_notices()

    def _bound_notices(self) -> Iterator[str]:
        rule_set = self._question.rule_set
        for topic in sorted(bounded_topics(rule_set)) if rule_set else ():
            if topic not in self._partners:
                yield f"{topic}: a rule bounds it, which {self._b.name} lacks; the bound is left out"
            elif rule_set and not self._question.decisions and needs_decisions(rule_set, topic):
                yield f"{topic}: its bounds are left out: a block asks for them, and no decisions say when"


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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The operator's loss between two recordings of one run."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from smarttestudo.accuracy.arms import Receiver, Source, best_fixed_rates, with_later
from smarttestudo.accuracy.bounds import (
    BoundLoss,
    BoundsFrom,
    BoundWatch,
    bounds_in_force,
    bounds_of,
    needs_decisions,
)
from smarttestudo.accuracy.loss_report import Carried, LossReport, TopicLoss
from smarttestudo.accuracy.measure import (
    SharedTopic,
    crossing_losses,
    field_losses,
    image_losses,
    thresholds_of,
    topic_loss,
)
from smarttestudo.accuracy.recorded_samples import (
    RecordedSamples,
    TopicReading,
    read_samples,
    require_numbers,
)
from smarttestudo.accuracy.samples import BULK_TYPES, Field, TopicSamples, fields_of
from smarttestudo.bags.bag_summary import BagSummary
from smarttestudo.bags.comparison import compare_bags
from smarttestudo.bags.measure import measure_bag
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.topic_selection import is_selected, select_topics
from smarttestudo.bags.type_definitions import installed_types
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.properties import accuracy_properties_of
from smarttestudo.language.rule_set import RuleSet

_ENDS_EARLY_S = 2.0
_BEGINS_LATE_S = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LossQuestion:
    """A question about two recordings.

    ``mapping`` pairs topics as for ``compare_bags``. ``topics`` are names or patterns, empty for all;
    ``fields`` are more fields than the default ones, by topic of A. ``rule_set`` gives the thresholds and the
    bounds, ``decisions`` which of the bounds in blocks were in force; of topics in ``predict`` B's receiver
    shows dead reckoning. ``profile`` has tiers and priorities for the third arm.
    """

    mapping: Mapping[str, str] = field(default_factory=dict)
    topics: Sequence[str] = ()
    fields: Mapping[str, Sequence[str]] = field(default_factory=dict)
    rule_set: RuleSet | None = None
    decisions: Sequence[Decision] = ()
    predict: Collection[str] = ()
    profile: Profile = field(default_factory=Profile)


def measure_loss(
    a: Path, b: Path, question: LossQuestion | None = None, report: Callable[[float], None] = lambda _: None
) -> LossReport:
    """The loss between ``a``, as sent, and ``b``, as received, in the time of ``a``.

    Each recording is read twice: once for its sizes, which costs little, once for its payloads. ``report``
    gets the share done, 0 … 1.

    Raises:
        RecordingError: one cannot be read; they share no topic or no time; a field or topic that
            was asked for does not exist.
    """
    sent, received = measure_bag(a, lambda _: None), measure_bag(b, lambda _: None)
    measurement = LossMeasurement(sent, (b, received), question or LossQuestion())
    with open_recording(a) as recording:
        samples = read_samples(
            recording,
            measurement.readings(),
            start_ns=sent.span.start_ns,
            end_ns=sent.span.end_ns,
            report=lambda done: report(0.7 * done),
        )
    return measurement.report(samples, lambda done: report(0.7 + 0.3 * done))


class LossMeasurement:
    """The reading of two recordings, ``a`` and ``b``, whose sizes were measured.

    Raises:
        RecordingError: they share no topic or no time; a topic that was asked for does not exist.
    """

    def __init__(self, a: BagSummary, b: tuple[Path, BagSummary], question: LossQuestion) -> None:
        self._a, (self._path, self._b) = a, b
        if question.rule_set is not None:
            found = installed_types({one.name: one.type_name for one in a.topics})
            question = replace(question, rule_set=question.rule_set.by(found))
        self._question = question
        select_topics(tuple(question.mapping), a.statistics, place=a.name)
        select_topics(tuple(question.mapping.values()), self._b.statistics, place=self._b.name)
        compared = compare_bags(a, self._b, question.mapping)
        _require_common_time(a, self._b)
        self._partners = {
            pair.topic: pair.after_topic
            for pair in compared.comparison.topics
            if pair.before and pair.before.messages and pair.after_topic
        }
        self._unsent = frozenset(
            pair.topic
            for pair in compared.comparison.topics
            if pair.before and not pair.before.messages and pair.after_topic
        )
        self._asked = self._topics_asked()
        rule_set = question.rule_set
        self._thresholds = thresholds_of(rule_set) if rule_set else ()
        self._written = bounds_of(rule_set) if rule_set else {}
        self._in_force = self._bounds_in_force()

    def readings(self) -> dict[str, TopicReading]:
        """How A is to be read."""
        return {topic: self._sent_reading(topic) for topic in self._partners}

    def report(self, sent: RecordedSamples, report: Callable[[float], None]) -> LossReport:
        """Read B, and count what was lost of what was ``sent``; ``report`` gets the share done.

        Raises:
            RecordingError: B cannot be read; a field that was asked for does not exist.
        """
        require_numbers(sent.topics, self._question.fields)
        received = self._read_received(sent.topics, report)
        topics = self._shared(sent.topics, received.topics)
        shown = [shared for shared in topics if shared.topic in self._asked]
        carried = tuple(topic_loss(shared) for shared in shown)
        return LossReport(
            a=self._a.name,
            b=self._b.name,
            duration_s=self._a.span.duration_s,
            topics=carried,
            fields=tuple(loss for shared in shown for loss in field_losses(shared)),
            crossings=tuple(loss for shared in shown for loss in crossing_losses(shared, self._thresholds)),
            images=tuple(loss for shared in shown for loss in image_losses(shared)),
            bounds=tuple(
                loss
                for topic in self._in_force
                for loss in self._bound_losses(
                    topic, sent.topics[topic], received.topics[self._partners[topic]]
                )
            ),
            carried=Carried(
                sent_bytes=sum(shared.sent.size_bytes for shared in topics),
                received_bytes=sum(shared.received.size_bytes for shared in topics),
                fixed_bytes=sum(shared.fixed.size_bytes for shared in topics),
            ),
            after_end=self._after_end(received.after_end),
            notices=(*sent.notices, *received.notices, *self._notices(topics), *_late_notices(carried)),
        )

    def _bounds_in_force(self) -> dict[str, Sequence[BoundsFrom]]:
        """The bounds, over time, of the topics asked for whose bounds can be judged."""
        rule_set, decisions = self._question.rule_set, self._question.decisions
        return {
            topic: bounds_in_force(rule_set, topic, decisions)
            for topic in sorted(self._asked.intersection(self._written))
            if rule_set and not self._needs_decisions(topic)
        }

    def _bounded(self, topic: str) -> tuple[str, ...]:
        """The properties of a topic whose bounds are judged."""
        if topic not in self._in_force:
            return ()
        named = (name for _, bounds in self._in_force[topic] for name in bounds)
        return tuple(dict.fromkeys([*self._written[topic], *named]))

    def _bound_losses(self, topic: str, sent: TopicSamples, received: TopicSamples) -> Iterator[BoundLoss]:
        properties, reckons = self._bounded(topic), topic in self._question.predict
        type_name = sent.channel.type_name
        is_same = received.channel.type_name == type_name
        watch = BoundWatch(
            Receiver(
                sent.track.gauges(properties),
                received.track.messages(properties) if is_same else (),
                reckons=reckons,
            ),
            self._in_force[topic],
            self._written[topic],
            reckons=reckons,
            start_ns=self._a.span.start_ns,
        )
        for message, later in with_later(sent.track.messages(properties)):
            watch.sent(message, later)
        units = {name: spec.unit for name, spec in accuracy_properties_of(type_name).items()}
        return watch.losses(topic, units, self._a.span.end_ns)

    def _topics_asked(self) -> frozenset[str]:
        """The shared topics, by A's name, that are to be shown."""
        partners = self._partners
        asked = select_topics(tuple(self._question.fields), partners, place=self._a.name)
        if not self._question.topics:
            return frozenset(partners)
        place = f"{self._a.name}, {self._b.name}"
        known = {*partners, *partners.values(), *self._unsent}
        chosen = select_topics(self._question.topics, known, place=place)
        return asked | {topic for topic, partner in partners.items() if {topic, partner} & chosen}

    def _sent_reading(self, topic: str) -> TopicReading:
        if topic not in self._asked:
            return TopicReading()
        asked = tuple(self._question.fields.get(topic, ()))
        needed = tuple(one.field for one in self._thresholds if one.signal.topic == topic)
        return TopicReading(
            choose_fields=partial(fields_of, asked=asked, needed=needed),
            undecoded_types=frozenset() if asked or needed else BULK_TYPES,
            properties=self._bounded(topic),
            level_unit=self._question.profile.topic(topic).level_unit,
        )

    def _read_received(
        self, sent: Mapping[str, TopicSamples], report: Callable[[float], None]
    ) -> RecordedSamples:
        """B in the time of A: only fields that were found in A, and only of the same type, are read."""
        readings = {
            partner: TopicReading(
                choose_fields=partial(_same_fields, sent[topic]) if sent[topic].fields else None,
                properties=self._bounded(topic),
                level_unit=self._question.profile.topic(topic).level_unit,
            )
            for topic, partner in self._partners.items()
        }
        with open_recording(self._path) as recording:
            return read_samples(
                recording, readings, start_ns=self._a.span.start_ns, end_ns=self._a.span.end_ns, report=report
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
        for topic in sorted(self._unsent):
            if is_selected(topic, self._question.topics):
                yield f"{topic}: {self._a.name} holds no message of it, so there is no loss to measure"
        early_s = self._ends_early_s()
        if early_s is not None and early_s > _ENDS_EARLY_S:
            yield f"{self._b.name}: ends {early_s:.1f} s before {self._a.name}; nothing came in that time"
        for topic in sorted({one.signal.topic for one in self._thresholds}.difference(self._partners)):
            yield f"{topic}: a check reads it, which {self._b.name} lacks; its crossings are left out"
        yield from self._bound_notices()

    def _ends_early_s(self) -> float | None:
        """How long before A the last message of the robot in B came, in s; ``None`` without one."""
        ends_s = [one.end_s for one in self._b.statistics.values() if one.end_s is not None]
        return (self._a.span.end_ns - self._b.span.start_ns) / NS_PER_S - max(ends_s) if ends_s else None

    def _after_end(self, messages: Mapping[str, int]) -> dict[str, int]:
        came = {topic: messages.get(self._partners[topic], 0) for topic in sorted(self._asked)}
        return {topic: count for topic, count in came.items() if count}

    def _bound_notices(self) -> Iterator[str]:
        for topic in sorted(self._written):
            if topic not in self._partners:
                yield f"{topic}: a rule bounds it, which {self._b.name} lacks; the bound is left out"
            elif self._needs_decisions(topic):
                yield f"{topic}: its bounds are left out: a block asks for them, and no decisions say when"

    def _needs_decisions(self, topic: str) -> bool:
        """Whether nobody says when the bounds of a topic were in force."""
        rule_set = self._question.rule_set
        return rule_set is not None and not self._question.decisions and needs_decisions(rule_set, topic)


def _late_notices(topics: Sequence[TopicLoss]) -> Iterator[str]:
    """Says of which topics errors and ages leave out a beginning in which nothing was received."""
    ages = ((loss.topic, loss.received.age) for loss in topics)
    unseen_s = {topic: age.unseen_s for topic, age in ages if age and age.unseen_s > _BEGINS_LATE_S}
    for seconds, group in itertools.groupby(unseen_s, key=lambda topic: f"{unseen_s[topic]:.1f}"):
        yield (
            f"{', '.join(group)}: nothing received in the first {seconds} s; errors and ages count from then"
        )


def _same_fields(sent: TopicSamples, type_name: str, _: object) -> Sequence[Field]:
    return sent.fields if type_name == sent.channel.type_name else ()


def _require_common_time(a: BagSummary, b: BagSummary) -> None:
    if not a.span.shares_time(b.span):
        raise RecordingError(
            f"it has no time in common with {a.name}",
            place=b.name,
            remedy="give two recordings of one run; `testudo replay` makes the second from the first",
        )

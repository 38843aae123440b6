# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How the loss of each topic of a recording falls with its rate."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve
from smarttestudo.accuracy.curve import LossCurve, loss_curve
from smarttestudo.accuracy.recorded_accuracy_curves import (
    Accuracies,
    accuracy_wanted,
    measure_accuracy,
)
from smarttestudo.accuracy.recorded_samples import TopicReading, read_samples, require_numbers
from smarttestudo.accuracy.samples import BULK_TYPES, Field, fields_of
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile

_SHARE_OF_READING = 0.6
_SHARE_OF_RATES = 0.4


def _ignore(_: float) -> None:
    """Nobody wants to know."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LossCurves:
    """The curves of a recording called ``name``, by topic name; ``without`` are topics that have none.

    ``accuracies`` are those of messages against accuracy, empty where they were not asked for.
    """

    name: str
    curves: tuple[LossCurve, ...]
    without: tuple[str, ...]
    notices: tuple[str, ...]
    accuracies: tuple[AccuracyCurve, ...] = ()

    def to_json(self) -> dict[str, object]:
        """The object that ``--json`` prints."""
        return {
            "bag": self.name,
            "topics": {curve.topic: curve.to_json() for curve in self.curves},
            "accuracy": [curve.to_json() for curve in self.accuracies],
            "without": list(self.without),
            "notices": list(self.notices),
        }

    def accuracies_of(self, topic: str) -> tuple[AccuracyCurve, ...]:
        """Those of one topic."""
        return tuple(curve for curve in self.accuracies if curve.topic == topic)

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each topic, rate and field, for ``--csv``."""
        for curve in self.curves:
            yield from curve.rows()


def measure_curves(
    bag: Path,
    *,
    topics: Sequence[str] = (),
    fields: Mapping[str, Sequence[str]] | None = None,
    profile: Profile | None = None,
    with_accuracy: bool = False,
    report: Callable[[float], None] = _ignore,
) -> LossCurves:
    """The loss at rates up to the source's, of ``topics`` (names or patterns, all if empty).

    ``fields`` are the only ones looked at of the topics in it. ``with_accuracy`` adds what bounds cost, for
    which the recording is read twice more. ``report`` gets the share done.

    Raises:
        RecordingError: the recording cannot be read or is empty; a topic or field does not exist.
    """
    fields, profile = fields or {}, profile or Profile()
    share = _SHARE_OF_RATES if with_accuracy else 1.0
    with open_recording(bag) as recording:
        if not recording.message_count:
            raise RecordingError("the recording holds no message", place=str(bag))
        known = {channel.topic for channel in recording.channels}
        patterns = [*topics, *fields]
        chosen = sorted(select_topics(patterns, known, place=str(bag)) if patterns else known)
        samples = read_samples(
            recording,
            {topic: _reading(topic, fields.get(topic, ()), profile) for topic in chosen},
            start_ns=recording.start_ns,
            end_ns=recording.end_ns,
            report=lambda done: report(share * _SHARE_OF_READING * done),
        )
        require_numbers(samples.topics, fields)
        found: dict[str, LossCurve | None] = {}
        for number, topic in enumerate(chosen):
            report(share * (_SHARE_OF_READING + (1 - _SHARE_OF_READING) * number / len(chosen)))
            found[topic] = loss_curve(samples.topics[topic], recording.end_ns)
    accuracies = Accuracies()
    if with_accuracy:
        wanted = {topic: accuracy_wanted(samples.topics[topic], fields.get(topic, ())) for topic in chosen}
        accuracies = measure_accuracy(bag, wanted, profile, lambda done: report(share + (1 - share) * done))
    return LossCurves(
        name=str(bag),
        curves=tuple(curve for curve in found.values() if curve),
        accuracies=accuracies.curves,
        without=tuple(topic for topic, curve in found.items() if curve is None),
        notices=(*samples.notices, *accuracies.notices),
    )


def _reading(topic: str, asked: Sequence[str], profile: Profile) -> TopicReading:
    def choose(type_name: str, message: object) -> Sequence[Field]:
        chosen = fields_of(type_name, message, asked=asked)
        return [field for field in chosen if field.is_asked] if asked else chosen

    return TopicReading(
        choose_fields=choose,
        undecoded_types=frozenset() if asked else BULK_TYPES,
        level_unit=profile.topic(topic).level_unit,
    )

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The operator's loss in numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated

from smarttestudo.accuracy.bounds import BoundLoss
from smarttestudo.domain.record import JsonEntry, to_columns


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorSize:
    """How large an error was over time, in the field's unit.

    ``rmse`` is the root of the mean square over time, ``maximum`` the largest magnitude. The relative ones
    are shares of the field's range (0.02 is 2 %), ``None`` where the field never changed.
    """

    rmse: float
    maximum: Annotated[float, JsonEntry(name="max")]
    relative_rmse: float | None
    relative_maximum: Annotated[float | None, JsonEntry(name="relative_max")]


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldError:
    """The error when the last value received is held, and when those received are interpolated."""

    hold: ErrorSize
    interpolated: ErrorSize


_POSITION = ("pose_x", "pose_y", "pose_z")


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldLoss:
    """One numeric field of one topic, by the name that rules read it by.

    ``unit`` is empty where it is unknown. ``value_range`` is greatest minus least value sent, in that unit
    (of an angle that wraps: of its continuous course, at most 360°). ``excluded_sent`` and
    ``excluded_received`` count messages without a finite number there, which are left out.
    """

    topic: str
    field: str
    unit: str
    value_range: Annotated[float, JsonEntry(name="range")]
    received: FieldError | None
    fixed: FieldError | None
    excluded_sent: int = 0
    excluded_received: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Age:
    """Time since the newest message received, in s: mean, 95th percentile and maximum over time.

    It counts from the first message to the end of A. ``unseen_s`` are the seconds before that, from A's
    first message of the topic on, in which the operator had nothing.
    """

    mean_s: float
    p95_s: float
    max_s: float
    unseen_s: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicArm:
    """One arm's share of a topic: messages, bytes (as declared, where they are) and age."""

    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    age: Age | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicLoss:
    """One topic that A and B share; ``received_topic`` is its name in B, ``fixed_hz`` the best fixed rate.

    ``fixed_hz`` is infinite where the third arm passes every message.
    """

    topic: str
    received_topic: Annotated[str, JsonEntry(name="b_topic")]
    type_name: Annotated[str, JsonEntry(name="type")]
    sent: TopicArm
    received: TopicArm
    fixed: TopicArm
    fixed_hz: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sightings:
    """How an operator who holds the last value saw the crossings of a threshold.

    ``late_mean_s`` and ``late_max_s`` are over those that were late; ``None`` without one. Of a check of a
    text or a state, ``wrong_s`` is for how long the operator believed something else, or knew nothing yet.
    """

    in_time: int
    late: int
    missed: int
    late_mean_s: float | None
    late_max_s: float | None
    wrong_s: Annotated[float | None, JsonEntry(omits_default=True)] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossingLoss:
    """The crossings of one check's threshold in A; ``check`` is for instance ``/odom pose_y > 5.4``."""

    check: str
    crossings: int
    received: Sightings
    fixed: Sightings


@dataclass(frozen=True, slots=True, kw_only=True)
class Frames:
    """Frames of one arm, and the longest time without a new one, in s; it counts to the end of A."""

    frames: int
    longest_blind_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageLoss:
    """One topic of images; their pixels are not looked at."""

    topic: str
    sent: Frames
    received: Frames
    fixed: Frames


@dataclass(frozen=True, slots=True, kw_only=True)
class Carried:
    """Bytes of all topics that A and B share, each arm's."""

    sent_bytes: Annotated[int, JsonEntry(name="sent")]
    received_bytes: Annotated[int, JsonEntry(name="received")]
    fixed_bytes: Annotated[int, JsonEntry(name="fixed")]


@dataclass(frozen=True, slots=True, kw_only=True)
class LossReport:
    """The operator's loss; ``a`` and ``b`` are the recordings' names, ``duration_s`` that of A.

    ``fields``, ``topics``, ``crossings`` and ``images`` are in the order of A's topics; ``carried`` is over
    all shared topics, also those not asked for. ``bounds`` are those of the rules, empty without any.
    ``after_end`` counts messages of B, by topic, that came when A had ended, such as what was held back; no
    figure holds them. ``notices`` say what was left out and why, a line each.
    """

    a: str
    b: str
    duration_s: float
    topics: Annotated[tuple[TopicLoss, ...], JsonEntry(keyed_by="topic")]
    fields: tuple[FieldLoss, ...]
    crossings: tuple[CrossingLoss, ...]
    images: tuple[ImageLoss, ...]
    carried: Annotated[Carried, JsonEntry(name="bytes")]
    bounds: Annotated[tuple[BoundLoss, ...], JsonEntry(omits_default=True)] = ()
    after_end: Annotated[Mapping[str, int], JsonEntry(omits_default=True)] = field(default_factory=dict)
    notices: tuple[str, ...] = ()

    def fields_of(self, topic: str) -> tuple[FieldLoss, ...]:
        """The fields of one topic."""
        return tuple(loss for loss in self.fields if loss.topic == topic)

    def position_rmse_m(self, topic: str) -> float | None:
        """How far from the robot its held position was: RMSE of the distance in m, ``None`` without poses."""
        return _distance_m({loss.field: loss.received for loss in self.fields_of(topic)})

    def fixed_position_rmse_m(self, topic: str) -> float | None:
        """The same as ``position_rmse_m`` with the best fixed rates."""
        return _distance_m({loss.field: loss.fixed for loss in self.fields_of(topic)})

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each field, for ``--csv``."""
        for loss in self.fields:
            row = LossRow(
                topic=loss.topic,
                field=loss.field,
                unit=loss.unit,
                value_range=loss.value_range,
                b=loss.received,
                fixed=loss.fixed,
            )
            yield to_columns(row)


@dataclass(frozen=True, slots=True, kw_only=True)
class LossRow:
    """A field as a row: the errors of B's data and at fixed rates."""

    topic: str
    field: str
    unit: str
    value_range: Annotated[float, JsonEntry(name="range")]
    b: FieldError | None
    fixed: FieldError | None


def _distance_m(errors: Mapping[str, FieldError | None]) -> float | None:
    """The RMSE of a distance from those of its coordinates; one that never changed has none, and is 0."""
    known = [errors[axis] for axis in _POSITION if axis in errors]
    if not any(axis in errors for axis in _POSITION[:2]) or None in known:
        return None
    return math.hypot(*(error.hold.rmse for error in known if error))

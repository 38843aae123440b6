# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The accuracy of an operator's picture, by several ways of choosing what passes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Annotated

from smarttestudo.accuracy.arms import PacedPicture
from smarttestudo.domain.record import JsonEntry, derived, to_columns


class View(Enum):
    """The picture that an operator's end shows between two messages."""

    HOLD = "hold"
    RECKONED = "dead reckoning"


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertyAccuracy:
    """One property of a topic, in ``unit``: its error, ``None`` where it was never known, and its bounds.

    ``bounds`` are those that the rules name, rising, empty where there is none; ``broken`` counts messages of
    the source after which the bound in force did not hold.
    """

    unit: str
    error: Annotated[PacedPicture | None, JsonEntry(is_absent=True)]
    bounds: tuple[float, ...] = ()
    broken: int = 0

    @property
    @derived()
    def rmse(self) -> float | None:
        """The error over time."""
        return self.error.rmse if self.error else None

    @property
    @derived()
    def worst(self) -> float | None:
        """The largest error."""
        return self.error.worst if self.error else None


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicAccuracy:
    """A topic in one run: how much of it passed, and how accurate its properties were."""

    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    properties: Mapping[str, PropertyAccuracy]


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmAccuracy:
    """One way of choosing what passes; ``size_bytes`` are those of all topics that are compared."""

    name: str
    view: Annotated[View, JsonEntry(name="shows")]
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    topics: Mapping[str, TopicAccuracy]


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyComparison:
    """The ways beside each other, of a recording called ``bag``.

    The first are fixed rates for the bytes of the first rules, then come the rules. ``fixed_hz`` are those
    rates by topic, infinite where everything passes. ``left_out`` are topics of images, which would hide the
    others' bytes.
    """

    bag: str
    arms: tuple[ArmAccuracy, ...]
    fixed_hz: Mapping[str, float]
    left_out: tuple[str, ...]
    notices: tuple[str, ...] = ()

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each way, topic and property, for ``--csv``."""
        for arm in self.arms:
            for topic, passed in arm.topics.items():
                for name, one in passed.properties.items():
                    row = AccuracyRow(
                        name=arm.name,
                        view=arm.view,
                        all_bytes=arm.size_bytes,
                        topic=topic,
                        messages=passed.messages,
                        size_bytes=passed.size_bytes,
                        property_name=name,
                        unit=one.unit,
                        rmse=one.rmse,
                        worst=one.worst,
                        bounds=one.bounds,
                        broken=one.broken,
                    )
                    yield to_columns(row)


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyRow:
    """A property of a topic by one way of choosing what passes, as a row."""

    name: str
    view: Annotated[View, JsonEntry(name="shows")]
    all_bytes: int
    topic: str
    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    property_name: Annotated[str, JsonEntry(name="property")]
    unit: str
    rmse: float | None
    worst: float | None
    bounds: tuple[float, ...]
    broken: int

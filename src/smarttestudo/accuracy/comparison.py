# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How accurate an operator's picture was, by several ways of choosing what passes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from smarttestudo.accuracy.error_over_time import ErrorOverTime
from smarttestudo.pacing.reckoning.picture import Picture

Decode = Callable[[bytes], object | None]
"""The decoded message, where the picture needs one and it can be read; else ``None``."""

Message = tuple[int, bytes]
"""When it came, in ns, and its serialized form."""


class View(Enum):
    """What an operator's end shows between two messages."""

    HOLD = "hold"
    RECKONED = "dead reckoning"


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureError:
    """The error of one property in its unit: root of the mean square over time, and the largest."""

    rmse: float
    worst: float


def picture_errors(
    picture: Picture, sent: Sequence[Message], received: Sequence[Message], end_ns: int, decode: Decode
) -> dict[str, PictureError]:
    """The error of each property that ``picture`` measures, until ``end_ns``; none for one never known.

    Both sequences are in the order of time.
    """
    found: dict[str, ErrorOverTime] = {}
    arrived = 0
    for stamp_ns, payload in sent:
        while arrived < len(received) and received[arrived][0] <= stamp_ns:
            got_ns, got = received[arrived]
            picture.show(picture.read(got, decode(got), got_ns), None)
            arrived += 1
        for name, error in picture.errors(picture.read(payload, decode(payload), stamp_ns), None).items():
            found.setdefault(name, ErrorOverTime(stamp_ns)).add(error, stamp_ns)
    for one in found.values():
        one.pass_time(end_ns)
    return {
        name: PictureError(rmse=one.rmse, worst=one.worst)
        for name, one in found.items()
        if one.unknown < len(sent)
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertyAccuracy:
    """One property of a topic, in ``unit``: its error, ``None`` where it was never known, and its bounds.

    ``bounds`` are those that the rules name, rising, empty where there is none; ``broken`` counts messages of
    the source after which the bound in force did not hold.
    """

    unit: str
    error: PictureError | None
    bounds: tuple[float, ...] = ()
    broken: int = 0

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {
            "unit": self.unit,
            "rmse": self.error.rmse if self.error else None,
            "worst": self.error.worst if self.error else None,
            "bounds": list(self.bounds),
            "broken": self.broken,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicAccuracy:
    """What passed of a topic, and how accurate its properties were."""

    messages: int
    size_bytes: int
    properties: Mapping[str, PropertyAccuracy]

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {
            "messages": self.messages,
            "bytes": self.size_bytes,
            "properties": {name: one.to_json() for name, one in self.properties.items()},
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """One way of choosing what passes; ``size_bytes`` are those of all topics that are compared."""

    name: str
    view: View
    size_bytes: int
    topics: Mapping[str, TopicAccuracy]

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {
            "name": self.name,
            "shows": self.view.value,
            "bytes": self.size_bytes,
            "topics": {name: topic.to_json() for name, topic in self.topics.items()},
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyComparison:
    """The ways beside each other, of a recording called ``bag``.

    The first are fixed rates for the bytes of the first rules, then come the rules. ``fixed_hz`` are those
    rates by topic, infinite where everything passes. ``left_out`` are topics of images, which would hide the
    others' bytes.
    """

    bag: str
    arms: tuple[Arm, ...]
    fixed_hz: Mapping[str, float]
    left_out: tuple[str, ...]
    notices: tuple[str, ...] = ()

    def to_json(self) -> dict[str, object]:
        """The object that ``--json`` prints; a rate that is infinite is null, as everywhere."""
        return {
            "bag": self.bag,
            "arms": [arm.to_json() for arm in self.arms],
            "fixed_hz": {topic: None if math.isinf(hz) else hz for topic, hz in self.fixed_hz.items()},
            "left_out": list(self.left_out),
            "notices": list(self.notices),
        }

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each way, topic and property, for ``--csv``."""
        for arm in self.arms:
            for topic, passed in arm.topics.items():
                for name, one in passed.properties.items():
                    yield {
                        "name": arm.name,
                        "shows": arm.view.value,
                        "all_bytes": arm.size_bytes,
                        "topic": topic,
                        "messages": passed.messages,
                        "bytes": passed.size_bytes,
                        "property": name,
                        **one.to_json(),
                    }

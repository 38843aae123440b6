# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which fields of a topic are looked at."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from numbers import Real

from smarttestudo.adirf.properties import properties_of
from smarttestudo.adirf.properties.spec import PropertySpec
from smarttestudo.visualizer.loss.series import FULL_TURN

MOST_FIELDS = 12
"""Fields of one topic that are looked at unasked, of a type without named properties."""

IMAGE_TYPES = frozenset({"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"})
BULK_TYPES = IMAGE_TYPES | {"sensor_msgs/msg/PointCloud2", "nav_msgs/msg/OccupancyGrid"}
"""Types whose numbers are not in their scalar fields: not decoded unless a field is asked for."""

_DEEPEST = 8
_NO_MEASUREMENTS = frozenset({"header", "covariance"})
_TIME = frozenset({"sec", "nanosec"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A property or field path; ``unit`` is empty where unknown, ``wraps`` true of degrees that go round."""

    name: str
    unit: str = ""
    wraps: bool = False
    is_asked: bool = False


def fields_of(
    type_name: str, message: object, *, asked: Sequence[str] = (), needed: Sequence[str] = ()
) -> tuple[Field, ...]:
    """The fields to look at of a topic of ``type_name``, of which ``message`` is one.

    Of a type with named properties those, else the first ``MOST_FIELDS`` scalar numbers; then what is
    ``asked`` for or ``needed`` beside them.
    """
    specs = properties_of(type_name)
    names = [*specs] if specs else [*scalar_paths(message)][:MOST_FIELDS]
    if type_name in BULK_TYPES:
        names = []
    chosen = dict.fromkeys([*names, *asked, *needed])
    return tuple(_field(name, specs.get(name), is_asked=name in asked) for name in chosen)


def scalar_paths(message: object, *, deepest: int = _DEEPEST) -> Iterator[str]:
    """The paths of the numbers in a decoded message, without arrays, headers and times."""
    if not dataclasses.is_dataclass(message) or not deepest:
        return
    names = [field.name for field in dataclasses.fields(message) if not field.name.startswith("_")]
    if _TIME.issuperset(names):
        return
    for name in names:
        value = getattr(message, name)
        if isinstance(value, Real):
            yield name
        elif name not in _NO_MEASUREMENTS:
            yield from (f"{name}.{path}" for path in scalar_paths(value, deepest=deepest - 1))


def _field(name: str, spec: PropertySpec | None, *, is_asked: bool) -> Field:
    if spec is None:
        return Field(name=name, is_asked=is_asked)
    wraps = spec.unit == "°" and (spec.minimum, spec.maximum) == (-FULL_TURN / 2, FULL_TURN / 2)
    return Field(name=name, unit=spec.unit, wraps=wraps, is_asked=is_asked)

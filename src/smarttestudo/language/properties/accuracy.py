# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Readers of messages for the properties that a KeepWithin bounds."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import attrgetter, itemgetter

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties.distances import value_distance, wraps
from smarttestudo.language.properties.field_path import field_reader, part_reader
from smarttestudo.language.properties.readers import known_only
from smarttestudo.language.properties.table import MessageType, message_type, properties_of, value_reader
from smarttestudo.pacing.reckoning.gauges import Distance, FieldGauge, Gauge


def gauges_for(
    type_name: str, names: Iterable[str], level_unit: LevelUnit | None = None, *, is_standard: bool = True
) -> tuple[Gauge, ...]:
    """The reader of these properties of messages of ``type_name``; what only some of them need comes last.

    Unless the type ``is_standard``, serialized messages do not have the bytes of its name, and are decoded.
    """
    known = message_type(type_name)
    reckoned: dict[str, Distance] = {}
    fields: list[str] = []
    for name in names:
        distance = _reckoned(known, name) if is_standard else None
        if distance is None:
            fields.append(name)
        else:
            reckoned[name] = distance
    gauges: list[Gauge] = [known.gauge(reckoned)] if reckoned and known.gauge else []
    if fields:
        gauges.append(_field_gauge(type_name, fields, level_unit))
    return tuple(gauges)


def needs_decoded(gauges: Iterable[Gauge]) -> bool:
    """Whether messages must be decoded for these gauges; the others read serialized ones."""
    return any(isinstance(gauge, FieldGauge) for gauge in gauges)


def _reckoned(known: MessageType, name: str) -> Distance | None:
    """The distance of two states of what is read without decoding, ``None`` where it holds no such thing."""
    own = next((distance.distance for distance in known.distances if distance.spec.name == name), None)
    if own is not None or known.gauge is None:
        return own
    value = known.value(name)
    if value is not None:
        if value.part not in known.paths:
            return None
        read, part_of = value.reader(), attrgetter(value.part.value)
        return value_distance(lambda state: read(part_of(state)), is_angle=wraps(value.spec))
    found = known.part_at(name)
    if found is None or not found[0].has_number(found[1]):
        return None
    read, part_of = field_reader(found[1]), attrgetter(found[0].value)
    return value_distance(lambda state: read(part_of(state)))


def _field_gauge(type_name: str, names: Iterable[str], level_unit: LevelUnit | None) -> FieldGauge:
    specs = properties_of(type_name)
    readers: dict[str, Callable[[object], object]] = {}
    distances: dict[str, Distance] = {}
    for name in names:
        spec = specs.get(name)
        readers[name] = (
            known_only(type_name, name, part_reader(name))
            if spec is None
            else value_reader(type_name, name, level_unit)
        )
        distances[name] = value_distance(itemgetter(name), is_angle=spec is not None and wraps(spec))
    return FieldGauge(distances, readers)

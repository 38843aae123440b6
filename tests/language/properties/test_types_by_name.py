# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A type is what its definition says, not what its name promises: what a message lacks is unknown."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bags.bag_factory import message_of
from smarttestudo.language.properties import (
    accuracy_properties_of,
    gauges_for,
    known_types,
    needs_decoded,
    properties_of,
    value_reader,
)

ODD: dict[str, Any] = {
    "empty text": "",
    "text": "1.5",
    "nothing": None,
    "no list": [],
    "list": [1.0],
    "list of texts": ["a"],
    "one": np.ones(1),
    "array": np.ones(3),
    "byte": b"x",
    "bytes": b"xy",
    "largest integer": 2**64 - 1,
    "least integer": -(2**63),
    "largest": 1.7976931348623157e308,
    "large": -1e200,
    "NaN": math.nan,
    "infinite": math.inf,
    "truth": True,
    "message": SimpleNamespace(nothing=1),
}


def places(message: Any) -> Iterator[tuple[Any, str]]:
    """Each field of a message, with the message that holds it."""
    for field in dataclasses.fields(message):
        if not field.name.startswith("_"):
            yield message, field.name
            value = getattr(message, field.name)
            if dataclasses.is_dataclass(value):
                yield from places(value)


def changed(type_name: str, odd_values: Mapping[str, Any] = ODD) -> Iterator[Any]:
    """Messages of the type, each with one field that is missing, has another name or is of another type."""
    for number, _ in enumerate(places(message_of(type_name))):
        for odd in (*odd_values.values(), ODD):
            message = message_of(type_name)
            holder, field = [*places(message)][number]
            if odd is ODD:
                setattr(holder, f"{field}_2", getattr(holder, field))
                delattr(holder, field)
            else:
                setattr(holder, field, odd)
            yield message


@pytest.mark.parametrize("type_name", known_types())
def test_every_property_is_a_number_or_unknown_whatever_a_field_is(type_name: str) -> None:
    readers = [value_reader(type_name, name) for name in properties_of(type_name)]
    named = accuracy_properties_of(type_name)
    gauges = [gauge for gauge in gauges_for(type_name, named) if needs_decoded([gauge])]
    assert readers
    for message in changed(type_name):
        assert all(isinstance(read(message), float) for read in readers)
        for gauge in gauges:
            ((_, _, _, state, _),) = gauge.read(b"", message, 0) or ()
            for distance in gauge.distances.values():
                assert isinstance(distance.between(state, state), float)
                assert distance.has_value(state) in (True, False)


@pytest.mark.parametrize("type_name", known_types())
def test_no_property_is_made_of_a_text_or_an_array(type_name: str) -> None:
    has_arrays = type_name == "sensor_msgs/msg/JointState"
    odd = {name: ODD[name] for name in ("text", *(() if has_arrays else ("list", "one", "array")))}
    for name in properties_of(type_name):
        values = {value_reader(type_name, name)(message) for message in changed(type_name, odd)}
        assert {value for value in values if not math.isnan(value)} <= {0.0}

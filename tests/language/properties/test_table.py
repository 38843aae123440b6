# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The table of properties: each is a number of real messages, and a KeepWithin sees it change."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype

from bags.bag_factory import TYPES, cdr
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.properties import (
    PropertySpec,
    accuracy_properties_of,
    gauges_for,
    known_types,
    properties_for_bounds,
    properties_of,
    value_reader,
)
from smarttestudo.language.properties.table import MessagePart, MessageType, ValueProperty
from smarttestudo.pacing.reckoning.estimate import Estimate

NAMED = sorted({*known_types(), *properties_for_bounds()})
SPEC = PropertySpec(name="doubt", unit="m", meaning="how sure it is")
LIMITS = {"range_min": 0.0, "range_max": 1.0}


def filled(type_name: str, chance: random.Random) -> Any:
    """A message with a number of 0.1 to 0.9 in each field and one element in each list."""

    def value(name: str, kind: Any) -> Any:
        node, of = Nodetype(int(kind[0])), kind[1]
        if node is Nodetype.NAME:
            return filled(of, chance)
        if node is Nodetype.BASE:
            if of[0] == "string":
                return "a"
            if name == "status":
                return chance.randrange(1, 4)
            number = LIMITS.get(name, chance.uniform(0.1, 0.9))
            return number if of[0].startswith("float") else int(number)
        element, count = of
        values = [value(name, element) for _ in range(count if node is Nodetype.ARRAY else 1)]
        is_number = int(element[0]) == 1 and element[1][0] != "string"
        return np.array(values, dtype=element[1][0].replace("octet", "uint8")) if is_number else values

    fields = TYPES.get_msgdef(type_name).fields
    return TYPES.types[type_name](**{name: value(name, kind) for name, kind in fields})


@pytest.mark.parametrize("type_name", known_types())
def test_a_property_is_a_number_of_a_message_of_its_type(type_name: str) -> None:
    message = filled(type_name, random.Random(1))
    values = {name: value_reader(type_name, name)(message) for name in properties_of(type_name)}
    assert [name for name, value in values.items() if not math.isfinite(value)] == []


@pytest.mark.parametrize("type_name", NAMED)
@pytest.mark.parametrize("is_standard", [True, False], ids=["as it is", "decoded"])
def test_a_bound_property_of_two_different_messages_is_off(type_name: str, *, is_standard: bool) -> None:
    chance = random.Random(1)
    one, other = filled(type_name, chance), filled(type_name, chance)
    values = properties_of(type_name)
    names = accuracy_properties_of(type_name) if is_standard else values
    picture = Estimate(gauges_for(type_name, names, is_standard=is_standard), reckons=False)
    picture.show(picture.read(cdr(type_name, one), one, NS_PER_S), None)
    errors = picture.errors(picture.read(cdr(type_name, other), other, 2 * NS_PER_S), None)
    assert set(errors) == set(names)
    assert {name: error for name, error in errors.items() if not 0 < error < math.inf} == {}


def test_a_value_is_read_of_the_part_that_it_is_declared_for() -> None:
    with pytest.raises(AttributeError, match="covariance"):
        ValueProperty(spec=SPEC, read_of=lambda _: lambda pose: pose.covariance[0], part=MessagePart.POSE)


def test_a_type_without_a_twist_has_no_properties_of_one() -> None:
    speed = ValueProperty(spec=SPEC, read_of=lambda _: lambda twist: twist.linear.x, part=MessagePart.TWIST)
    with pytest.raises(ValueError, match="doubt is of a twist, which this type has not"):
        MessageType(values=(speed,), paths={MessagePart.POSE: "pose"})

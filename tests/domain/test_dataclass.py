# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Dataclasses that compile later, beside those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable, Hashable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.domain.dataclass import dataclass

NAMES = ("first", "second", "third", "fourth")


@st.composite
def options_of_a_field(draw: st.DrawFn) -> dict[str, Any]:
    """What ``dataclasses.field`` is asked for."""
    options: dict[str, Any] = {name: draw(st.booleans()) for name in ("init", "repr", "compare")}
    options["hash"] = draw(st.sampled_from([None, True, False]))
    match draw(st.sampled_from(["none", "value", "factory"])):
        case "value":
            options["default"] = draw(st.sampled_from([None, 7, "text", (1, 2)]))
        case "factory":
            options["default_factory"] = tuple
        case _:
            # Without a value, nothing but a caller can give one.
            options["init"] = True
    return options


@st.composite
def specimens(draw: st.DrawFn) -> tuple[dict[str, Any], Callable[[], type]]:
    """Options of the decorator, and a maker of the class that it decorates."""
    options = {name: draw(st.booleans()) for name in ("frozen", "slots", "eq")}
    options["kw_only"] = True
    wanted = {name: draw(options_of_a_field()) for name in NAMES[: draw(st.integers(0, len(NAMES)))]}
    own: dict[str, object] = {}
    if draw(st.booleans()):
        own["__doc__"] = "What it is."
    if draw(st.booleans()):
        own["__repr__"] = lambda _: "own"
    if draw(st.booleans()):
        own["__eq__"] = lambda self, other: type(self) is type(other)
    if draw(st.booleans()):
        own["__hash__"] = lambda _: 3

    def make() -> type:
        fields = {name: dataclasses.field(**each) for name, each in wanted.items()}
        annotations = dict.fromkeys(fields, "object")
        names = {"__annotations__": annotations, "__module__": __name__, "__qualname__": "Thing"}
        return type("Thing", (), {**names, **fields, **own})

    return options, make


def outcome(work: Callable[[], object]) -> object:
    """What comes of it; of an error, its class and its words."""
    try:
        return work()
    except Exception as error:  # noqa: BLE001 - whatever it is, both have the same
        return type(error), str(error).replace("_", "")


def facts(kind: Any, some: list[Any], others: list[Any]) -> list[object]:
    """What somebody sees of a class and of objects with these values."""
    names = [each.name for each in dataclasses.fields(kind) if each.init]
    one, other = (kind(**dict(zip(names, values, strict=False))) for values in (some, others))
    return [
        list(inspect.signature(kind).parameters),
        repr(one),
        one == other,
        one == kind(**dict(zip(names, some, strict=False))),
        one == object(),
        isinstance(one, Hashable),
        kind.__hash__ is object.__hash__ or outcome(lambda: hash(one)),
        outcome(lambda: setattr(one, "first", 5)) is None,
        outcome(lambda: delattr(one, "first")) is None,
        outcome(lambda: setattr(one, "unknown", 5)) is None,
        outcome(lambda: repr(kind())),
        outcome(lambda: kind(unknown=1)),
        [str(each) for each in dataclasses.fields(kind)],
        outcome(lambda: repr(dataclasses.replace(other, first="new"))),
        repr(copy.copy(other)),
        getattr(kind, "__slots__", None),
        kind.__match_args__,
    ]


@settings(max_examples=400)
@given(
    specimens(),
    st.lists(st.sampled_from([None, 1, 2.5, "text", (), []]), min_size=4, max_size=4),
    st.lists(st.sampled_from([None, 1, 2.5, "text", (), []]), min_size=4, max_size=4),
)
def test_a_class_acts_as_one_of_the_standard_library(
    specimen: tuple[dict[str, Any], Callable[[], type]], some: list[Any], others: list[Any]
) -> None:
    options, make = specimen
    mine: Any = dataclass(**options)(make())
    standard: Any = dataclasses.dataclass(**options)(make())
    assert facts(mine, some, others) == facts(standard, some, others)


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """For what needs a class that can be imported."""

    x: float
    tags: tuple[str, ...] = ()


class Named(Point):
    """Of a class that makes objects of its own."""


def test_an_object_travels_to_another_process() -> None:
    point = Point(x=1.5, tags=("a",))
    assert pickle.loads(pickle.dumps(point)) == point


def test_the_class_of_an_heir_is_the_one_that_compiles() -> None:
    assert Named(x=1) == Named(x=1)
    assert Named(x=1) != Point(x=1)
    assert repr(Named(x=1)) == "Named(x=1, tags=())"
    assert Point(x=2).x == 2
    assert inspect.get_annotations(Point.__init__) == {"x": "float", "tags": "tuple[str, ...]"}


def test_a_frozen_object_names_the_field_that_it_keeps() -> None:
    point: Any = Point(x=1)
    with pytest.raises(dataclasses.FrozenInstanceError, match=r"^cannot assign to field 'x'$"):
        point.x = 2
    with pytest.raises(dataclasses.FrozenInstanceError, match=r"^cannot delete field 'x'$"):
        del point.x
    with pytest.raises(dataclasses.FrozenInstanceError, match=r"^cannot assign to field 'y'$"):
        point.y = 2

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records as JSON and back, and what an older version wrote.

The files in ``older`` were written by commit a58dded: inputs of each kind, decisions and an incident.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Annotated, Literal

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from smarttestudo.domain.decision import BoundReason, Decision, PlannedRate, Reason
from smarttestudo.domain.incident import (
    IncidentRecord,
    IncidentTopic,
    LatchedSample,
    Missing,
    MissingReason,
    incident_to_json,
    read_incident,
)
from smarttestudo.domain.observation import LinkBudget, ListenersChanged, ReceiversReckon, SourceChanged
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.record import (
    AtMost,
    Count,
    Decimals,
    JsonEntry,
    Mark,
    Measured,
    Significant,
    derived,
    from_json,
    measured_names,
    to_json,
)
from smarttestudo.domain.texts import in_utf_8
from smarttestudo.loop.decision_log import read_decisions
from smarttestudo.loop.input_log import input_from_json, input_to_json
from smarttestudo.loop.inputs import ChangeInput, MessageInput, RuleTextsInput, WakeInput

OLDER = Path(__file__).parent / "older"
T_NS = 1_764_100_000_000_000_000
MAX_SIZE = 1000


class Colour(Enum):
    RED = "red"
    BLUE = "blue"


class Level(Enum):
    LOW = 0
    HIGH = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    name: str
    level: Level
    height: Annotated[Annotated[float, Significant(3)] | None, JsonEntry(is_lenient=True)] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Size:
    width: Annotated[int, AtMost(MAX_SIZE)]
    seen: Count = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    colour: Colour
    size: Annotated[Size, JsonEntry(is_merged=True)]
    rate_hz: Annotated[float, Mark.NULL_IS_INFINITE] = math.inf
    speed: Measured | None = None
    is_open: Annotated[bool, JsonEntry(name="open", omits_default=True)] = False
    points: Annotated[tuple[Point, ...], JsonEntry(keyed_by="name")] = ()
    row: Annotated[tuple[Point, ...], JsonEntry(are_rows=True, is_lenient=True, omits_default=True)] = ()
    tags: frozenset[str] = frozenset()
    weights: Mapping[str, Annotated[float, Decimals(1)]] = field(default_factory=dict)
    cache: Annotated[int, JsonEntry(is_absent=True)] = 0
    inner: Annotated[Shape | None, JsonEntry(omits_default=True)] = None
    kind: Annotated[Literal["round", "flat"], JsonEntry(omits_default=True)] = "round"
    turns: Annotated[tuple[tuple[float, Level | None], ...], JsonEntry(omits_default=True)] = ()

    @property
    @derived("area")
    def area_m2(self) -> Measured:
        return self.size.width**2 / 3


def test_fields_stand_as_their_types_say() -> None:
    shape = Shape(
        colour=Colour.BLUE,
        size=Size(width=4, seen=9),
        rate_hz=math.inf,
        speed=1.23456,
        points=(Point(name="a", level=Level.HIGH, height=123456.0),),
        row=(Point(name="b", level=Level.LOW, height=math.inf),),
        tags=frozenset({"z", "a"}),
        weights={"x": 0.25},
        cache=7,
        kind="flat",
        turns=((0.5, Level.HIGH), (1.0, None)),
    )
    assert to_json(shape) == {
        "colour": "blue",
        "width": 4,
        "seen": 9,
        "rate_hz": None,
        "speed": 1.235,
        "points": {"a": {"level": "high", "height": 123000.0}},
        "row": [["b", "low", None]],
        "tags": ["a", "z"],
        "weights": {"x": 0.2},
        "kind": "flat",
        "turns": [[0.5, "high"], [1.0, None]],
        "area": 5.333,
    }
    assert measured_names(Shape) == {"speed", "seen", "area"}


points = st.builds(
    Point, name=st.text(), level=st.sampled_from(Level), height=st.none() | st.integers(-99, 99).map(float)
)
shapes = st.recursive(
    st.builds(
        Shape,
        colour=st.sampled_from(Colour),
        size=st.builds(Size, width=st.integers(-MAX_SIZE, MAX_SIZE), seen=st.integers()),
        rate_hz=st.floats(0, allow_nan=False),
        speed=st.none() | st.integers(-999, 999).map(lambda each: each / 8),
        is_open=st.booleans(),
        points=st.lists(points, unique_by=lambda each: each.name).map(tuple),
        row=st.lists(points).map(tuple),
        tags=st.frozensets(st.text()),
        weights=st.dictionaries(st.text(), st.integers(-9, 9).map(lambda each: each / 2)),
        kind=st.sampled_from(["round", "flat"]),
        turns=st.lists(st.tuples(st.integers(0, 9).map(float), st.none() | st.sampled_from(Level))).map(
            tuple
        ),
    ),
    lambda inner: st.builds(
        Shape, colour=st.just(Colour.RED), size=st.builds(Size, width=st.just(1)), inner=inner
    ),
    max_leaves=3,
)


@given(shapes)
def test_what_is_written_is_read(shape: Shape) -> None:
    assert from_json(Shape, json.loads(json.dumps(to_json(shape)))) == shape


# With what JSON can name and UTF-8 cannot say.
TEXTS = st.text(st.characters())
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | TEXTS | st.sampled_from(["red", "high"]),
    lambda inner: (
        st.lists(inner)
        | st.dictionaries(TEXTS | st.sampled_from(["colour", "width", "row", "points"]), inner)
    ),
)


@given(ANYTHING)
def test_whatever_a_stranger_sends_is_read_or_refused(value: object) -> None:
    with suppress(ValueError):
        assert abs(from_json(Shape, value).size.width) <= MAX_SIZE


GOOD: Mapping[str, object] = {"colour": "red", "width": 1}
POINT: Mapping[str, object] = {"level": "low"}


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"colour": "green"}, "colour: none of red, blue: green"),
        ({"colour": None}, "colour: none of red, blue: None"),
        ({"width": MAX_SIZE + 1}, "size: width: 1001 is out of range"),
        ({"width": True}, "size: width: not a whole number: True"),
        ({"speed": "fast"}, "speed: not a number: fast"),
        ({"open": 1}, "open: not a bool: 1"),
        ({"points": []}, "points: not an object"),
        ({"points": {"a": {}}}, "points: level is missing"),
        ({"tags": "a"}, "tags: not a list"),
        ({"inner": {}}, "inner: colour is missing"),
        ({"kind": "tall"}, "kind: none of round, flat: tall"),
        ({"turns": [[1]]}, "turns: not a list of 2"),
    ],
)
def test_what_does_not_fit_is_named(entries: Mapping[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        from_json(Shape, {**GOOD, **entries})


@given(st.dictionaries(TEXTS, st.floats(0, 1)), TEXTS)
@example(dict.fromkeys(["\udce9", "\udcea"], 0.0), "")
@example({"a\udce9": 0.0}, "r\udce9gles")
def test_every_text_of_a_stranger_can_be_written_in_utf_8(weights: dict[str, float], name: str) -> None:
    sent = {**GOOD, "weights": weights, "tags": [name], "row": [[name, "low", 1]], "points": {name: POINT}}
    if len({in_utf_8(key) for key in weights}) < len(weights):
        with pytest.raises(ValueError, match="weights: two keys"):
            from_json(Shape, sent)
        return
    read = from_json(Shape, sent)
    assert read.weights.keys() == {in_utf_8(key) for key in weights}
    assert [one.name for one in (*read.row, *read.points)] == [in_utf_8(name)] * 2
    assert read.tags == {in_utf_8(name)}


def test_what_is_not_understood_is_left_out_where_that_is_lenient() -> None:
    read = from_json(
        Shape, {**GOOD, "row": [["a", "low", "?"], ["b", "no level", 1], 7, ["c", "high", 2, 3]]}
    )
    assert read.row == (Point(name="a", level=Level.LOW), Point(name="c", level=Level.HIGH, height=2))


def test_inputs_of_an_older_version_are_read_and_written_alike() -> None:
    lines = (OLDER / "inputs-a58dded.jsonl").read_text("utf-8").splitlines()
    read = [input_from_json(json.loads(line)) for line in lines]
    assert [input_to_json(one) for one in read] == [json.loads(line) for line in lines]
    changes = [one.change for one in read if isinstance(one, ChangeInput)]
    assert changes == [
        SourceChanged(topic="/odom", publishers=1, transient_local=False, type_name="nav_msgs/msg/Odometry"),
        ListenersChanged(topic="/odom", are_there=True),
        LinkBudget(link_kb_per_s=120.25, is_measured=True),
        LinkBudget(link_kb_per_s=50.0),
        ReceiversReckon(topics=frozenset({"/odom", "/tf"})),
    ]
    first, *_, last = read
    assert isinstance(first, RuleTextsInput)
    assert (first.budget_kb_per_s, list(first.rule_texts)) == (64.5, ["warehouse.adirf"])
    assert isinstance(last, RuleTextsInput)
    assert last.relay_all == ("/odom", "/scan")
    assert [(one.topic, one.publisher) for one in read if isinstance(one, MessageInput)] == [
        ("/odom", 3),
        ("/scan", None),
    ]
    assert [one.stamp_ns for one in read if isinstance(one, WakeInput)] == [T_NS + 8]


def test_decisions_of_an_older_version_are_read_and_written_alike() -> None:
    path = OLDER / "decisions-a58dded.jsonl"
    first, second, end = read = read_decisions(path)
    assert [one.to_json() for one in read] == [
        json.loads(line) for line in path.read_text("utf-8").splitlines()
    ]
    assert first.from_rate is None
    assert first.planned == PlannedRate(
        rate=Rate.full(),
        reason=Reason.DEFAULT,
        within={"position": 0.05},
        bound_reasons={"position": BoundReason(reason=Reason.BLOCK, rule="Dock", line=4)},
    )
    assert (second.from_rate, second.from_within) == (Rate.full(), {"position": 0.05})
    assert second.values == {"/odom pose_y": 5.25, "/scan nearest": None}
    assert (end.is_end, end.planned.rate) == (True, Rate(0.0))
    assert isinstance(end, Decision)


def test_an_incident_of_an_older_version_is_read_and_written_alike() -> None:
    path = OLDER / "incident-a58dded.json"
    incident = read_incident(path.read_bytes(), str(path))
    assert incident_to_json(incident) == json.loads(path.read_text("utf-8"))
    assert incident == IncidentRecord(
        name="near_miss",
        rule="Too close",
        path="rules/warehouse.adirf",
        line=12,
        triggered_ns=T_NS + 5,
        from_ns=T_NS,
        to_ns=T_NS + 9,
        values={"/scan nearest": 0.31, "/odom pose_y": None},
        rules_sha256="ab" * 32,
        topics={
            "/scan": IncidentTopic(type_name="sensor_msgs/msg/LaserScan", messages=150, size_bytes=450_000)
        },
        latched=(LatchedSample(topic="/map", stamp_ns=T_NS - 10**9),),
        missing=(
            Missing(topic="/imu", reason=MissingReason.MEMORY, messages=None, from_ns=T_NS, to_ns=T_NS + 3),
            Missing(topic="/odom", reason=MissingReason.LOST, messages=4, from_ns=T_NS, to_ns=T_NS + 9),
        ),
    )

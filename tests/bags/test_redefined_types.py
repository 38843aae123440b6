# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that define types of ROS 2 otherwise: what they lack is unknown, and no command fails."""

from __future__ import annotations

import dataclasses
import math
import random
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype

from bags.bag_factory import ODOM, START_NS, TYPES, message_of, odometry
from smarttestudo.api import measure_bag, read_rules, replay
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.readable_types import empty_store, types_within
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.robot_path import places_in
from smarttestudo.bags.statistics import Latency
from smarttestudo.bags.writer import create_recording
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel
from smarttestudo.language.properties import (
    accuracy_properties_of,
    known_types,
    properties_for_bounds,
    properties_of,
)
from smarttestudo.pacing.cdr import STREAM_TYPES

KNOWN = sorted({*known_types(), *properties_for_bounds(), *STREAM_TYPES})
OTHER = "p/msg/Other"
NUMBERS = [math.nan, math.inf, -math.inf, 1e200, -1e308, 1.7976931348623157e308, 5e-324]
LEAST_AND_GREATEST = {
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    "byte": (0, 127),
    "char": (0, 127),
}


def of_base(name: str) -> Any:
    return Nodetype.BASE, (name, 0)


FIELDS: list[Any] = [
    *map(of_base, ("string", "int8", "uint64", "bool", "float32")),
    (Nodetype.SEQUENCE, (of_base("float64"), 0)),
    (Nodetype.ARRAY, (of_base("float64"), 1)),
    (Nodetype.SEQUENCE, (of_base("string"), 0)),
    (Nodetype.NAME, OTHER),
    (Nodetype.SEQUENCE, ((Nodetype.NAME, OTHER), 0)),
]


class Redefined:
    """A type of ROS 2 with fields, also deep within, left out, renamed, retyped or in another order."""

    def __init__(self, type_name: str, chance: random.Random) -> None:
        self.type_name = type_name
        self._chance = chance
        types: Any = {
            name: ([], list(fields)) for name, (_, fields) in types_within(TYPES.fielddefs, type_name).items()
        }
        for _ in range(chance.randint(1, 3)):
            self._change(chance.choice([fields for _, fields in types.values() if fields]))
        types[OTHER] = [], [("nothing", of_base("int8"))]
        self._store = empty_store()
        self._store.register(types)
        self.definition, _ = self._store.generate_msgdef(type_name, ros_version=2)

    def _change(self, fields: list[Any]) -> None:
        at, other = self._chance.randrange(len(fields)), self._chance.choice(FIELDS)
        match self._chance.choice(["drop", "rename", "retype", "swap", "add"]):
            case "drop" if len(fields) > 1:
                del fields[at]
            case "rename":
                fields[at] = f"{fields[at][0]}_2", fields[at][1]
            case "swap":
                self._chance.shuffle(fields)
            case "add":
                fields.insert(at, (f"added_{self._chance.randrange(10**9)}", other))
            case _:
                fields[at] = fields[at][0], other

    def payload(self) -> bytes:
        return bytes(self._store.serialize_cdr(self._value((Nodetype.NAME, self.type_name)), self.type_name))

    def _value(self, desc: Any) -> Any:
        node, of = desc
        if node == Nodetype.NAME:
            fields = {name: self._value(inner) for name, inner in self._store.fielddefs[of][1]}
            return self._store.types[of](**fields)
        if node == Nodetype.BASE:
            return self._number_or_text(of[0])
        inner, length = of
        count = length if node == Nodetype.ARRAY else self._chance.choice([0, 1, 2])
        values = [self._value(inner) for _ in range(count)]
        if inner[0] == Nodetype.BASE and inner[1][0] != "string":
            return np.array(values, dtype={"byte": "uint8", "char": "uint8"}.get(inner[1][0], inner[1][0]))
        return values

    def _number_or_text(self, base: str) -> Any:
        is_odd = self._chance.random() < 0.2
        if base == "string":
            return self._chance.choice(["", "map", "base_link", "a"])
        if base == "bool":
            return is_odd
        if base.startswith("float"):
            number = self._chance.choice(NUMBERS) if is_odd else self._chance.uniform(-3, 3)
            return number if base == "float64" or not 1e38 < abs(number) < math.inf else math.inf
        return self._chance.choice(LEAST_AND_GREATEST[base]) if is_odd else self._chance.randrange(100)


def write(path: Path, redefined: Redefined, *, last_ns: int = START_NS + 10**9) -> None:
    channel = Channel(topic="/x", type_name=redefined.type_name, definition=redefined.definition)
    with create_recording(path) as writer:
        for at in range(10):
            writer.write(channel, START_NS + at * 10**8, redefined.payload())
        writer.write(channel, last_ns, redefined.payload())


def write_rules(folder: Path, type_name: str) -> tuple[Path, Path]:
    checks, bounds = folder / "checks.adirf", folder / "bounds.adirf"
    rules = (
        f'Rule "{name}" If CheckValue /x {name} > 0.5 Then SetFrequency /x Full EndIf'
        for name in ("rate", *properties_of(type_name))
    )
    checks.write_text("\n".join(("begin", "SetFrequency /x 2", *rules, "end")))
    keep = (f"KeepWithin /x {name} 0.2" for name in accuracy_properties_of(type_name))
    bounds.write_text("\n".join(("begin", "SetFrequency /x Full", *keep, "end")))
    return checks, bounds


@pytest.mark.full
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("type_name", KNOWN)
def test_no_command_fails_on_a_type_that_is_not_what_its_name_says(
    type_name: str, seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sent, seen, bound = (tmp_path / name for name in ("sent", "seen", "bound"))
    last_ns = 2**63 - 1 if seed == 3 else START_NS + 10**9
    write(sent, Redefined(type_name, random.Random(f"{type_name} {seed}")), last_ns=last_ns)
    checks, bounds = write_rules(tmp_path, type_name)
    for command in (
        f"bag info {sent}",
        f"bag rates {sent} --latency",
        f"bag loss {sent}",
        f"bag accuracy {sent} --rules {bounds}",
        f"bag report {sent} -o {tmp_path / 'sent.html'}",
        f"profile --bag {sent} --from-curve",
        f"replay {sent} --rules {checks} --output {seen}",
        f"replay {sent} --rules {bounds} --output {bound}",
        f"bag loss {sent} {seen}",
        f"bag report {sent} {bound} --rules {bounds} -o {tmp_path / 'bound.html'}",
        f"check --bag {sent} {checks}",
    ):
        main(command.split())
        assert "Traceback" not in capsys.readouterr().err, command


@pytest.mark.parametrize("type_name", KNOWN)
def test_a_place_is_finite_or_not_known(type_name: str, tmp_path: Path) -> None:
    for seed in range(5):
        redefined = Redefined(type_name, random.Random(seed))
        write(tmp_path / f"bag{seed}", redefined)
        with open_recording(tmp_path / f"bag{seed}") as recording:
            places = places_in(recording.channels, RosbagDecoder(), recording.start_ns, by_transforms=False)
            if places is None:
                continue
            for message in recording.messages():
                with suppress(RecordingError):
                    places.on_message(*message)
            assert all(math.isfinite(number) for one in places.path for number in (one.x_m, one.y_m))


@pytest.mark.full
@pytest.mark.parametrize("numbers", [*([number] for number in NUMBERS), [1e308, -1e308], [1e99], [-1e101]])
def test_no_command_fails_on_a_place_that_is_no_measurement(
    numbers: list[float], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / "bag"
    with create_recording(bag) as writer:
        channel = Channel(topic="/x", type_name=ODOM.type_name)
        for at in range(20):
            x = numbers[at - 9] if 0 <= at - 9 < len(numbers) else at / 10
            writer.write(channel, START_NS + at * 10**8, odometry(x, 0.0))
    _, bounds = write_rules(tmp_path, ODOM.type_name)
    for command in (
        f"bag loss {bag}",
        f"bag loss {bag} --json",
        f"bag loss {bag} {bag}",
        f"bag accuracy {bag} --rules {bounds}",
        f"bag report {bag} -o {tmp_path / 'one.html'}",
        f"bag report {bag} {bag} -o {tmp_path / 'two.html'}",
        f"profile --bag {bag} --from-curve",
    ):
        assert main(command.split()) == 0
        assert "Traceback" not in capsys.readouterr().err, command


def write_with_first_fields(path: Path, type_name: str, fields: list[Any], message: Any) -> None:
    """A bag of twenty messages at 10 Hz, of a type that begins with ``fields``, which are zero."""
    types: Any = {**types_within(TYPES.fielddefs, ODOM.type_name)}
    types[type_name] = [], [*fields, *types[type_name][1]]
    store = empty_store()
    store.register(types)
    definition, _ = store.generate_msgdef(ODOM.type_name, ros_version=2)
    with create_recording(path) as writer:
        channel = Channel(topic="/x", type_name=ODOM.type_name, definition=definition)
        for at in range(20):
            payload = bytes(store.serialize_cdr(message(store.types, at), ODOM.type_name))
            writer.write(channel, START_NS + at * 10**8, payload)


def made(types: Any, type_name: str, **values: Any) -> Any:
    """A message of a redefined type whose other fields are those of the type of ROS 2, or zero."""
    kind = types[type_name]
    plain = message_of(type_name)
    names = [field.name for field in dataclasses.fields(kind) if not field.name.startswith("_")]
    return kind(**{name: values.get(name, getattr(plain, name, 0)) for name in names})


def moving(types: Any, at: int) -> Any:
    odom = made(types, ODOM.type_name)
    odom.pose.pose.position.x = at / 20
    return odom


@pytest.mark.parametrize(
    ("name", "least", "most", "notices"),
    [
        ("position", 20, 20, ("/x: 20 messages could not be compared with the receiver's picture",)),
        ("pose_x", 4, 6, ()),
    ],
)
def test_a_bound_reads_no_bytes_of_a_type_that_has_other_fields(
    name: str, least: int, most: int, notices: tuple[str, ...], tmp_path: Path
) -> None:
    write_with_first_fields(tmp_path / "bag", ODOM.type_name, [("first", of_base("float64"))], moving)
    rules = tmp_path / "r.adirf"
    rules.write_text(f"begin SetFrequency /x Full KeepWithin /x {name} 0.2 end")
    outcome = replay(tmp_path / "bag", read_rules(rules), tmp_path / "seen")
    assert least <= outcome.topics["/x"].messages_out <= most
    assert len(outcome.notices) == len(notices)
    assert all(notice.startswith(start) for notice, start in zip(outcome.notices, notices, strict=True))


def test_a_header_that_is_not_that_of_ros_2_has_no_latency(tmp_path: Path) -> None:
    def stamped(types: Any, at: int) -> Any:
        odom = made(types, ODOM.type_name)
        odom.header = made(types, "std_msgs/msg/Header", seq=at)
        return odom

    write_with_first_fields(tmp_path / "bag", "std_msgs/msg/Header", [("seq", of_base("uint32"))], stamped)
    (topic,) = measure_bag(tmp_path / "bag", latency=True).topics
    assert topic.latency == Latency()

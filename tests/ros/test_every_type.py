# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A field means the same to rules on a robot and on a recording, whatever its type."""

from __future__ import annotations

import importlib.util
import math
import struct
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.recording import Channel
from smarttestudo.language.properties import part_reader, value_reader
from smarttestudo.robot.ros.message_types import decoded, is_installed, message_definition, message_type

pytestmark = [pytest.mark.contract, pytest.mark.usefixtures("test_msgs")]

SUFFIXES = {
    "msg": [""],
    "srv": ["_Request", "_Response", "_Event"],
    "action": ["_Goal", "_Result", "_Feedback", "_FeedbackMessage", "_SendGoal_Request", "_GetResult_Event"],
}


def types_of_test_msgs() -> list[str]:
    spec = importlib.util.find_spec("test_msgs")
    folders = [] if spec is None else spec.submodule_search_locations or []
    return [
        f"test_msgs/{kind}/{_in_camel_case(module.stem)}{suffix}"
        for kind, suffixes in SUFFIXES.items()
        for folder in folders
        for module in sorted(Path(folder, kind).glob("_[a-z]*.py"))
        for suffix in suffixes
    ]


def _in_camel_case(module: str) -> str:
    return {"_w_strings": "WStrings"}.get(module, module.title().replace("_", ""))


TYPES = [name for name in types_of_test_msgs() if is_installed(name)]
LETTERS = "az AZ09_-/\n\t'\"\\éß€ÿ漢\ud7ff\ue000\uffff𝄞\U0010ffff"


def integer(least: int, most: int) -> Callable[[Random], int]:
    return lambda rng: rng.choice([least, most, least + 1, most - 1, 0, rng.randint(least, most)])


def number_of_bytes(letter: str) -> Callable[[Random], float]:
    """Any float, infinite ones and NaN included."""
    special = [0.0, -0.0, 1.5, math.inf, -math.inf, math.nan]
    return lambda rng: rng.choice(
        [*special, *struct.unpack(f"<{letter}", rng.randbytes(struct.calcsize(letter)))]
    )


NUMBERS: Mapping[str, Callable[[Random], Any]] = {
    "boolean": lambda rng: rng.random() < 0.5,
    "octet": lambda rng: bytes([rng.choice([0, 127, 128, 255, rng.randrange(256)])]),
    "char": integer(0, 255),
    "float": number_of_bytes("f"),
    "double": number_of_bytes("d"),
    **{f"int{bits}": integer(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": integer(0, 2**bits - 1) for bits in (8, 16, 32, 64)},
}


def value_of(kind: Any, rng: Random) -> Any:
    """A value of a field of the type that rosidl's parser calls so."""
    length = getattr(kind, "size", None)
    if hasattr(kind, "value_type"):
        count = rng.randint(0, min(getattr(kind, "maximum_size", 3), 3)) if length is None else length
        return [value_of(kind.value_type, rng) for _ in range(count)]
    if hasattr(kind, "namespaces"):
        return message_of(message_type("/".join((*kind.namespaces, kind.name)), "/topic"), rng)
    if hasattr(kind, "typename"):
        return NUMBERS[kind.typename](rng)
    return "".join(rng.choices(LETTERS, k=rng.randint(0, 5)))


def message_of(kind: Any, rng: Random) -> Any:
    """A message of a class of rclpy's."""
    names = kind.get_fields_and_field_types()
    return kind(**{name: value_of(one, rng) for name, one in zip(names, kind.SLOT_TYPES, strict=True)})


def paths_in(value: Any, prefix: str = "") -> Iterator[str]:
    """The path of each number and text within a message of rclpy's."""
    fields = getattr(value, "get_fields_and_field_types", None)
    if fields is not None:
        for name in fields():
            yield from paths_in(getattr(value, name), f"{prefix}.{name}" if prefix else name)
    elif isinstance(value, Collection) and not isinstance(value, str | bytes):
        for index in range(len(value) + 1):
            yield from paths_in(list(value)[index] if index < len(value) else None, f"{prefix}[{index}]")
    else:
        yield prefix


@pytest.mark.parametrize("type_name", TYPES or ["test_msgs/msg/BasicTypes"])
@settings(max_examples=20, phases=[Phase.generate])
@given(seed=st.integers(0, 2**32))
def test_a_field_is_the_same_live_in_a_recording_and_to_rclpy(type_name: str, seed: int) -> None:
    # Some messages have more numbers than Hypothesis draws.
    kind = message_type(type_name, "/topic")
    payload = serialize_message(message_of(kind, Random(seed)))
    live, of_rclpy = decoded("/topic", type_name, payload), deserialize_message(payload, kind)
    channel = Channel(topic="/topic", type_name=type_name, definition=message_definition(type_name))
    recorded = RosbagDecoder().decode(channel, payload)
    messages = (live, recorded, of_rclpy)
    for path in paths_in(of_rclpy):
        one, other, another = (value_reader(type_name, path)(message) for message in messages)
        assert one == other == another or all(map(math.isnan, (one, other, another))), path
        texts = [part_reader(path)(message) for message in messages]
        assert len({isinstance(text, str) for text in texts}) == 1
        assert not isinstance(texts[0], str) or texts[0] == texts[1] == texts[2]


@pytest.mark.parametrize("type_name", TYPES or ["test_msgs/msg/BasicTypes"])
@settings(max_examples=20, phases=[Phase.generate])
@given(seed=st.integers(0, 2**32), is_cut=st.booleans())
def test_a_message_that_is_damaged_is_decoded_or_refused_and_nothing_else(
    type_name: str, seed: int, is_cut: bool
) -> None:
    rng = Random(seed)
    payload = bytearray(serialize_message(message_of(message_type(type_name, "/topic"), rng)))
    if is_cut:
        del payload[rng.randrange(len(payload)) :]
    else:
        for _ in range(rng.randint(1, 4)):
            payload[rng.randrange(len(payload))] = rng.randrange(256)
    try:
        message = decoded("/topic", type_name, bytes(payload))
    except RosError:
        return
    for path in paths_in(message):
        part_reader(path)(message)


def test_there_are_types_of_every_kind() -> None:
    assert {name.split("/")[1] for name in TYPES} == set(SUFFIXES)

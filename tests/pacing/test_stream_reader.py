# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reading many messages is reading each of them."""

from __future__ import annotations

import random
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from pacing.scenarios import seeds
from smarttestudo.pacing.cdr import STREAM_TYPES, FrameReader, StreamReader
from smarttestudo.pacing.cdr_walk import MAX_ITEMS

names = st.sampled_from(["", "odom", "base", "wheel", "base_link", "camera_rgb_frame"])
words = st.integers(0, 2**32 - 1)


def tf_message(frames: list[tuple[str, str]], word: int, *, little_endian: bool) -> bytes:
    """Transforms whose stamps, numbers and padding are all made of ``word``."""
    order = "<" if little_endian else ">"
    data = bytearray(struct.pack(f"{order}I", len(frames)))

    def pad_to(size: int) -> None:
        data.extend(struct.pack("<I", word)[:1] * (-len(data) % size))

    for parent, child in frames:
        pad_to(4)
        data.extend(struct.pack(f"{order}II", word, word))
        for name in (parent, child):
            pad_to(4)
            text = name.encode() + b"\x00"
            data.extend(struct.pack(f"{order}I", len(text)) + text)
        pad_to(8)
        data.extend(struct.pack(f"{order}I", word) * 14)
    return (b"\x00\x01" if little_endian else b"\x00\x00") + b"\x00\x00" + bytes(data)


messages = st.builds(
    lambda frames, word, little_endian: tf_message(frames, word, little_endian=little_endian),
    st.lists(st.tuples(names, names), max_size=3),
    words,
    st.booleans(),
)
payloads = st.one_of(
    messages,
    st.binary(max_size=40),
    st.builds(lambda message, cut: message[:cut], messages, st.integers(0, 200)),
)


@given(st.lists(payloads, max_size=30))
def test_a_reader_gives_for_each_message_what_reading_it_alone_gives(sequence: list[bytes]) -> None:
    reader = FrameReader()
    assert [reader.streams(payload) for payload in sequence] == [
        FrameReader().streams(payload) for payload in sequence
    ]


@given(st.lists(st.tuples(names, names), min_size=1, max_size=3), st.lists(words, max_size=5))
def test_frames_are_read_whatever_stamps_and_transforms_are(
    frames: list[tuple[str, str]], seen: list[int]
) -> None:
    reader = FrameReader()
    expected = tuple(dict.fromkeys(child for _, child in frames))
    for word in seen:
        assert reader.streams(tf_message(frames, word, little_endian=True)) == expected


STORES = {version: get_typestore(version) for version in (Stores.ROS2_FOXY, Stores.ROS2_JAZZY)}
texts = st.text(st.characters(exclude_characters="\x00", exclude_categories=["Cs"]), max_size=12)


class Written:
    """Messages of the types that name streams, as a serializer writes them, each with its streams."""

    def __init__(
        self, version: Stores, chance: random.Random, names: list[str], actions: Sequence[int] = (0,)
    ) -> None:
        self._store = STORES[version]
        self._chance = chance
        self._names = names
        self.actions = actions
        self.deletion = 0

    def __call__(self, kind: str) -> tuple[str, bytes, tuple[str, ...]]:
        type_name, message, streams = getattr(self, kind)()
        little_endian = self._chance.random() < 0.5
        payload = self._store.serialize_cdr(message, type_name, little_endian=little_endian)
        return type_name, bytes(payload), streams

    def transforms(self) -> tuple[str, object, tuple[str, ...]]:
        pairs = [(self._text(), name) for name in self._names]
        vector, turn = self._make("geometry_msgs", "Vector3", 3), self._make("geometry_msgs", "Quaternion", 4)
        transform = self._type("geometry_msgs/msg/Transform")(translation=vector, rotation=turn)
        stamped = self._type("geometry_msgs/msg/TransformStamped")
        message = self._type("tf2_msgs/msg/TFMessage")(
            transforms=[
                stamped(header=self._header(parent), child_frame_id=child, transform=transform)
                for parent, child in pairs
            ]
        )
        return "tf2_msgs/msg/TFMessage", message, tuple(dict.fromkeys(self._names))

    def statuses(self) -> tuple[str, object, tuple[str, ...]]:
        status, pair = (
            self._type(f"diagnostic_msgs/msg/{name}") for name in ("DiagnosticStatus", "KeyValue")
        )
        message = self._type("diagnostic_msgs/msg/DiagnosticArray")(
            header=self._header(self._text()),
            status=[
                status(
                    level=self._chance.randrange(4),
                    name=name,
                    message=self._text(),
                    hardware_id=self._text(),
                    values=[pair(key=self._text(), value=self._text()) for _ in self._few()],
                )
                for name in self._names
            ],
        )
        return "diagnostic_msgs/msg/DiagnosticArray", message, tuple(dict.fromkeys(self._names))

    def joints(self) -> tuple[str, object, tuple[str, ...]]:
        numbers = [np.array([self._chance.random() for _ in self._few()]) for _ in range(3)]
        names = self._chance.sample(self._names, len(self._names))
        message = self._type("sensor_msgs/msg/JointState")(self._header(self._text()), names, *numbers)
        streams = ("\0".join(sorted(set(names))),) if names else ()
        return "sensor_msgs/msg/JointState", message, streams

    def markers(self) -> tuple[str, object, tuple[str, ...]]:
        made = [(name, self._chance.randint(-(2**31), 2**31 - 1)) for name in self._names]
        array = self._type("visualization_msgs/msg/MarkerArray")
        message = array(markers=[self._marker(name, number) for name, number in made])
        streams = dict.fromkeys(f"{name}/{number}" for name, number in made)
        return "visualization_msgs/msg/MarkerArray", message, tuple(streams)

    def marker(self) -> tuple[str, object, tuple[str, ...]]:
        number = self._chance.randint(-(2**31), 2**31 - 1)
        name = self._names[0] if self._names else ""
        return "visualization_msgs/msg/Marker", self._marker(name, number), (f"{name}/{number}",)

    def _marker(self, namespace: str, number: int) -> object:
        marker = self._type("visualization_msgs/msg/Marker")
        fields = {
            "header": self._header(self._text()),
            "ns": namespace,
            "id": number,
            "pose": self._type("geometry_msgs/msg/Pose")(
                position=self._make("geometry_msgs", "Point", 3),
                orientation=self._make("geometry_msgs", "Quaternion", 4),
            ),
            "scale": self._make("geometry_msgs", "Vector3", 3),
            "color": self._make("std_msgs", "ColorRGBA", 4),
            "lifetime": self._type("builtin_interfaces/msg/Duration")(sec=1, nanosec=2),
            "points": [self._make("geometry_msgs", "Point", 3) for _ in self._few()],
            "colors": [self._make("std_msgs", "ColorRGBA", 4) for _ in self._few()],
        }
        if "texture" in marker.__dataclass_fields__:
            image, mesh = self._type("sensor_msgs/msg/CompressedImage"), "visualization_msgs/msg/MeshFile"
            data = np.frombuffer(self._chance.randbytes(len(self._few())), np.uint8)
            fields["texture"] = image(header=self._header("t"), format=self._text(), data=data)
            fields["mesh_file"] = self._type(mesh)(filename=self._text(), data=data)
            uv = [self._type("visualization_msgs/msg/UVCoordinate")(u=1.0, v=2.0) for _ in self._few()]
            fields["uv_coordinates"] = uv
            fields["texture_resource"] = self._text()
        fields |= {"text": self._text(), "mesh_resource": self._text()}
        fields["action"] = self._chance.choice(self.actions)
        self.deletion = max(self.deletion, *(action for action in (0, 2, 3) if action <= fields["action"]))
        others = {name: 0 for name in marker.__dataclass_fields__ if name not in fields}
        others.pop("__msgtype__", None)
        return marker(
            **{k: v for k, v in (others | fields).items() if not k.isupper() and k != "__msgtype__"}
        )

    def _type(self, name: str) -> Any:
        return self._store.types[name]

    def _make(self, package: str, name: str, count: int) -> Any:
        return self._type(f"{package}/msg/{name}")(*(self._chance.random() for _ in range(count)))

    def _header(self, frame: str) -> Any:
        seconds = self._chance.randrange(2**31)
        stamp = self._type("builtin_interfaces/msg/Time")(sec=seconds, nanosec=seconds % 10**9)
        return self._type("std_msgs/msg/Header")(stamp=stamp, frame_id=frame)

    def _text(self) -> str:
        return self._chance.choice(["", "base", "wheel left", "ünit", *self._names])

    def _few(self) -> range:
        return range(self._chance.randrange(4))


KINDS = ("transforms", "statuses", "joints", "marker", "markers")
kinds = st.sampled_from(KINDS)
versions = st.sampled_from(tuple(STORES))


@given(versions, kinds, st.lists(st.lists(texts, max_size=4), min_size=1, max_size=8), seeds)
def test_the_streams_of_each_type_are_those_that_were_serialized(
    version: Stores, kind: str, sequence: list[list[str]], seed: int
) -> None:
    chance, reader = random.Random(seed), None
    for names in [*sequence, *sequence]:
        type_name, payload, streams = Written(version, chance, names)(kind)
        reader = reader or StreamReader(type_name)
        assert reader.streams(payload) == streams
        assert reader.streams(memoryview(payload)) == streams


@given(
    versions,
    st.sampled_from(["marker", "markers"]),
    st.lists(st.sampled_from([(0,), (0, 2), (0, 2, 3)])),
    seeds,
)
def test_what_deletes_markers_is_seen_in_messages_that_are_alike_but_for_that(
    version: Stores, kind: str, sequence: list[tuple[int, ...]], seed: int
) -> None:
    reader = None
    for actions in sequence:
        written = Written(version, random.Random(seed), ["a", "b", "c"], actions)
        type_name, payload, _ = written(kind)
        reader = reader or StreamReader(type_name)
        assert reader.streams_and_deletion(payload) == (reader.streams(payload), written.deletion)


@given(versions, kinds, st.lists(texts, min_size=1, max_size=4), seeds, st.data())
def test_a_cut_message_has_no_streams_and_a_damaged_one_costs_nothing_but_its_own(
    version: Stores, kind: str, names: list[str], seed: int, data: st.DataObject
) -> None:
    type_name, payload, streams = Written(version, random.Random(seed), names)(kind)
    reader = StreamReader(type_name)
    assert reader.streams(payload[: data.draw(st.integers(0, len(payload) - 4))]) == ()
    at = data.draw(st.integers(0, len(payload) - 1))
    damaged = payload[:at] + data.draw(st.binary(min_size=1, max_size=8)) + payload[at:]
    assert all(len(name) <= len(payload) + 12 for name in reader.streams(damaged))
    assert isinstance(reader.streams(data.draw(st.binary(max_size=300))), tuple)
    assert reader.streams_and_deletion(data.draw(st.binary(max_size=300)))[1] in (0, 2, 3)
    assert reader.streams(payload) == streams


@pytest.mark.parametrize("count", [4000, 9000, 12_000])
@pytest.mark.parametrize("version", tuple(STORES))
def test_of_thousands_of_markers_the_first_decide(version: Stores, count: int) -> None:
    names = [str(number) for number in range(count)]
    written = Written(version, random.Random(0), names, (3,))
    type_name, payload, streams = written("markers")
    found, deletion = StreamReader(type_name).streams_and_deletion(payload)
    assert deletion == 3
    assert len(found) > 3000
    assert found == streams[: len(found)]


def test_a_hostile_message_takes_no_longer_than_its_limit() -> None:
    for type_name in STREAM_TYPES:
        reader = StreamReader(type_name)
        for word in (0, 1, 5, MAX_ITEMS, 2**31, 2**32 - 1):
            reader.streams(b"\x00\x01\x00\x00" + struct.pack("<I", word) * 300_000)
            reader.streams(b"\x00\x01\x00\x00" + bytes(12) + struct.pack("<I", word) + bytes(1_000_000))


def test_a_name_that_would_fill_the_memory_is_told_apart_by_its_digest() -> None:
    long = ["a" * 10_000 + end for end in ("x", "y")]
    payloads = [Written(Stores.ROS2_JAZZY, random.Random(0), [name])("statuses")[1] for name in long]
    reader = StreamReader("diagnostic_msgs/msg/DiagnosticArray")
    one, other = (reader.streams(payload)[0] for payload in payloads)
    assert one != other
    assert len(one) == len(other) <= 255

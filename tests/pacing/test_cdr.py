# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What pacing reads of serialized messages is what a real serializer wrote, and nothing breaks it."""

from __future__ import annotations

import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from smarttestudo.pacing.cdr import FrameReader, header_stamp, string_message, string_text
from smarttestudo.pacing.cdr_walk import MAX_ITEMS

STORE = get_typestore(Stores.ROS2_HUMBLE)
names = st.text(st.characters(exclude_characters="\x00", exclude_categories=["Cs"]), max_size=20)
stamps = st.tuples(st.integers(-(2**31), 2**31 - 1), st.integers(0, 999_999_999))
endings = st.booleans()


def header(stamp: tuple[int, int], frame: str) -> Any:
    time = STORE.types["builtin_interfaces/msg/Time"](sec=stamp[0], nanosec=stamp[1])
    return STORE.types["std_msgs/msg/Header"](stamp=time, frame_id=frame)


def transforms(frames: list[tuple[str, str]]) -> object:
    vector = STORE.types["geometry_msgs/msg/Vector3"](x=1.0, y=2.0, z=3.0)
    rotation = STORE.types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    transform = STORE.types["geometry_msgs/msg/Transform"](translation=vector, rotation=rotation)
    stamped = STORE.types["geometry_msgs/msg/TransformStamped"]
    return STORE.types["tf2_msgs/msg/TFMessage"](
        transforms=[
            stamped(header=header((1, 2), parent), child_frame_id=child, transform=transform)
            for parent, child in frames
        ]
    )


def serialized(message: object, type_name: str, *, little_endian: bool) -> bytes:
    return bytes(STORE.serialize_cdr(message, type_name, little_endian=little_endian))


@given(st.lists(st.tuples(names, names), max_size=12), endings)
def test_the_child_frames_are_those_that_were_serialized(
    frames: list[tuple[str, str]], little_endian: bool
) -> None:
    payload = serialized(transforms(frames), "tf2_msgs/msg/TFMessage", little_endian=little_endian)
    expected = tuple(dict.fromkeys(child for _, child in frames))
    assert FrameReader().streams(payload) == FrameReader().streams(memoryview(payload)) == expected


@given(names, endings)
def test_the_text_of_a_string_is_what_was_serialized(text: str, little_endian: bool) -> None:
    message = STORE.types["std_msgs/msg/String"](data=text)
    assert string_text(serialized(message, "std_msgs/msg/String", little_endian=little_endian)) == text
    assert string_text(memoryview(string_message(text))) == text


@given(names, st.integers(0, 90), st.binary(max_size=12))
def test_a_string_that_is_cut_or_whose_bytes_are_not_a_text_is_none(
    text: str, kept: int, rest: bytes
) -> None:
    whole = string_message(text)
    assert string_text(whole[: min(kept, len(whole) - 1)]) is None
    assert string_text(whole[:8] + b"\xff" * (len(whole) - 9) + b"\0") in (None, "")
    string_text(rest)


@given(stamps, names, endings)
def test_equal_stamps_are_equal_bytes_in_either_byte_order(
    stamp: tuple[int, int], frame: str, little_endian: bool
) -> None:
    reference = STORE.types["sensor_msgs/msg/TimeReference"]
    message = reference(header=header(stamp, frame), time_ref=header(stamp, frame).stamp, source="")
    payload = serialized(message, "sensor_msgs/msg/TimeReference", little_endian=little_endian)
    assert header_stamp(payload) == header_stamp(memoryview(payload)) == struct.pack("<iI", *stamp)


@given(st.binary(max_size=300))
def test_random_bytes_give_an_answer(payload: bytes) -> None:
    assert isinstance(FrameReader().streams(payload), tuple)
    assert header_stamp(payload) is None or len(header_stamp(payload) or b"") == 8


@given(st.lists(st.tuples(names, names), min_size=1, max_size=4), endings, st.data())
def test_a_cut_or_damaged_message_gives_an_answer_and_a_cut_one_has_no_frames(
    frames: list[tuple[str, str]], little_endian: bool, data: st.DataObject
) -> None:
    payload = serialized(transforms(frames), "tf2_msgs/msg/TFMessage", little_endian=little_endian)
    assert FrameReader().streams(payload[: data.draw(st.integers(0, len(payload) - 1))]) == ()
    at = data.draw(st.integers(0, len(payload) - 1))
    damaged = payload[:at] + data.draw(st.binary(min_size=1, max_size=8)) + payload[at:]
    assert isinstance(FrameReader().streams(damaged), tuple)


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\x00\x01",
        b"\x00\x01\x00\x00" + b"\x00" * 7,
        b"\x00\x01\x00\x00" + struct.pack("<iI", 1, 1_000_000_000),
        b"\x00\x07\x00\x00" + bytes(8),
    ],
    ids=["empty", "no header", "cut", "not a time", "another encapsulation"],
)
def test_what_cannot_be_a_stamp_is_none(payload: bytes) -> None:
    assert header_stamp(payload) is None


def test_a_count_beyond_reason_is_not_followed() -> None:
    empty = struct.pack("<iIIII", 0, 0, 0, 0, 0) + bytes(60)
    assert (
        FrameReader().streams(b"\x00\x01\x00\x00" + struct.pack("<I", MAX_ITEMS + 1) + empty * 20_000) == ()
    )
    assert FrameReader().streams(b"\x00\x01\x00\x00" + struct.pack("<I", 2**32 - 1)) == ()

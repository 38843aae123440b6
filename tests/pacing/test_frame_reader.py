# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reading many messages is reading each of them."""

from __future__ import annotations

import struct

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.pacing.cdr import FrameReader, child_frames

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
    assert [reader.child_frames(payload) for payload in sequence] == [
        child_frames(payload) for payload in sequence
    ]


@given(st.lists(st.tuples(names, names), min_size=1, max_size=3), st.lists(words, max_size=5))
def test_frames_are_read_whatever_stamps_and_transforms_are(
    frames: list[tuple[str, str]], seen: list[int]
) -> None:
    reader = FrameReader()
    expected = tuple(dict.fromkeys(child for _, child in frames))
    for word in seen:
        assert reader.child_frames(tf_message(frames, word, little_endian=True)) == expected

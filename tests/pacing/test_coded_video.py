# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a message of coded video is to a decoder, read from its first bytes, whatever they are."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacing.bitstreams import (
    H264,
    NAMES,
    STREAMS,
    Stream,
    compressed_image,
    compressed_video,
    ffmpeg_packet,
    theora_packet,
)
from smarttestudo.pacing.coded_video import READ_BYTES, VideoFrame, VideoReader, is_coded_video
from smarttestudo.pacing.sample import StreamKind

VIDEO = "foxglove_msgs/msg/CompressedVideo"
IMAGE = "sensor_msgs/msg/CompressedImage"
PACKET = "ffmpeg_image_transport_msgs/msg/FFMPEGPacket"
THEORA = "theora_image_transport/msg/Packet"
TYPES: dict[str, Callable[..., bytes]] = {
    VIDEO: compressed_video,
    IMAGE: compressed_image,
    PACKET: ffmpeg_packet,
    THEORA: theora_packet,
}
NAMED = [(stream, name) for stream in STREAMS for name in NAMES[stream.coder]]


def read(type_name: str, payload: bytes) -> VideoFrame | None:
    reader = VideoReader.of(type_name)
    assert reader is not None
    return reader.frame(payload)


@pytest.mark.parametrize(("stream", "name"), NAMED)
def test_a_bitstream_says_what_it_is_in_every_type_and_byte_order(stream: Stream, name: str) -> None:
    for make, type_name in ((compressed_video, VIDEO), (compressed_image, IMAGE)):
        for order, frame_id in itertools.product("<>", ("", "a", "camera", "camera_optical_frame")):
            assert read(type_name, make(stream.data, name, order, frame_id)) is stream.frame
            assert read(type_name.replace("/msg/", "/"), make(stream.data, name, order)) is stream.frame


@pytest.mark.parametrize("frame_id", ["", "a", "cam", "camera", "camera_"])
@pytest.mark.parametrize("name", ["h264", "libx264", "libx264rgb", "hevc_nvenc", "mjpeg", ""])
@pytest.mark.parametrize("order", ["<", ">"])
def test_a_packet_of_ffmpeg_says_by_its_flags_whether_it_is_a_key_frame(
    frame_id: str, name: str, order: str
) -> None:
    for flags in (0, 1, 2, 3, 254, 255):
        payload = ffmpeg_packet(b"\xff\xff", name, order, frame_id, flags=flags)
        assert read(PACKET, payload) is (VideoFrame.KEY if flags & 1 else VideoFrame.DIFFERENCE)


def test_a_packet_of_ffmpeg_without_flags_is_what_its_bitstream_says() -> None:
    for stream in H264:
        expected = VideoFrame.DIFFERENCE if stream.frame is VideoFrame.UNKNOWN else stream.frame
        assert read(PACKET, ffmpeg_packet(stream.data, "libx264")) is expected


def test_theora_needs_no_name() -> None:
    for stream in STREAMS:
        if stream.coder == "theora":
            assert read(THEORA, theora_packet(stream.data)) is stream.frame


@pytest.mark.parametrize(
    "name", ["jpeg", "png", "bgr8; jpeg compressed bgr8", "16UC1; compressedDepth png", "rvl", "tiff", ""]
)
def test_an_image_is_no_video_whatever_its_bytes_are(name: str) -> None:
    for stream in STREAMS:
        assert read(IMAGE, compressed_image(stream.data, name)) is None
        assert read(VIDEO, compressed_video(stream.data, name)) is VideoFrame.UNKNOWN


@pytest.mark.parametrize(
    "name",
    [
        "jpeg 1264x800",
        "jpeg;q=265",
        "image/webp; vp8",
        "jpeg; stavcam",
        "bgr8; jpeg 2640x1080",
        "h264-decoded jpeg",
    ],
)
@pytest.mark.parametrize("beginning", [b"\xff\xd8\xff\xe0", b"\x89PNG\r\n", b"RIFF\0\0\0\0WEBPVP8 "])
def test_numbers_in_a_format_make_no_video_of_an_image(name: str, beginning: bytes) -> None:
    assert read(IMAGE, compressed_image(beginning + bytes(100), name)) is None


@pytest.mark.parametrize(
    "name",
    [
        "h264",
        "H.264",
        "H.264/AVC",
        "x264",
        "libx264",
        "h264_nvenc",
        "v4l2h264enc",
        "openh264",
        "avc",
        "avc1.42E01E",
    ],
)
def test_coders_of_h264_are_known_by_their_names(name: str) -> None:
    key = next(one for one in H264 if one.frame is VideoFrame.KEY)
    assert read(VIDEO, compressed_video(key.data, name)) is VideoFrame.KEY


@pytest.mark.parametrize("name", ["jpeg 1264x800", "jpeg; stavcam", "bgr8; jpeg 2640x1080", "800x264"])
def test_a_size_of_an_image_names_no_coder(name: str) -> None:
    key = next(one for one in H264 if one.frame is VideoFrame.KEY)
    assert read(IMAGE, compressed_image(key.data, name)) is None


def test_a_type_is_coded_video_whichever_way_it_is_written() -> None:
    for type_name in (VIDEO, PACKET, THEORA):
        assert is_coded_video(type_name)
        assert is_coded_video(type_name.replace("/msg/", "/"))
        assert StreamKind.of(type_name=type_name, transient_local=False) is StreamKind.CODED_VIDEO
        assert StreamKind.of(type_name=type_name, transient_local=True) is StreamKind.CODED_VIDEO
    assert not is_coded_video(IMAGE)
    for other in ("", "sensor_msgs/msg/Image", "my_msgs/msg/CompressedVideo"):
        assert VideoReader.of(other) is None


@given(st.sampled_from([*TYPES]), st.binary(max_size=300))
def test_no_bytes_are_refused(type_name: str, payload: bytes) -> None:
    assert read(type_name, payload) in (None, *VideoFrame)


@given(st.sampled_from([*TYPES]), st.sampled_from(NAMED), st.data())
def test_no_damage_is_refused(type_name: str, named: tuple[Stream, str], data: st.DataObject) -> None:
    stream, name = named
    payload = bytearray(TYPES[type_name](stream.data, name, data.draw(st.sampled_from("<>"))))
    for _ in range(data.draw(st.integers(0, 4))):
        payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(payload)))
    assert read(type_name, bytes(payload)) in (None, *VideoFrame)
    assert read(type_name, bytes(payload[:cut])) in (None, *VideoFrame)


@given(
    st.sampled_from([name for names in NAMES.values() for name in names]),
    st.lists(
        st.sampled_from([b"\0", b"\0\0\1", b"\0\0\0\1", b"\x09", b"\x67", b"\x65", b"\x41", b"\xff"]),
        max_size=60,
    ),
)
def test_no_bitstream_is_refused(name: str, parts: list[bytes]) -> None:
    assert read(VIDEO, compressed_video(b"".join(parts), name)) is not None


@pytest.mark.parametrize("name", [names[0] for names in NAMES.values()])
@pytest.mark.parametrize("unit", [b"\0", b"\0\0\1\x09", b"\0\0\0\x02\x09\xf0", b"\x12\x00", b"\xff"])
def test_of_a_large_message_only_the_beginning_is_read(name: str, unit: bytes) -> None:
    class Counted(bytes):
        taken = 0

        def __getitem__(self, part):  # type: ignore[no-untyped-def]
            taken = super().__getitem__(part)
            Counted.taken += len(taken)
            return taken

    for make, type_name in ((compressed_video, VIDEO), (compressed_image, IMAGE), (ffmpeg_packet, PACKET)):
        Counted.taken = 0
        read(type_name, Counted(make(unit * (4_000_000 // len(unit)), name)))
        assert Counted.taken <= READ_BYTES + 1000

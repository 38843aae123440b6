# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of coded video, built by hand, and what each is to a decoder."""

from __future__ import annotations

import struct
from typing import NamedTuple

from smarttestudo.pacing.coded_video import VideoFrame

CODE = b"\0\0\0\1"
SHORT_CODE = b"\0\0\1"
SPS, PPS = b"\x67\x42\x00\x1e\xab\x40", b"\x68\xce\x3c\x80"
NOTE = b"\x06\x05\xff" + b"encoder" * 90 + b"\x80"
IDR, NON_IDR_P, NON_IDR_I, NON_IDR_I_ALL = b"\x65\x88\x84", b"\x41\x9a\x24", b"\x41\xb8\x10", b"\x41\x88\x10"
DELIMITER = b"\x09\xf0"
SEQUENCE = b"\x0a\x0b\x00\x00\x00\x24\xcf\x7f\x0d\xbf\xff\x30\x08"


class Stream(NamedTuple):
    coder: str
    data: bytes
    frame: VideoFrame


def nal(*units: bytes, code: bytes = CODE) -> bytes:
    return b"".join(code + unit for unit in units)


def lengths(*units: bytes) -> bytes:
    return b"".join(len(unit).to_bytes(4, "big") + unit for unit in units)


def h265(kind: int) -> bytes:
    return bytes([kind << 1, 1]) + b"\xaf\x08"


def obu(kind: int, body: bytes) -> bytes:
    return bytes([kind << 3 | 2, len(body)]) + body


H264 = (
    Stream("h264", nal(IDR), VideoFrame.KEY),
    Stream("h264", nal(SPS, PPS, IDR), VideoFrame.KEY),
    Stream("h264", nal(DELIMITER, SPS, PPS, NOTE, IDR), VideoFrame.KEY),
    Stream("h264", nal(DELIMITER, SPS, PPS, IDR, code=SHORT_CODE), VideoFrame.KEY),
    Stream("h264", b"\0" * 7 + nal(SPS, PPS, IDR), VideoFrame.KEY),
    Stream("h264", lengths(SPS, PPS, IDR), VideoFrame.KEY),
    Stream("h264", lengths(IDR + bytes(0x165 - len(IDR))), VideoFrame.KEY),
    Stream("h264", nal(SPS, PPS, NON_IDR_I), VideoFrame.KEY),
    Stream("h264", nal(SPS, PPS, NON_IDR_I_ALL), VideoFrame.KEY),
    Stream("h264", nal(SPS, PPS, NON_IDR_P), VideoFrame.DIFFERENCE),
    Stream("h264", nal(NON_IDR_P), VideoFrame.DIFFERENCE),
    Stream("h264", nal(NON_IDR_I), VideoFrame.DIFFERENCE),
    Stream("h264", nal(DELIMITER, NOTE, NON_IDR_P), VideoFrame.DIFFERENCE),
    Stream("h264", nal(b"\x01\x9e\x42"), VideoFrame.DIFFERENCE),
    Stream("h264", lengths(NON_IDR_P), VideoFrame.DIFFERENCE),
    Stream("h264", b"", VideoFrame.DIFFERENCE),
    Stream("h264", nal(SPS, PPS), VideoFrame.PARAMETERS),
    Stream("h264", nal(PPS), VideoFrame.PARAMETERS),
    Stream("h264", nal(NOTE), VideoFrame.UNKNOWN),
    Stream("h264", bytes(200), VideoFrame.UNKNOWN),
    Stream("h264", b"\xff" * 200, VideoFrame.UNKNOWN),
)
H265 = (
    *(Stream("h265", nal(h265(kind)), VideoFrame.KEY) for kind in range(16, 22)),
    *(Stream("h265", nal(h265(kind)), VideoFrame.DIFFERENCE) for kind in (0, 1, 6, 7, 8, 9)),
    Stream("h265", nal(h265(32), h265(33), h265(34), h265(39), h265(19)), VideoFrame.KEY),
    Stream("h265", nal(h265(35), h265(39), h265(1)), VideoFrame.DIFFERENCE),
    Stream("h265", nal(h265(32), h265(33), h265(34), h265(1)), VideoFrame.DIFFERENCE),
    Stream("h265", lengths(h265(32), h265(33), h265(34), h265(20)), VideoFrame.KEY),
    Stream("h265", nal(h265(32), h265(33), h265(34)), VideoFrame.PARAMETERS),
    Stream("h265", bytes(200), VideoFrame.UNKNOWN),
)
AV1 = (
    Stream("av1", obu(2, b"") + SEQUENCE + obu(6, b"\x10\x00"), VideoFrame.KEY),
    Stream("av1", obu(2, b"") + SEQUENCE + obu(5, b"\x04") + obu(3, b"\x10\x00"), VideoFrame.KEY),
    Stream("av1", SEQUENCE + b"\x30\x10\x00\x00", VideoFrame.KEY),
    Stream("av1", obu(2, b"") + b"\x36\x08\x02\x10\x00", VideoFrame.KEY),
    Stream("av1", obu(2, b"") + obu(6, b"\x30\x00"), VideoFrame.DIFFERENCE),
    Stream("av1", obu(2, b"") + SEQUENCE + obu(6, b"\x30\x00"), VideoFrame.DIFFERENCE),
    Stream("av1", obu(2, b"") + obu(6, b"\x50\x00"), VideoFrame.DIFFERENCE),
    Stream("av1", obu(2, b"") + obu(3, b"\x80"), VideoFrame.DIFFERENCE),
    Stream("av1", obu(2, b"") + SEQUENCE, VideoFrame.PARAMETERS),
    Stream("av1", b"\xff" * 50, VideoFrame.UNKNOWN),
)
OTHERS = (
    Stream("vp9", b"\x82\x49\x83\x42", VideoFrame.KEY),
    Stream("vp9", b"\xa2\x49\x83\x42", VideoFrame.KEY),
    Stream("vp9", b"\xb1\x24\xc1\xa1", VideoFrame.KEY),
    Stream("vp9", b"\x86\x00", VideoFrame.DIFFERENCE),
    Stream("vp9", b"\x8a\x00", VideoFrame.DIFFERENCE),
    Stream("vp9", b"\xb2\x00", VideoFrame.DIFFERENCE),
    Stream("vp9", b"\x00\x00", VideoFrame.UNKNOWN),
    Stream("vp8", b"\x10\x02\x00\x9d\x01\x2a", VideoFrame.KEY),
    Stream("vp8", b"\x31\x02\x00", VideoFrame.DIFFERENCE),
    Stream("theora", b"\x80theora", VideoFrame.PARAMETERS),
    Stream("theora", b"\x30\x00", VideoFrame.KEY),
    Stream("theora", b"\x70\x00", VideoFrame.DIFFERENCE),
    Stream("mpeg4", b"\0\0\1\xb6\x10", VideoFrame.UNKNOWN),
)
STREAMS = (*H264, *H265, *AV1, *OTHERS)
NAMES = {
    "h264": ("h264", "H.264", "libx264", "h264_nvenc", "avc1", "bgr8; h264 compressed yuv420p"),
    "h265": ("h265", "HEVC", "hevc_vaapi", "libx265", "hvc1"),
    "av1": ("av1", "libaom-av1", "libsvtav1", "av01"),
    "vp9": ("vp9", "libvpx-vp9"),
    "vp8": ("vp8",),
    "theora": ("theora",),
    "mpeg4": ("mpeg4",),
}


class _Cdr:
    def __init__(self, order: str) -> None:
        self._order = order
        self.data = bytearray(b"\0\1\0\0" if order == "<" else b"\0\0\0\0")

    def put(self, code: str, number: int) -> None:
        self.data += bytes((4 - len(self.data)) % struct.calcsize(code))
        self.data += struct.pack(self._order + code, number)

    def put_bytes(self, data: bytes) -> None:
        self.put("I", len(data))
        self.data += data

    def put_text(self, text: str) -> None:
        self.put_bytes(text.encode() + b"\0")


def _stamped(order: str, frame_id: str, stamp_ns: int = 0) -> _Cdr:
    cdr = _Cdr(order)
    cdr.put("i", stamp_ns // 10**9)
    cdr.put("I", stamp_ns % 10**9)
    cdr.put_text(frame_id)
    return cdr


def compressed_video(
    data: bytes, name: str, order: str = "<", frame_id: str = "cam", stamp_ns: int = 0
) -> bytes:
    cdr = _stamped(order, frame_id, stamp_ns)
    cdr.put_bytes(data)
    cdr.put_text(name)
    return bytes(cdr.data)


def compressed_image(
    data: bytes, name: str, order: str = "<", frame_id: str = "cam", stamp_ns: int = 0
) -> bytes:
    cdr = _stamped(order, frame_id, stamp_ns)
    cdr.put_text(name)
    cdr.put_bytes(data)
    return bytes(cdr.data)


def ffmpeg_packet(
    data: bytes, name: str, order: str = "<", frame_id: str = "cam", *, flags: int = 0, stamp_ns: int = 0
) -> bytes:
    cdr = _stamped(order, frame_id, stamp_ns)
    cdr.put("i", 640)
    cdr.put("i", 480)
    cdr.put_text(name)
    cdr.put("Q", 1)
    cdr.put("B", flags)
    cdr.put("B", 0)
    cdr.put_bytes(data)
    return bytes(cdr.data)


def theora_packet(data: bytes, _: str = "", order: str = "<", frame_id: str = "cam") -> bytes:
    cdr = _stamped(order, frame_id)
    cdr.put_bytes(data)
    for code in "iiqq":
        cdr.put(code, 0)
    return bytes(cdr.data)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Frames of the cameras in an incident, one at a time."""

from __future__ import annotations

import io
from collections.abc import Mapping
from itertools import islice
from typing import Any, cast

from PIL import Image

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel
from smarttestudo.pacing.coded_video import IMAGE_TYPES, is_coded_video
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.incidents.incidents import stored_incident
from smarttestudo.ruler.job import Picture, PictureType, job

MAX_FRAME_BYTES = 16_000_000
_MOST_PIXELS_A_SIDE = 960
_MOST_DIGITS = 9
_RAW = "sensor_msgs/msg/Image"
_BEGINNINGS: Mapping[bytes, PictureType] = {b"\xff\xd8\xff": "image/jpeg", b"\x89PNG\r\n\x1a\n": "image/png"}
_MODES = {"rgb8": ("RGB", "RGB", 3), "bgr8": ("RGB", "BGR", 3), "mono8": ("L", "L", 1)}
_LOOK_ELSEWHERE = "download the incident, and look at it in Foxglove or rqt"


@job("GET /api/incident/frame")
def frame(name: str, topic: str, number: str, folder: ProjectFolder) -> Picture:
    """The picture in message ``number`` of ``topic`` of an incident, 0 first.

    Raises ``RecordingError`` where that is none that a browser shows, and says why.
    """
    stored_incident(folder, name)
    if not (number.isascii() and number.isdecimal() and len(number) <= _MOST_DIGITS):
        raise RecordingError("this is no number of a frame", place=number[:20])
    with open_recording(folder.bag(name)) as recording:
        at = int(number)
        found = next(islice(recording.messages({topic}), at, at + 1), None)
        if found is None:
            raise RecordingError("there is no such frame in the incident", place=topic)
        channel, _, payload = found
        return _picture(channel, payload)


def _picture(channel: Channel, payload: bytes) -> Picture:
    topic, type_name = channel.topic, channel.type_name
    if type_name not in IMAGE_TYPES:
        kind = f"coded video ({type_name})" if is_coded_video(type_name) else f"no picture, but {type_name}"
        raise RecordingError(f"this is {kind}", place=topic, remedy=_LOOK_ELSEWHERE)
    if len(payload) > MAX_FRAME_BYTES:
        raise RecordingError("a frame has more than 16 MB", place=topic, remedy=_LOOK_ELSEWHERE)
    message = cast("Any", RosbagDecoder().decode(channel, payload))
    if type_name == _RAW:
        return _encoded(message, topic)
    data = bytes(message.data)
    for beginning, media_type in _BEGINNINGS.items():
        if data.startswith(beginning):
            return Picture(media_type=media_type, content=data)
    kind = str(message.format)[:40] or "without a format"
    raise RecordingError(f"its frames are {kind}, not JPEG or PNG", place=topic, remedy=_LOOK_ELSEWHERE)


def _encoded(message: Any, topic: str) -> Picture:
    """A raw image as PNG, at most 960 pixels a side."""
    if message.encoding not in _MODES:
        cause = f"its frames are {str(message.encoding)[:40]}, not rgb8, bgr8 or mono8"
        raise RecordingError(cause, place=topic, remedy=_LOOK_ELSEWHERE)
    mode, raw_mode, channels = _MODES[message.encoding]
    width, height, step, data = message.width, message.height, message.step, bytes(message.data)
    if not (0 < width * channels <= step and height > 0 and step * height <= len(data)):
        raise RecordingError("a frame has fewer bytes than its size says", place=topic)
    image = Image.frombytes(mode, (width, height), data, "raw", raw_mode, step)
    image.thumbnail((_MOST_PIXELS_A_SIDE, _MOST_PIXELS_A_SIDE))
    file = io.BytesIO()
    image.save(file, "PNG", compress_level=1)
    return Picture(media_type="image/png", content=file.getvalue())

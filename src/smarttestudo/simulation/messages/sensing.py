# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""ROS messages of what the robot sees."""

from __future__ import annotations

import io
import math

import numpy as np
from PIL import Image as PillowImage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__CameraInfo as CameraInfoMessage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__CompressedImage as CompressedImageMessage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__Image as ImageMessage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__LaserScan as LaserScanMessage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__RegionOfInterest as RegionOfInterestMessage

from smarttestudo.simulation.messages.motion import header
from smarttestudo.simulation.readings import CameraInfo, CompressedImage, Image, Pixels, Scan
from smarttestudo.simulation.robot import OPTICAL_FRAME, SCAN_FRAME

_QUALITY = 80
_QUALITIES = range(1, 96)


class JpegEncoder:
    """Makes JPEGs, either of one quality or, as a rate-controlled encoder, of the size asked for.

    The last result is kept, because a camera repeats its view until that changes.
    """

    __slots__ = ("_jpeg", "_pixels", "_target_bytes")

    def __init__(self, target_bytes: int | None = None) -> None:
        """``target_bytes`` is the size that the quality is chosen for; ``None`` takes the usual quality."""
        self._target_bytes = target_bytes
        self._pixels: Pixels | None = None
        self._jpeg: Pixels = np.zeros(0, np.uint8)

    def encode(self, pixels: Pixels) -> Pixels:
        """The bytes of a JPEG of ``pixels`` (height × width × RGB)."""
        if pixels is not self._pixels:
            self._pixels = pixels
            self._jpeg = np.frombuffer(self._compress(pixels), np.uint8)
        return self._jpeg

    def _compress(self, pixels: Pixels) -> bytes:
        picture = PillowImage.fromarray(pixels)
        if self._target_bytes is None:
            return _jpeg(picture, _QUALITY)
        low, high = _QUALITIES.start, _QUALITIES.stop
        # The largest quality that stays within the target: size grows with quality.
        while high - low > 1:
            middle = (low + high) // 2
            if len(_jpeg(picture, middle)) <= self._target_bytes:
                low = middle
            else:
                high = middle
        return _jpeg(picture, low)


def _jpeg(picture: PillowImage.Image, quality: int) -> bytes:
    stream = io.BytesIO()
    picture.save(stream, "JPEG", quality=quality)
    return stream.getvalue()


def scan(reading: Scan) -> LaserScanMessage:
    """A sensor_msgs/msg/LaserScan taken in one instant, with empty intensities for every ray."""
    rays = len(reading.ranges_m)
    return LaserScanMessage(
        header=header(reading.stamp_ns, SCAN_FRAME),
        angle_min=0.0,
        angle_max=math.tau * (rays - 1) / rays,
        angle_increment=math.tau / rays,
        time_increment=0.0,
        scan_time=reading.turn_s,
        range_min=reading.range_min_m,
        range_max=reading.range_max_m,
        ranges=reading.ranges_m,
        intensities=np.zeros(rays, np.float32),
    )


def camera_info(reading: CameraInfo) -> CameraInfoMessage:
    """A sensor_msgs/msg/CameraInfo of a pinhole camera without distortion."""
    lens = reading.lens
    focal, middle_x, middle_y = lens.focal_px, lens.width / 2, lens.height / 2
    return CameraInfoMessage(
        header=header(reading.stamp_ns, OPTICAL_FRAME),
        height=lens.height,
        width=lens.width,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=np.array([focal, 0, middle_x, 0, focal, middle_y, 0, 0, 1]),
        r=np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1]),
        p=np.array([focal, 0, middle_x, 0, 0, focal, middle_y, 0, 0, 0, 1, 0]),
        binning_x=lens.binning,
        binning_y=lens.binning,
        roi=RegionOfInterestMessage(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
    )


def image(reading: Image) -> ImageMessage:
    """A sensor_msgs/msg/Image, rgb8."""
    height, width, channels = reading.pixels.shape
    return ImageMessage(
        header=header(reading.stamp_ns, OPTICAL_FRAME),
        height=height,
        width=width,
        encoding="rgb8",
        is_bigendian=0,
        step=width * channels,
        data=reading.pixels.reshape(-1),
    )


def compressed_image(reading: CompressedImage, encoder: JpegEncoder) -> CompressedImageMessage:
    """A sensor_msgs/msg/CompressedImage, as image_transport's compressed plugin names its format."""
    return CompressedImageMessage(
        header=header(reading.stamp_ns, OPTICAL_FRAME),
        format="rgb8; jpeg compressed bgr8",
        data=encoder.encode(reading.pixels),
    )

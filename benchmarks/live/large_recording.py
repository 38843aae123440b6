# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recording with whole camera images."""

from __future__ import annotations

import os
from pathlib import Path

from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.recording import Channel, Storage
from smarttestudo.domain.units import NS_PER_S

IMAGES_PER_S = 29
SMALL_PER_IMAGE = 8
IMAGE = Channel(topic="/camera/image_raw", type_name="sensor_msgs/msg/Image")
IMU = Channel(topic="/imu", type_name="sensor_msgs/msg/Imu")


def write_recording(path: Path, storage: Storage, size_bytes: int, image_bytes: int) -> int:
    """Images, and small messages between them, up to ``size_bytes``; how many images there are."""
    images = size_bytes // image_bytes
    period_ns = NS_PER_S // IMAGES_PER_S
    frame = bytearray(b"\x00\x01\x00\x00" + os.urandom(image_bytes - 4))
    with create_recording(path, storage=storage) as writer:
        for number in range(images):
            frame[4:8] = number.to_bytes(4, "little")
            writer.write(IMAGE, number * period_ns, bytes(frame))
            for step in range(SMALL_PER_IMAGE):
                writer.write(IMU, number * period_ns + step * period_ns // SMALL_PER_IMAGE, bytes(320))
    return images

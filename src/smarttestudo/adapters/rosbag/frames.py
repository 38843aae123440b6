# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Compressing camera frames."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image as PillowImage

from smarttestudo.simulation.readings import Pixels

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

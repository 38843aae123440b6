# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Maps and images as pictures for a page: PNG files of our own making, whatever was read."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from smarttestudo.adapters.files.nav2_map import (
    MapError,
    MapHeader,
    read_darkness,
    require_bounded,
    too_many_pixels,
)

_MOST_PIXELS_A_SIDE = 3000
_FORMATS = ("PNG", "JPEG")
_OPAQUE = 255
_UNKNOWN = 36
_UNREADABLE = (OSError, UnidentifiedImageError, Image.DecompressionBombError, ValueError, SyntaxError)
_REMEDY = "give a PNG or JPEG image"


def map_png(header: MapHeader) -> bytes:
    """A map as a stencil: occupied cells are opaque, unknown ones nearly transparent, free ones fully.

    Raises:
        MapError: the image cannot be read.
    """
    darkness = read_darkness(header)
    opacity = np.zeros(darkness.shape, np.uint8)
    opacity[darkness >= header.free_share] = _UNKNOWN
    opacity[darkness > header.occupied_share] = _OPAQUE
    height, width = opacity.shape
    return _png(Image.merge("LA", (Image.new("L", (width, height)), Image.fromarray(opacity))))


def image_png(path: Path) -> bytes:
    """An image as it is, made smaller where a side has more than 3000 pixels; ``MapError`` if it is none."""
    try:
        with Image.open(path, formats=_FORMATS) as image:
            require_bounded(image, path)
            return _png(image.convert("RGBA"))
    except _UNREADABLE as error:
        raise _no_image(path, error) from error


def image_size(path: Path) -> tuple[int, int]:
    """Width and height in pixels, without reading the rest; ``MapError`` if it is no image."""
    try:
        with Image.open(path) as image:
            require_bounded(image, path)
            return image.width, image.height
    except _UNREADABLE as error:
        raise _no_image(path, error) from error


def _no_image(path: Path, error: Exception) -> MapError:
    if isinstance(error, Image.DecompressionBombError):
        return too_many_pixels(path)
    cause = getattr(error, "strerror", None) or "not an image"
    return MapError(f"the image cannot be read: {cause}", place=str(path), remedy=_REMEDY)


def _png(image: Image.Image) -> bytes:
    image.thumbnail((_MOST_PIXELS_A_SIDE, _MOST_PIXELS_A_SIDE))
    file = io.BytesIO()
    image.save(file, "PNG")
    return file.getvalue()

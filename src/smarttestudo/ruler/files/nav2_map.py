# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The maps that Nav2 drives by, and the same as pictures for a page."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, UnidentifiedImageError
from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.floor_plan import OccupancyMap
from smarttestudo.files.input_file import read_input, require_file

_MAX_YAML_BYTES = 1_000_000
_MOST_CELLS = 600
MAX_MEGAPIXELS = 36
_USUAL_OCCUPIED_SHARE = 0.65
_USUAL_FREE_SHARE = 0.196
_ORIGIN_NUMBERS = 3
_WHITE = 255.0
_REMEDY = "give the .yaml file that nav2's map_saver wrote"


class MapError(TestudoError):
    """A map that cannot be read."""


class _HeaderError(ValueError):
    """A value of the YAML file that no map has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapHeader:
    """Content of the YAML file; ``occupied_share`` is how dark an occupied cell is at least, 0 … 1.

    Cells less dark than ``free_share`` are free, those between are unknown.
    """

    image: Path
    cell_m: float
    origin: tuple[float, float, float]
    occupied_share: float
    free_share: float
    is_negative: bool


def read_nav2_map(path: Path) -> OccupancyMap:
    """The map whose YAML file is at ``path``, its longer side in at most 600 cells.

    A joined cell is occupied if any of its cells is.

    Raises:
        MapError: either file cannot be read or is none of a map.
    """
    header = read_map_header(path)
    occupied = read_darkness(header) > header.occupied_share
    joined = max(1, math.ceil(max(occupied.shape) / _MOST_CELLS))
    # Rows of an image run downwards, those of a map upwards.
    rows = _joined(occupied[::-1], joined)
    x_m, y_m, yaw_rad = header.origin
    return OccupancyMap(
        rows=tuple(tuple(map(bool, row)) for row in rows),
        cell_m=header.cell_m * joined,
        origin_x_m=x_m,
        origin_y_m=y_m,
        yaw_rad=yaw_rad,
    )


def read_darkness(header: MapHeader) -> np.ndarray[Any, np.dtype[np.float32]]:
    """How dark each cell is, 0 … 1, rows from the top; ``MapError`` where the image cannot be read."""
    try:
        require_file(header.image)
        with Image.open(header.image) as image:
            require_bounded(image, header.image)
            grey = np.asarray(image.convert("L"), dtype=np.float32) / _WHITE
    except Image.DecompressionBombError as error:
        raise too_many_pixels(header.image) from error
    except (OSError, UnidentifiedImageError, ValueError) as error:
        cause = f"the map's image cannot be read: {getattr(error, 'strerror', None) or 'not an image'}"
        raise MapError(cause, place=str(header.image), remedy=_REMEDY) from error
    return grey if header.is_negative else 1 - grey


def require_bounded(image: Image.Image, path: Path) -> None:
    """Refuse an image that would fill the memory; nothing of it is decoded yet. Raises ``MapError``."""
    if image.width * image.height > MAX_MEGAPIXELS * 1_000_000:
        raise too_many_pixels(path)


def too_many_pixels(path: Path) -> MapError:
    """Error for an image that is too large."""
    remedy = "save it smaller, a map with a coarser resolution"
    return MapError(f"the image has more than {MAX_MEGAPIXELS} megapixels", place=str(path), remedy=remedy)


def read_map_header(path: Path) -> MapHeader:
    """Read the YAML file at ``path``; ``MapError`` with the place of what is wrong in it."""
    try:
        values = YAML(typ="safe").load(read_input(path, _MAX_YAML_BYTES))
        return _read_header(values, path.parent)
    except OSError as error:
        raise MapError(
            f"the map cannot be read: {error.strerror}", place=str(path), remedy=_REMEDY
        ) from error
    except (YAMLError, LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise MapError(
            f"not a nav2 map{_reason(error)}", place=f"{path}{_line(error)}", remedy=_REMEDY
        ) from error


def _reason(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f": it has no {error.args[0]!r}"
    if isinstance(error, MarkedYAMLError) and error.problem:
        return f": {error.problem}"
    return f": {error}" if type(error) is _HeaderError else ""


def _line(error: Exception) -> str:
    mark = error.problem_mark if isinstance(error, MarkedYAMLError) else None
    return "" if mark is None else f":{mark.line + 1}:{mark.column + 1}"


def _read_header(values: Mapping[str, Any], folder: Path) -> MapHeader:
    origin, cell_m = values["origin"], float(values["resolution"])
    if len(origin) != _ORIGIN_NUMBERS:
        raise _HeaderError("'origin' is not [x, y, yaw]")
    x_m, y_m, yaw_rad = (float(value) for value in origin)
    if not (cell_m > 0 and all(map(math.isfinite, (cell_m, x_m, y_m, yaw_rad)))):
        raise _HeaderError("'resolution' must be above 0 and 'origin' finite")
    return MapHeader(
        image=folder / str(values["image"]),
        cell_m=cell_m,
        origin=(x_m, y_m, yaw_rad),
        occupied_share=float(values.get("occupied_thresh", _USUAL_OCCUPIED_SHARE)),
        free_share=float(values.get("free_thresh", _USUAL_FREE_SHARE)),
        is_negative=bool(int(values.get("negate", 0))),
    )


def _joined(cells: np.ndarray[Any, np.dtype[np.bool_]], joined: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Squares of ``joined`` cells as one; those that stick out over the upper and the right edge are free."""
    height, width = (-(-length // joined) * joined for length in cells.shape)
    padded = np.zeros((height, width), np.bool_)
    padded[: cells.shape[0], : cells.shape[1]] = cells
    squares = padded.reshape(height // joined, joined, width // joined, joined)
    return np.asarray(squares.any(axis=(1, 3)))


_MOST_PIXELS_A_SIDE = 3000
_FORMATS = ("PNG", "JPEG")
_OPAQUE = 255
_UNKNOWN = 36
_UNREADABLE = (OSError, UnidentifiedImageError, Image.DecompressionBombError, ValueError, SyntaxError)
_PICTURE_REMEDY = "give a PNG or JPEG image"


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
        require_file(path)
        with Image.open(path, formats=_FORMATS) as image:
            require_bounded(image, path)
            return _png(image.convert("RGBA"))
    except _UNREADABLE as error:
        raise _no_image(path, error) from error


def image_size(path: Path) -> tuple[int, int]:
    """Width and height in pixels, without reading the rest; ``MapError`` if it is no image."""
    try:
        require_file(path)
        with Image.open(path) as image:
            require_bounded(image, path)
            return image.width, image.height
    except _UNREADABLE as error:
        raise _no_image(path, error) from error


def _no_image(path: Path, error: Exception) -> MapError:
    if isinstance(error, Image.DecompressionBombError):
        return too_many_pixels(path)
    cause = getattr(error, "strerror", None) or "not an image"
    return MapError(f"the image cannot be read: {cause}", place=str(path), remedy=_PICTURE_REMEDY)


def _png(image: Image.Image) -> bytes:
    image.thumbnail((_MOST_PIXELS_A_SIDE, _MOST_PIXELS_A_SIDE))
    file = io.BytesIO()
    image.save(file, "PNG")
    return file.getvalue()

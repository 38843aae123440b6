# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The maps that nav2 drives by: a YAML file beside an image."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, UnidentifiedImageError
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from smarttestudo.domain.errors import TestudoError
from smarttestudo.visualizer.floor import OccupancyMap

_MAX_YAML_BYTES = 1_000_000
_MOST_CELLS = 600
_USUAL_OCCUPIED_SHARE = 0.65
_WHITE = 255.0
_REMEDY = "give the .yaml file that nav2's map_saver wrote"


class MapError(TestudoError):
    """A map that cannot be read."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Header:
    """What the YAML file says; ``occupied_share`` is how dark an occupied cell is at least, 0 … 1."""

    image: Path
    cell_m: float
    origin: tuple[float, float, float]
    occupied_share: float
    is_negative: bool


def read_nav2_map(path: Path) -> OccupancyMap:
    """The map whose YAML file is at ``path``, its longer side in at most 600 cells.

    A joined cell is occupied if any of its cells is.

    Raises:
        MapError: either file cannot be read or is none of a map.
    """
    header = _header(path)
    try:
        with Image.open(header.image) as image:
            grey = np.asarray(image.convert("L"), dtype=np.float64) / _WHITE
    except (OSError, UnidentifiedImageError, Image.DecompressionBombError, ValueError) as error:
        cause = f"the map's image cannot be read: {getattr(error, 'strerror', None) or 'not an image'}"
        raise MapError(cause, place=str(header.image), remedy=_REMEDY) from error
    darkness = grey if header.is_negative else 1 - grey
    occupied = darkness > header.occupied_share
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


def _header(path: Path) -> _Header:
    try:
        with path.open("rb") as file:
            values = YAML(typ="safe").load(file.read(_MAX_YAML_BYTES))
        return _read_header(values, path.parent)
    except OSError as error:
        raise MapError(
            f"the map cannot be read: {error.strerror}", place=str(path), remedy=_REMEDY
        ) from error
    except (YAMLError, LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise MapError("not a map of nav2", place=str(path), remedy=_REMEDY) from error


def _read_header(values: Mapping[str, Any], folder: Path) -> _Header:
    x_m, y_m, yaw_rad = (float(value) for value in values["origin"])
    cell_m = float(values["resolution"])
    if not (cell_m > 0 and all(map(math.isfinite, (cell_m, x_m, y_m, yaw_rad)))):
        raise ValueError("a map has a resolution above 0 and a finite origin")
    return _Header(
        image=folder / str(values["image"]),
        cell_m=cell_m,
        origin=(x_m, y_m, yaw_rad),
        occupied_share=float(values.get("occupied_thresh", _USUAL_OCCUPIED_SHARE)),
        is_negative=bool(int(values.get("negate", 0))),
    )


def _joined(cells: np.ndarray[Any, np.dtype[np.bool_]], joined: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Squares of ``joined`` cells as one; those that stick out over the upper and the right edge are free."""
    height, width = (-(-length // joined) * joined for length in cells.shape)
    padded = np.zeros((height, width), np.bool_)
    padded[: cells.shape[0], : cells.shape[1]] = cells
    squares = padded.reshape(height // joined, joined, width // joined, joined)
    return np.asarray(squares.any(axis=(1, 3)))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a project has to draw zones on: maps of nav2, images, and the paths of recordings."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.adapters.files.map_picture import image_png, image_size, map_png
from smarttestudo.adapters.files.nav2_map import MapError, MapHeader, read_map_header
from smarttestudo.adapters.files.project_folder import FileKind, ProjectFolder
from smarttestudo.composition.robot_places import places_in
from smarttestudo.domain.errors import RecordingError
from smarttestudo.visualizer.floor import PathPoint

MAX_POINTS = 2000
_HEAD_BYTES = 16_384
_MAX_IMAGE_BYTES = 60_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Background:
    """A map or image; ``sha256`` is that of its files, ``metres_per_pixel`` ``None`` where nobody said.

    Its lower left corner lies at (``x_m``, ``y_m``) in the map's frame, turned about it by ``yaw_rad``.
    """

    name: str
    kind: FileKind
    sha256: str
    width_px: int
    height_px: int
    metres_per_pixel: float | None
    x_m: float = 0.0
    y_m: float = 0.0
    yaw_rad: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenPath:
    """Where the robot of a recording was; ``notices`` say what could not be read."""

    points: tuple[PathPoint, ...]
    notices: tuple[str, ...]


class Backgrounds:
    """The maps, images and recordings of ``folder``; nothing outside it is read."""

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder

    def background(self, name: str, kind: FileKind) -> Background:
        """Size and place of a map or image.

        Raises:
            ForbiddenPathError: it, or the image that a map names, lies outside the project.
            MissingFileError: there is none.
            MapError: it cannot be read.
        """
        path = self._folder.background(name, kind)
        with self._placed():
            if kind is FileKind.IMAGE:
                width_px, height_px = image_size(path)
                return Background(
                    name=name,
                    kind=kind,
                    sha256=_sha256(path),
                    width_px=width_px,
                    height_px=height_px,
                    metres_per_pixel=None,
                )
            header = self._header(path, name)
            width_px, height_px = image_size(header.image)
            x_m, y_m, yaw_rad = header.origin
            return Background(
                name=name,
                kind=kind,
                sha256=_sha256(path, header.image),
                width_px=width_px,
                height_px=height_px,
                metres_per_pixel=header.cell_m,
                x_m=x_m,
                y_m=y_m,
                yaw_rad=yaw_rad,
            )

    def picture(self, name: str, kind: FileKind) -> bytes:
        """A map or image as PNG; errors as in ``background``."""
        path = self._folder.background(name, kind)
        with self._placed():
            if kind is FileKind.IMAGE:
                _require_small(path)
                return image_png(path)
            return map_png(self._header(path, name))

    def path(self, name: str) -> DrivenPath:
        """Where the robot of the bag ``name`` was, by its odometry, else by its transforms.

        Raises:
            RecordingError: the bag cannot be read, or says nothing of where the robot was.
        """
        return _driven(self._folder.bag(name), name)

    def _header(self, path: Path, name: str) -> MapHeader:
        header = read_map_header(path)
        self._folder.require_inside(header.image, name)
        _require_small(header.image)
        return header

    @contextmanager
    def _placed(self) -> Iterator[None]:
        """Errors name files as the project does."""
        try:
            yield
        except MapError as error:
            place = self._folder.shown(error.place or "")
            raise MapError(error.cause, place=place, remedy=error.remedy) from error


def _driven(bag: Path, name: str) -> DrivenPath:
    from smarttestudo.adapters.rosbag import (  # noqa: PLC0415  most projects have no bag
        RosbagDecoder,
        open_recording,
    )

    with open_recording(bag) as recording:
        places = places_in(recording.channels, RosbagDecoder(), recording.start_ns, by_transforms=False)
        if places is None:
            remedy = "record /odom, or /tf, with it"
            raise RecordingError("the recording does not say where the robot was", place=name, remedy=remedy)
        for channel, stamp_ns, (size_bytes, head) in recording.heads(_HEAD_BYTES):
            if size_bytes == len(head):
                places.take(channel, stamp_ns, head)
        step = -(-len(places.path) // MAX_POINTS) or 1
        return DrivenPath(points=tuple(places.path[::step]), notices=tuple(recording.notices()))


def _require_small(path: Path) -> None:
    try:
        size_bytes = path.stat().st_size
    except OSError:
        # Who reads it says why it cannot be read.
        return
    if size_bytes > _MAX_IMAGE_BYTES:
        raise MapError(
            f"the image has {size_bytes / 1e6:.0f} MB, more than {_MAX_IMAGE_BYTES / 1e6:.0f}",
            place=str(path),
            remedy="save it smaller",
        )


def _sha256(*paths: Path) -> str:
    digest = hashlib.sha256()
    for path in paths:
        with path.open("rb") as file:
            while chunk := file.read(1_000_000):
                digest.update(chunk)
    return digest.hexdigest()

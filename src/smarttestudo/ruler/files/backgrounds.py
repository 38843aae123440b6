# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Backgrounds for zones in a project: maps of nav2, images, and the paths of recordings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from msgspec import Struct

from smarttestudo.bags.robot_path import TransformPlaces, notice_of_unknown, places_in
from smarttestudo.domain.errors import RecordingError
from smarttestudo.files.input_file import sha256_of_files
from smarttestudo.ruler.files.nav2_map import (
    MapError,
    MapHeader,
    image_png,
    image_size,
    map_png,
    read_map_header,
)
from smarttestudo.ruler.files.project_folder import FileKind, ProjectFolder
from smarttestudo.ruler.files.recordings import BagRequest
from smarttestudo.ruler.job import job

MAX_POINTS = 2000
_HEAD_BYTES = 16_384
_MAX_IMAGE_BYTES = 60_000_000


ChoiceKind = Literal["map", "image", "bag"]
_CHOICES: Mapping[FileKind, ChoiceKind] = {
    FileKind.MAP: "map",
    FileKind.IMAGE: "image",
    FileKind.BAG: "bag",
}


class BackgroundChoice(Struct, frozen=True, kw_only=True):
    """A map, image or recording of the project."""

    kind: ChoiceKind
    name: str


class BackgroundsAnswer(Struct, frozen=True, kw_only=True):
    """Maps, images and recordings that zones can be drawn on."""

    choices: tuple[BackgroundChoice, ...]


BackgroundKind = Literal["map", "image"]


class BackgroundRequest(Struct, frozen=True, kw_only=True):
    """A map or image by its name in the project."""

    kind: BackgroundKind
    name: str


class Background(Struct, frozen=True, kw_only=True):
    """A map or image; ``GET /api/background/picture?kind=…&name=…`` is its picture, always PNG.

    ``hash`` is that of its files, to see whether they changed; ``metres_per_pixel`` is null for an image.
    The lower left corner of the picture lies at (``x``, ``y``) in metres, turned about it by ``yaw_rad``.
    """

    kind: BackgroundKind
    name: str
    hash: str
    width_px: int
    height_px: int
    metres_per_pixel: float | None
    x: float = 0.0
    y: float = 0.0
    yaw_rad: float = 0.0


class DrivenPath(Struct, frozen=True, kw_only=True):
    """Where the robot of a recording was: seconds since its start, x and y in metres.

    ``source`` is the topic that says so, ``has_pose`` whether rules can read the place from it, ``frame`` the
    frame of its places, empty where it names none.
    ``notices`` say what could not be read.
    """

    path: tuple[tuple[float, float, float], ...]
    source: str
    has_pose: bool
    frame: str
    notices: tuple[str, ...]


@job("GET /api/backgrounds")
def backgrounds(folder: ProjectFolder) -> BackgroundsAnswer:
    """Everything that zones can be drawn on."""
    files, _ = folder.files()
    return BackgroundsAnswer(
        choices=tuple(
            BackgroundChoice(kind=_CHOICES[one.kind], name=one.name)
            for one in [*files, *folder.images()]
            if one.kind in _CHOICES
        )
    )


@job("POST /api/background", reads=True)
def background(request: BackgroundRequest, folder: ProjectFolder) -> Background:
    """Size and place of a map or image.

    Raises:
        ForbiddenPathError: it, or the image that a map names, lies outside the project.
        MissingFileError: there is none.
        MapError: it cannot be read.
    """
    name, kind = request.name, request.kind
    path = folder.background(name, FileKind(kind))
    header = None if kind == "image" else _header(folder, path, name)
    width_px, height_px = image_size(path if header is None else header.image)
    x_m, y_m, yaw_rad = (0.0, 0.0, 0.0) if header is None else header.origin
    return Background(
        name=name,
        kind=kind,
        hash=sha256_of_files(path) if header is None else sha256_of_files(path, header.image),
        width_px=width_px,
        height_px=height_px,
        metres_per_pixel=None if header is None else header.cell_m,
        x=x_m,
        y=y_m,
        yaw_rad=yaw_rad,
    )


@job("GET /api/background/picture")
def picture(kind: BackgroundKind, name: str, folder: ProjectFolder) -> bytes:
    """A map or image as PNG; errors as in ``background``."""
    path = folder.background(name, FileKind(kind))
    if kind == "image":
        _require_small(path)
        return image_png(path)
    return map_png(_header(folder, path, name))


def _header(folder: ProjectFolder, path: Path, name: str) -> MapHeader:
    header = read_map_header(path)
    folder.require_inside(header.image, name)
    _require_small(header.image)
    return header


@job("POST /api/background/path", reads=True)
def driven_path(request: BagRequest, folder: ProjectFolder) -> DrivenPath:
    """Where the robot of a bag was, by its pose in the map, else by its odometry or transforms.

    Raises ``RecordingError`` where the bag cannot be read, or has no positions of the robot.
    """
    from smarttestudo.bags.definitions import RosbagDecoder  # noqa: PLC0415  most projects have no bag
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  most projects have no bag

    with open_recording(folder.bag(request.bag)) as recording:
        places = places_in(recording.channels, RosbagDecoder(), recording.start_ns, by_transforms=False)
        if places is None:
            remedy = "record /odom, or /tf, with it"
            cause = "the recording does not say where the robot was"
            raise RecordingError(cause, place=request.bag, remedy=remedy)
        unknown: Counter[str] = Counter()
        for channel, stamp_ns, (size_bytes, head) in recording.heads(_HEAD_BYTES):
            if size_bytes == len(head):
                try:
                    places.on_message(channel, stamp_ns, head)
                except RecordingError as error:
                    unknown[error.cause] += 1
        step = -(-len(places.path) // MAX_POINTS) or 1
        return DrivenPath(
            path=tuple((point.t_s, point.x_m, point.y_m) for point in places.path[::step]),
            source=places.source,
            has_pose=not isinstance(places, TransformPlaces),
            frame=places.frame,
            notices=(*map(folder.shown, recording.notices()), *notice_of_unknown(unknown)),
        )


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

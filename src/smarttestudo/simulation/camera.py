# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated camera."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from smarttestudo.domain.floor_plan import ObstacleKind
from smarttestudo.simulation import messages
from smarttestudo.simulation.geometry import Lens, Pose
from smarttestudo.simulation.messages import Pixels, Published, RobotTopic
from smarttestudo.simulation.robot import BodyT, DifferentialDrive
from smarttestudo.simulation.sensors import Floats, RayCaster

_SIGHT_M = 60.0
_FADING_M = 15.0
_CEILING = (70.0, 74.0, 82.0)
_FLOOR = (150.0, 148.0, 142.0)
_GRAIN = 6
_COLOURS: Mapping[ObstacleKind, tuple[float, float, float]] = {
    ObstacleKind.WALL: (214.0, 208.0, 196.0),
    ObstacleKind.RACK: (38.0, 96.0, 170.0),
    ObstacleKind.UPRIGHT: (236.0, 176.0, 32.0),
}


def render(
    caster: RayCaster, camera: Pose, height_m: float, lens: Lens, noise: np.random.Generator
) -> Pixels:
    """The image of a level ``camera``, height × width × RGB, with the grain of a sensor.

    One ray a column finds the obstacle; its height over its distance gives the rows that it covers.
    """
    width, height = lens.image_size
    focal_px = lens.focal_px / lens.binning
    slopes = (width / 2 - 0.5 - np.arange(width)) / focal_px
    angles = np.arctan(slopes)
    obstacles = caster.plan.obstacles
    hits = caster.cast(camera.place, camera.yaw_rad + angles, range_m=_SIGHT_M)
    depths_m = hits.distances_m * np.cos(angles)
    heights_m = np.array([obstacle.height_m for obstacle in obstacles])[hits.obstacles]
    colours = np.array([_COLOURS[obstacle.kind] for obstacle in obstacles])[hits.obstacles]

    below_horizon_px = np.arange(height) + 0.5 - height / 2
    top_px = -focal_px * (heights_m - height_m) / depths_m
    foot_px = focal_px * height_m / depths_m
    with np.errstate(divide="ignore"):
        floor_m = np.abs(focal_px * height_m / below_horizon_px)
    background = np.where((below_horizon_px < 0)[:, None], _CEILING, _faded(np.array(_FLOOR), floor_m))
    covered = (below_horizon_px[:, None] >= top_px) & (below_horizon_px[:, None] < foot_px)
    scene = np.where(covered[..., None], _faded(colours, depths_m), background[:, None, :])
    return grained(scene, noise)


def grained(scene: NDArray[np.generic], noise: np.random.Generator) -> Pixels:
    """``scene``, height × width × RGB, with the grain of a sensor."""
    grain = noise.integers(-_GRAIN, _GRAIN, scene.shape, endpoint=True, dtype=np.int8)
    pixels: Pixels = np.clip(scene.astype(np.float64) + grain, 0, 255).astype(np.uint8)
    return pixels


def _faded(colours: Floats, distances_m: Floats) -> Floats:
    """Colours, darker with distance."""
    return colours * (1 / (1 + distances_m / _FADING_M))[:, None]


_WIDTH = 1920
_HEIGHT = 1080
_HORIZONTAL_VIEW_RAD = 1.085595
_FRAMES_PER_VIEW = 15
_FRAMES_PER_LOSS = 29


FULL_JPEG_BYTES = 420_000


class FrameSize(Enum):
    """How large the camera's frames are; the value is the binning: 48 × 27, 960 × 540, 1920 × 1080 pixels."""

    SMALL = 40
    MEDIUM = 2
    FULL = 1

    @property
    def jpeg_bytes(self) -> int | None:
        """The size that compressed frames come close to; ``None`` leaves it to the usual quality."""
        return {FrameSize.SMALL: None, FrameSize.MEDIUM: 100_000, FrameSize.FULL: FULL_JPEG_BYTES}[self]


def raspberry_pi_lens(frames: FrameSize) -> Lens:
    """The Waffle Pi's camera with Gazebo's field of view."""
    focal_px = _WIDTH / 2 / float(np.tan(_HORIZONTAL_VIEW_RAD / 2))
    return Lens(width=_WIDTH, height=_HEIGHT, focal_px=focal_px, binning=frames.value)


class Camera(Generic[BodyT]):
    """One shutter for the raw image, its calibration and its compressed copy.

    The view is drawn anew about twice a second and repeated in between. The compressor is a little too
    slow: it loses one frame in 29, so that 28 of them come a second.
    """

    rate_hz = 29.0

    def __init__(self, look: Callable[[BodyT], Pixels], frames: FrameSize) -> None:
        self._look = look
        self._lens = raspberry_pi_lens(frames)
        self._most_jpeg_bytes = frames.jpeg_bytes
        self._frame = 0
        self._view: Pixels = np.zeros((0, 0, 3), np.uint8)
        self._jpeg: Pixels = np.zeros(0, np.uint8)

    def sample(self, body: BodyT) -> Published:
        if self._frame % _FRAMES_PER_VIEW == 0:
            self._view = self._look(body)
            self._jpeg = messages.jpeg_of(self._view, self._most_jpeg_bytes)
        self._frame += 1
        published: list[tuple[RobotTopic, object]] = [
            (RobotTopic.IMAGE, messages.image(body.now_ns, self._view)),
            (RobotTopic.CAMERA_INFO, messages.camera_info(body.now_ns, self._lens)),
        ]
        if self._frame % _FRAMES_PER_LOSS:
            published.append(
                (RobotTopic.COMPRESSED_IMAGE, messages.compressed_image(body.now_ns, self._jpeg))
            )
        return published


def drawn_view(
    caster: RayCaster, lens: Lens, noise: np.random.Generator
) -> Callable[[DifferentialDrive], Pixels]:
    """Function that draws what the robot sees."""

    def look(drive: DifferentialDrive) -> Pixels:
        place = drive.pose.ahead(drive.model.camera_x_m)
        camera = Pose(place.x_m, place.y_m, drive.pose.yaw_rad)
        return render(caster, camera, drive.model.camera_height_m, lens, noise)

    return look

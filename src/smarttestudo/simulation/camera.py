# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's camera."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from smarttestudo.simulation.drive import DifferentialDrive
from smarttestudo.simulation.floor_plan import FloorPlan
from smarttestudo.simulation.ray_casting import RayCaster
from smarttestudo.simulation.readings import CameraInfo, CompressedImage, Image, Lens, Pixels, Reading, Topic
from smarttestudo.simulation.view import Viewpoint, render

_WIDTH = 1920
_HEIGHT = 1080
_HORIZONTAL_VIEW_RAD = 1.085595
_SMALL_BINNING = 40
_FRAMES_PER_VIEW = 15
_FRAMES_PER_LOSS = 29


def raspberry_pi_lens(*, full_size: bool) -> Lens:
    """The Waffle Pi's camera at 1920 × 1080 with Gazebo's field of view, or binned to 48 × 27."""
    focal_px = _WIDTH / 2 / float(np.tan(_HORIZONTAL_VIEW_RAD / 2))
    return Lens(width=_WIDTH, height=_HEIGHT, focal_px=focal_px, binning=1 if full_size else _SMALL_BINNING)


class Camera:
    """One shutter for the raw image, its calibration and its compressed copy.

    The view is drawn anew about twice a second and repeated in between. The compressor is a little too
    slow: it loses one frame in 29, so that 28 of them come a second.
    """

    rate_hz = 29.0

    def __init__(self, plan: FloorPlan, caster: RayCaster, lens: Lens, noise: np.random.Generator) -> None:
        self._plan = plan
        self._caster = caster
        self._lens = lens
        self._noise = noise
        self._frame = 0
        self._view: Pixels = np.zeros((0, 0, 3), np.uint8)

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """One frame."""
        if self._frame % _FRAMES_PER_VIEW == 0:
            self._view = self._look(drive)
        self._frame += 1
        stamp_ns, pixels = drive.now_ns, self._view
        published: list[tuple[Topic, Reading]] = [
            (Topic.IMAGE, Image(stamp_ns=stamp_ns, pixels=pixels)),
            (Topic.CAMERA_INFO, CameraInfo(stamp_ns=stamp_ns, lens=self._lens)),
        ]
        if self._frame % _FRAMES_PER_LOSS:
            published.append((Topic.COMPRESSED_IMAGE, CompressedImage(stamp_ns=stamp_ns, pixels=pixels)))
        return published

    def _look(self, drive: DifferentialDrive) -> Pixels:
        viewpoint = Viewpoint(
            place=drive.pose.ahead(drive.model.camera_x_m),
            yaw_rad=drive.pose.yaw_rad,
            height_m=drive.model.camera_height_m,
        )
        return render(self._plan, self._caster, viewpoint, self._lens, self._noise)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""MuJoCo: the only importer of it. It must be installed where this is called, not where it is imported."""

from __future__ import annotations

import ctypes.util
import os
from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarttestudo.domain.errors import TestudoError, missing_package
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import Pose, Quaternion, Vector
from smarttestudo.simulation.messages import Pixels

FLOOR = "floor"
LIDAR_COVER = "lidar_cover"
HIDDEN_GROUP = 4
"""The group of geometry that neither rays nor cameras see."""


Floats = NDArray[np.float64]
_GL_LIBRARIES: Mapping[str, str] = {"egl": "EGL", "osmesa": "OSMesa"}
_DRAWING_REMEDY = "install libegl1 and libgl1, and leave MUJOCO_GL unset"
_ENDLESS_M = 1e10
_VISIBLE_GROUPS = np.array([group != HIDDEN_GROUP for group in range(6)], np.uint8)


class PhysicsError(TestudoError):
    """Physics that cannot be computed or drawn on this machine."""


def load_mujoco() -> ModuleType:
    """MuJoCo, told to draw without a screen.

    Raises:
        MissingPackageError: it is not installed.
        PhysicsError: it is installed and does not load.
    """
    # It reads this when it is imported.
    os.environ.setdefault("MUJOCO_GL", _offscreen_gl())
    try:
        import mujoco  # noqa: PLC0415  a robot lacks it, and the variable comes first
    except ModuleNotFoundError as error:
        missing = missing_package(error, "--physics")
        if missing is None:
            raise
        raise missing from error
    except (AttributeError, ImportError, OSError, RuntimeError) as error:
        raise PhysicsError(
            f"MuJoCo does not load: {error}", place="--physics", remedy="try it with MUJOCO_GL=disable"
        ) from error
    module: ModuleType = mujoco
    return module


def _offscreen_gl() -> str:
    for name, library in _GL_LIBRARIES.items():
        if ctypes.util.find_library(library):
            return name
    return "disable"


class Engine:
    """One world, one robot in it, and time in steps of the model.

    The robot is the one body with a free joint. Names are those of the model; vectors are along the axes of
    the world unless said otherwise.
    """

    def __init__(self, mjcf: str) -> None:
        """The world that ``mjcf`` describes. Raises ``MissingPackageError`` and ``PhysicsError``."""
        self._mujoco: Any = load_mujoco()
        self._model: Any = self._mujoco.MjModel.from_xml_string(mjcf)
        self._data: Any = self._mujoco.MjData(self._model)
        self._robot = int(self._model.jnt_bodyid[0])
        self._renderer: Any = None
        self._steps = 0
        self._mujoco.mj_forward(self._model, self._data)
        self.version = str(self._mujoco.__version__)
        self.inertial: Floats = self._data.sensordata
        """Gyroscope and accelerometer along the robot's axes: rad/s, then m/s²."""
        self.step_ns: int = round(self._model.opt.timestep * NS_PER_S)

    @property
    def time_ns(self) -> int:
        return self._steps * self.step_ns

    def step(self, controls: Sequence[float]) -> None:
        """Move on by one step under ``controls``, one for each actuator in the order of the model."""
        self._data.ctrl[:] = controls
        self._mujoco.mj_step(self._model, self._data)
        self._steps += 1

    def settle(self, controls: Sequence[float], steps: int) -> None:
        """Come to rest on the floor before time starts."""
        for _ in range(steps):
            self.step(controls)
        self._steps = 0

    @property
    def position(self) -> Vector:
        """Where the robot is, in metres."""
        return Vector(*self._data.qpos[:3].tolist())

    @property
    def orientation(self) -> Quaternion:
        """How the robot is turned."""
        w, x, y, z = self._data.qpos[3:7].tolist()
        return Quaternion(x, y, z, w)

    @property
    def rotation(self) -> Floats:
        """The matrix, 3 × 3, that takes the robot's axes to those of the world."""
        matrix: Floats = self._data.xmat[self._robot].reshape(3, 3)
        return matrix

    @property
    def velocity(self) -> Vector:
        """How fast the robot moves, in m/s."""
        return Vector(*self._data.qvel[:3].tolist())

    @property
    def angular_velocity(self) -> Vector:
        """How fast the robot turns about its own axes, in rad/s."""
        return Vector(*self._data.qvel[3:6].tolist())

    @property
    def joint_angles(self) -> tuple[float, ...]:
        """The robot's joints, in radians."""
        return tuple(self._data.qpos[7:].tolist())

    @property
    def joint_speeds(self) -> tuple[float, ...]:
        """The robot's joints, in rad/s."""
        return tuple(self._data.qvel[6:].tolist())

    @property
    def actuator_forces(self) -> tuple[float, ...]:
        """Force or torque of each actuator: N m of a wheel, N of a rotor."""
        return tuple(self._data.actuator_force.tolist())

    def place(self, walker: int, pose: Pose) -> None:
        """Put the ``walker``-th body that walks by itself somewhere."""
        self._data.mocap_pos[walker] = (pose.x_m, pose.y_m, 0.0)
        turned = Quaternion.from_yaw(pose.yaw_rad)
        self._data.mocap_quat[walker] = (turned.w, turned.x, turned.y, turned.z)

    def reveal(self, geom: str) -> None:
        """Have a hidden part seen by rays and cameras from now on."""
        self._model.geom_group[self._model.geom(geom).id] = 0

    def touched(self) -> frozenset[str]:
        """The names of what the robot touches beside the floor."""
        roots, bodies = self._model.body_rootid, self._model.geom_bodyid
        found = set()
        for pair in self._data.contact.geom.tolist():
            for own, other in (pair, pair[::-1]):
                if roots[bodies[own]] == self._robot != roots[bodies[other]]:
                    found.add(self._model.geom(other).name)
        return frozenset(found - {FLOOR})

    def cast(self, origin: Vector, directions: Floats, range_m: float) -> Floats:
        """How far each ray, a unit vector per row, goes in metres; infinite beyond ``range_m``.

        The robot's own trunk is no obstacle.
        """
        count = len(directions)
        distances, hits = np.zeros(count), np.zeros(count, np.int32)
        start = np.array((origin.x, origin.y, origin.z))
        self._mujoco.mj_multiRay(
            self._model,
            self._data,
            start,
            np.ascontiguousarray(directions).reshape(-1),
            _VISIBLE_GROUPS,
            1,
            self._robot,
            hits,
            distances,
            # Newer ones also give the normals of surfaces.
            *([None] if "normal" in (self._mujoco.mj_multiRay.__doc__ or "") else []),
            count,
            # A cutoff would leave out a floor whose middle is farther than that.
            _ENDLESS_M,
        )
        return np.where((distances < 0) | (distances > range_m), np.inf, distances)

    def open_camera(self, width: int, height: int) -> None:
        """Open a camera for pictures of that size. Raises ``PhysicsError`` where nothing can draw here."""
        renderer = getattr(self._mujoco, "Renderer", None)
        if renderer is None or not hasattr(self._mujoco, "GLContext"):
            raise PhysicsError("neither EGL nor OSMesa is in use", remedy=_DRAWING_REMEDY)
        try:
            self._renderer = renderer(self._model, height, width)
            # The first one takes a second, which nobody waits for once the robot drives.
            self.picture()
        except Exception as error:  # each library of OpenGL raises errors of its own
            self.close()
            cause = " ".join(str(error).split()) or type(error).__name__
            raise PhysicsError(f"OpenGL cannot draw here: {cause:.120}", remedy=_DRAWING_REMEDY) from error

    def picture(self) -> Pixels:
        """Picture of the robot's camera, height × width × RGB; only with an open camera."""
        self._renderer.update_scene(self._data, camera="camera")
        pixels: Pixels = self._renderer.render()
        return pixels

    def close(self) -> None:
        """Let the camera go, as OpenGL wants it: before the interpreter ends."""
        renderer, self._renderer = self._renderer, None
        if renderer is not None:
            renderer.close()

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The warehouse and those who walk in it: where they are, and as MJCF, the model format of MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.floor_plan import FloorPlan, Obstacle, ObstacleKind, Point
from smarttestudo.simulation.geometry import Lens, Pose, bearing_rad
from smarttestudo.simulation.physics.engine import FLOOR

_STOP_M = 1.0
_CLEAR_M = 0.55
_AT_ONCE_M = 0.1


@dataclass(slots=True, kw_only=True)
class WalkingPerson:
    """Walks straight from ``start`` to ``end`` and back, without end."""

    start: Point
    end: Point
    speed_m_per_s: float
    travelled_m: float = 0.0

    @property
    def pose(self) -> Pose:
        """Where the person is, facing ahead."""
        length_m = self.start.distance_m(self.end)
        lap_m = self.travelled_m % (2 * length_m)
        share = 1 - abs(lap_m / length_m - 1)
        way_x_m, way_y_m = self.end.x_m - self.start.x_m, self.end.y_m - self.start.y_m
        heading = bearing_rad(self.start, self.end)
        return Pose(
            self.start.x_m + share * way_x_m,
            self.start.y_m + share * way_y_m,
            heading if lap_m < length_m else heading + math.pi,
        )

    def walk(self, dt_s: float, robot: Point) -> None:
        """Go on for ``dt_s``, unless the robot stands in the way."""
        pose = self.pose
        ahead_m = (robot.x_m - pose.x_m) * math.cos(pose.yaw_rad)
        ahead_m += (robot.y_m - pose.y_m) * math.sin(pose.yaw_rad)
        aside_m = (robot.y_m - pose.y_m) * math.cos(pose.yaw_rad)
        aside_m -= (robot.x_m - pose.x_m) * math.sin(pose.yaw_rad)
        if not (-_AT_ONCE_M < ahead_m < _STOP_M and abs(aside_m) < _CLEAR_M):
            self.travelled_m += self.speed_m_per_s * dt_s


def people() -> list[WalkingPerson]:
    """Everybody at the start: in the hall, in the corridor and behind the scaffolds."""
    return [
        WalkingPerson(start=Point(11.9, 11.0), end=Point(11.9, -2.0), speed_m_per_s=0.9),
        WalkingPerson(start=Point(4.5, 4.6), end=Point(-4.5, 4.6), speed_m_per_s=1.1),
        WalkingPerson(start=Point(-8.0, 15.6), end=Point(7.8, 15.6), speed_m_per_s=1.0),
    ]


STEP_S = 0.002
_FLOOR_HALF_M = 40.0
_COLOURS: Mapping[ObstacleKind, str] = {
    ObstacleKind.WALL: "0.84 0.82 0.77 1",
    ObstacleKind.RACK: "0.15 0.38 0.67 1",
    ObstacleKind.UPRIGHT: "0.93 0.69 0.13 1",
}
_FLOOR_COLOUR = "0.59 0.58 0.56 1"
_CEILING_COLOUR = "0.27 0.29 0.32"
_PERSON_COLOUR = "0.85 0.35 0.15 1"


PERSON_RADIUS_M = 0.22
_PERSON_HEIGHT_M = 1.7


def world_model(
    plan: FloorPlan, robot: str, actuators: str, people: Sequence[Pose], image: tuple[int, int]
) -> str:
    """The MJCF of ``plan`` with ``robot`` and its ``actuators`` on it, and a person at each of ``people``.

    ``image`` is the width and height in pixels that the camera may have at most.
    """
    boxes = "".join(_box(number, obstacle) for number, obstacle in enumerate(plan.obstacles, start=1))
    persons = "".join(_person(number, pose) for number, pose in enumerate(people, start=1))
    # The elliptic cone and its ratio keep a wheel that stands from creeping sideways.
    return f"""
    <mujoco model="warehouse">
      <option timestep="{STEP_S}" integrator="implicitfast" cone="elliptic" impratio="10"
              density="1.2" viscosity="0.000018"/>
      <visual>
        <global offwidth="{image[0]}" offheight="{image[1]}"/>
        <map znear="0.001" zfar="2"/>
        <headlight ambient="0.35 0.35 0.35" diffuse="0.3 0.3 0.3" specular="0 0 0"/>
      </visual>
      <asset>
        <texture type="skybox" builtin="flat" rgb1="{_CEILING_COLOUR}" width="16" height="16"/>
      </asset>
      <worldbody>
        <light directional="true" pos="0 0 8" dir="-0.3 0.2 -1" castshadow="false"/>
        <geom name="{FLOOR}" type="plane" size="{_FLOOR_HALF_M:g} {_FLOOR_HALF_M:g} 1"
              rgba="{_FLOOR_COLOUR}" friction="0.9 0.005 0.0001"/>
        {boxes}{persons}{robot}
      </worldbody>
      <actuator>{actuators}</actuator>
      <sensor><gyro site="imu"/><accelerometer site="imu"/></sensor>
    </mujoco>"""


def numbers(*values: float) -> str:
    """The values as an attribute."""
    return " ".join(f"{value:.9g}" for value in values)


def heading(pose: Pose) -> str:
    """The rotation of a body at ``pose`` as an attribute."""
    return numbers(math.cos(pose.yaw_rad / 2), 0, 0, math.sin(pose.yaw_rad / 2))


def camera(forward_m: float, height_m: float, lens: Lens) -> str:
    """A level camera of a robot that looks forward, with the field of view of ``lens``."""
    fovy = numbers(math.degrees(2 * math.atan(lens.height / 2 / lens.focal_px)))
    place = numbers(forward_m, 0, height_m)
    return f'<camera name="camera" pos="{place}" xyaxes="0 -1 0 0 0 1" fovy="{fovy}"/>'


def _box(number: int, obstacle: Obstacle) -> str:
    low, high = obstacle.footprint.corners[0], obstacle.footprint.corners[2]
    half_height_m = obstacle.height_m / 2
    middle = numbers((low.x_m + high.x_m) / 2, (low.y_m + high.y_m) / 2, half_height_m)
    size = numbers((high.x_m - low.x_m) / 2, (high.y_m - low.y_m) / 2, half_height_m)
    return f"""
        <geom name="{obstacle.kind.value}_{number}" type="box" pos="{middle}" size="{size}"
              rgba="{_COLOURS[obstacle.kind]}"/>"""


def _person(number: int, pose: Pose) -> str:
    """An upright capsule."""
    size = numbers(PERSON_RADIUS_M, _PERSON_HEIGHT_M / 2 - PERSON_RADIUS_M)
    return f"""
        <body name="person_{number}" mocap="true" pos="{numbers(pose.x_m, pose.y_m, 0)}">
          <geom name="person_{number}" type="capsule" pos="0 0 {_PERSON_HEIGHT_M / 2:.9g}" size="{size}"
                rgba="{_PERSON_COLOUR}"/>
        </body>"""

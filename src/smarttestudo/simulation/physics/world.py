# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The warehouse and those who walk in it: where they are, and as MJCF, the model format of MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, tostring

from smarttestudo.domain.floor_plan import FloorPlan, ObstacleKind, Point, Rectangle
from smarttestudo.simulation.geometry import Pose, bearing_rad
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
    plan: FloorPlan, robot: Element, actuators: Element, people: Sequence[Pose], image: tuple[int, int]
) -> str:
    """The MJCF of ``plan`` with ``robot`` on it and a person at each of ``people``.

    ``image`` is the width and height in pixels that the camera may have at most.
    """
    root = Element("mujoco", model="warehouse")
    # The elliptic cone and its ratio keep a wheel that stands from creeping sideways.
    SubElement(
        root, "option", timestep=str(STEP_S), integrator="implicitfast", cone="elliptic", impratio="10",
        density="1.2", viscosity="0.000018",
    )  # fmt: skip
    visual = SubElement(root, "visual")
    SubElement(visual, "global", offwidth=str(image[0]), offheight=str(image[1]))
    SubElement(visual, "map", znear="0.001", zfar="2")
    SubElement(visual, "headlight", ambient="0.35 0.35 0.35", diffuse="0.3 0.3 0.3", specular="0 0 0")
    SubElement(
        SubElement(root, "asset"), "texture", type="skybox", builtin="flat", rgb1=_CEILING_COLOUR, width="16",
        height="16",
    )  # fmt: skip
    world = SubElement(root, "worldbody")
    SubElement(world, "light", directional="true", pos="0 0 8", dir="-0.3 0.2 -1", castshadow="false")
    add_geom(
        world, FLOOR, type="plane", size=numbers(_FLOOR_HALF_M, _FLOOR_HALF_M, 1), rgba=_FLOOR_COLOUR,
        friction="0.9 0.005 0.0001",
    )  # fmt: skip
    for number, obstacle in enumerate(plan.obstacles, start=1):
        name = f"{obstacle.kind.value}_{number}"
        _add_box(world, name, obstacle.footprint, obstacle.height_m, _COLOURS[obstacle.kind])
    for number, pose in enumerate(people, start=1):
        _add_person(world, f"person_{number}", pose)
    world.append(robot)
    root.append(actuators)
    sensors = SubElement(root, "sensor")
    SubElement(sensors, "gyro", site="imu")
    SubElement(sensors, "accelerometer", site="imu")
    return tostring(root, encoding="unicode")


def numbers(*values: float) -> str:
    """The values as an attribute."""
    return " ".join(f"{value:.9g}" for value in values)


def add_geom(parent: Element, name: str, **attributes: str) -> Element:
    """A piece of geometry."""
    return SubElement(parent, "geom", {"name": name, **attributes})


def _add_box(world: Element, name: str, footprint: Rectangle, height_m: float, colour: str) -> None:
    low, high = footprint.corners[0], footprint.corners[2]
    add_geom(
        world, name, type="box",
        pos=numbers((low.x_m + high.x_m) / 2, (low.y_m + high.y_m) / 2, height_m / 2),
        size=numbers((high.x_m - low.x_m) / 2, (high.y_m - low.y_m) / 2, height_m / 2), rgba=colour,
    )  # fmt: skip


def _add_person(world: Element, name: str, pose: Pose) -> None:
    """An upright capsule."""
    body = SubElement(world, "body", name=name, mocap="true", pos=numbers(pose.x_m, pose.y_m, 0))
    add_geom(
        body, name, type="capsule", pos=numbers(0, 0, _PERSON_HEIGHT_M / 2),
        size=numbers(PERSON_RADIUS_M, _PERSON_HEIGHT_M / 2 - PERSON_RADIUS_M), rgba=_PERSON_COLOUR,
    )  # fmt: skip

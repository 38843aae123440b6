# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The warehouse and those who walk in it as MJCF, the model format of MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, tostring

from smarttestudo.domain.floor_plan import FloorPlan, ObstacleKind, Rectangle
from smarttestudo.simulation.geometry import Pose
from smarttestudo.simulation.physics.names import FLOOR

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


@dataclass(frozen=True, slots=True, kw_only=True)
class PersonSize:
    """An upright capsule."""

    radius_m: float = 0.22
    height_m: float = 1.7


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
    middle_x_m = (footprint.min_x_m + footprint.max_x_m) / 2
    middle_y_m = (footprint.min_y_m + footprint.max_y_m) / 2
    half_x_m = (footprint.max_x_m - footprint.min_x_m) / 2
    half_y_m = (footprint.max_y_m - footprint.min_y_m) / 2
    add_geom(
        world,
        name,
        type="box",
        pos=numbers(middle_x_m, middle_y_m, height_m / 2),
        size=numbers(half_x_m, half_y_m, height_m / 2),
        rgba=colour,
    )


def _add_person(world: Element, name: str, pose: Pose) -> None:
    size = PersonSize()
    body = SubElement(world, "body", name=name, mocap="true", pos=numbers(pose.x_m, pose.y_m, 0))
    half_m = size.height_m / 2 - size.radius_m
    add_geom(
        body,
        name,
        type="capsule",
        pos=numbers(0, 0, size.height_m / 2),
        size=numbers(size.radius_m, half_m),
        rgba=_PERSON_COLOUR,
    )

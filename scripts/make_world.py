# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Write worlds/warehouse.sdf, the demo's warehouse for Gazebo (gz sim), from its floor plan."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, Obstacle, ObstacleKind, Rectangle
from smarttestudo.simulation.warehouse import warehouse, warehouse_bounds

WORLD = Path(__file__).resolve().parent.parent / "worlds" / "warehouse.sdf"
NOTE = "<!-- Written by scripts/make_world.py; change src/smarttestudo/simulation/warehouse.py instead. -->"
SYSTEMS = {
    "gz-sim-physics-system": "gz::sim::systems::Physics",
    "gz-sim-user-commands-system": "gz::sim::systems::UserCommands",
    "gz-sim-scene-broadcaster-system": "gz::sim::systems::SceneBroadcaster",
    "gz-sim-sensors-system": "gz::sim::systems::Sensors",
    "gz-sim-imu-system": "gz::sim::systems::Imu",
}
OBSTACLE_COLOURS = {
    ObstacleKind.WALL: "0.75 0.75 0.72 1",
    ObstacleKind.RACK: "0.20 0.35 0.60 1",
    ObstacleKind.UPRIGHT: "0.90 0.65 0.10 1",
}
FLOOR_COLOUR = "0.55 0.55 0.55 1"
ZONE_COLOURS = {"Warehouse Corridor": "0.45 0.60 0.45 1", "Scaffolding": "0.65 0.45 0.40 1"}
# Thin enough to drive over, thick enough not to flicker in the floor.
ZONE_HEIGHT_M = 0.002


def world(plan: FloorPlan) -> str:
    """The SDF of ``plan``: floor, zones as colours on it, and all that stands there."""
    sdf = Element("sdf", version="1.8")
    root = SubElement(sdf, "world", name="warehouse")
    for filename, name in SYSTEMS.items():
        system = SubElement(root, "plugin", filename=filename, name=name)
        if name.endswith("Sensors"):
            SubElement(system, "render_engine").text = "ogre2"
    add_light(root)
    add_floor(root, warehouse_bounds())
    add_zones(root, plan.zones)
    for kind in ObstacleKind:
        add_obstacles(root, kind, [one for one in plan.obstacles if one.kind is kind])
    indent(sdf)
    return f'<?xml version="1.0"?>\n{NOTE}\n{tostring(sdf, encoding="unicode")}\n'


def add_light(root: Element) -> None:
    """The lamps under the roof, as one light from above."""
    light = SubElement(root, "light", name="roof", type="directional")
    SubElement(light, "direction").text = "-0.3 0.2 -1"
    SubElement(light, "diffuse").text = "0.9 0.9 0.9 1"
    SubElement(light, "cast_shadows").text = "false"


def add_floor(root: Element, bounds: Rectangle) -> None:
    """A plane that ends at the walls to the eye and nowhere to the wheels."""
    link = add_static_link(root, "floor")
    collision = SubElement(link, "collision", name="floor")
    SubElement(SubElement(SubElement(collision, "geometry"), "plane"), "normal").text = "0 0 1"
    visual = SubElement(link, "visual", name="floor")
    SubElement(visual, "pose").text = pose(bounds, z_m=0.0)
    plane = SubElement(SubElement(visual, "geometry"), "plane")
    SubElement(
        plane, "size"
    ).text = f"{length(bounds.max_x_m - bounds.min_x_m)} {length(bounds.max_y_m - bounds.min_y_m)}"
    add_colour(visual, FLOOR_COLOUR)


def add_zones(root: Element, zones: Iterable[FloorZone]) -> None:
    """The security zones: to be seen, not to be felt."""
    link = add_static_link(root, "zones")
    for zone in zones:
        visual = SubElement(link, "visual", name=zone.name)
        add_box(visual, zone.area, ZONE_HEIGHT_M)
        add_colour(visual, ZONE_COLOURS[zone.name])


def add_obstacles(root: Element, kind: ObstacleKind, obstacles: Iterable[Obstacle]) -> None:
    """All obstacles of one kind, as one model."""
    link = add_static_link(root, f"{kind.value}s")
    for number, obstacle in enumerate(obstacles, start=1):
        name = f"{kind.value}_{number}"
        add_box(SubElement(link, "collision", name=name), obstacle.footprint, obstacle.height_m)
        visual = SubElement(link, "visual", name=name)
        add_box(visual, obstacle.footprint, obstacle.height_m)
        add_colour(visual, OBSTACLE_COLOURS[kind])


def add_static_link(root: Element, name: str) -> Element:
    """A model that stays where it is, with one link."""
    model = SubElement(root, "model", name=name)
    SubElement(model, "static").text = "true"
    return SubElement(model, "link", name="link")


def add_box(parent: Element, footprint: Rectangle, height_m: float) -> None:
    """A box that stands on the floor."""
    SubElement(parent, "pose").text = pose(footprint, z_m=height_m / 2)
    sides_m = (footprint.max_x_m - footprint.min_x_m, footprint.max_y_m - footprint.min_y_m, height_m)
    box = SubElement(SubElement(parent, "geometry"), "box")
    SubElement(box, "size").text = " ".join(length(side_m) for side_m in sides_m)


def add_colour(visual: Element, colour: str) -> None:
    """The same in every light."""
    material = SubElement(visual, "material")
    for part in ("ambient", "diffuse"):
        SubElement(material, part).text = colour


def pose(footprint: Rectangle, *, z_m: float) -> str:
    """Above the middle of ``footprint``, unturned."""
    x_m = (footprint.min_x_m + footprint.max_x_m) / 2
    y_m = (footprint.min_y_m + footprint.max_y_m) / 2
    return f"{length(x_m)} {length(y_m)} {length(z_m)} 0 0 0"


def length(metres: float) -> str:
    """To the millimetre."""
    return f"{round(metres, 3):g}"


def main() -> None:
    """Write the world."""
    WORLD.parent.mkdir(parents=True, exist_ok=True)
    WORLD.write_text(world(warehouse()), encoding="utf-8")
    print(f"wrote {WORLD}")


if __name__ == "__main__":
    main()

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor of a report: zones that rules name, maps that nav2 drives by, and where the robot was."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.robot_path import PathPoint, PosePlaces, TransformPlaces, places_in, rule_zones
from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, OccupancyMap, Rectangle
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import ns_from_s
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.report.floor_map import MOST_STRIPS, map_frame, occupied_cells
from smarttestudo.ruler.files.nav2_map import MapError, read_nav2_map

INF = math.inf
ODOM = Channel(topic="/odom", type_name="nav_msgs/msg/Odometry")
LOCALIZED = "geometry_msgs/msg/PoseWithCovarianceStamped"
TF = Channel(topic="/tf", type_name="tf2_msgs/msg/TFMessage")


def zones_of(*conditions: str) -> list[tuple[str, tuple[float, float, float, float]]]:
    blocks = "\n".join(
        f'Rule "{name}" If ({condition}) Then SetFrequency /odom 1 EndIf'
        for name, condition in zip("ABCDE", conditions, strict=False)
    )
    rule_set = compile_rules([parse(f"begin\n{blocks}\nend\n", "rules").file], resolve_topic)
    return [(zone.name, sides(zone)) for zone in rule_zones(rule_set)]


def sides(zone: FloorZone) -> tuple[float, float, float, float]:
    area = zone.area
    return area.min_x_m, area.max_x_m, area.min_y_m, area.max_y_m


def test_a_rule_about_x_and_y_has_a_zone_of_its_name() -> None:
    condition = " AND ".join(
        f"CheckValue /odom {check}"
        for check in ("pose_x > -13", "pose_x < 6", "pose_y >= 1", "pose_y <= 5.4")
    )
    assert zones_of(condition) == [("A", (-13, 6, 1, 5.4))]


def test_a_side_that_no_check_bounds_is_infinitely_far() -> None:
    assert zones_of("CheckValue /odom pose_y > 2") == [("A", (-INF, INF, 2, INF))]


def test_a_choice_of_places_has_a_zone_each_and_other_rules_have_none() -> None:
    corner = "(CheckValue /odom pose_x < {0} AND CheckValue /odom pose_y < {0})"
    assert zones_of(
        f"{corner.format(1)} OR {corner.format(2)}",
        "CheckValue /scan distance < 0.5",
        "CheckValue /odom pose_x < 1 OR CheckValue /scan distance < 1",
        "CheckValue /odom pose_x != 1",
        "CheckValue /odom pose_x > 2 AND CheckValue /odom pose_x < 1",
    ) == [("A", (-INF, 1, -INF, 1)), ("A", (-INF, 2, -INF, 2))]


def test_a_zone_without_end_does_not_widen_the_map() -> None:
    path = [PathPoint(t_s=0, x_m=0, y_m=0), PathPoint(t_s=1, x_m=8, y_m=4)]
    far = FloorZone(name="A", area=Rectangle(min_x_m=-INF, max_x_m=1e9, min_y_m=2, max_y_m=INF))
    assert map_frame(FloorPlan(zones=(far,)), path) == map_frame(FloorPlan(), path)


def write_map(folder: Path, cells: list[list[int]], **values: object) -> Path:
    """Rows from the top, 0 black … 255 white; origin and resolution as nav2 writes them."""
    Image.fromarray(np.array(cells, np.uint8)).save(folder / "map.pgm")
    header = {"image": "map.pgm", "resolution": 0.5, "origin": "[-1.0, -2.0, 0.0]", "negate": 0, **values}
    path = folder / "map.yaml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in header.items()))
    return path


def test_dark_cells_of_a_map_are_occupied_and_its_rows_run_upwards(tmp_path: Path) -> None:
    found = read_nav2_map(write_map(tmp_path, [[0, 254], [205, 254], [254, 0]]))
    assert found.rows == ((False, True), (False, False), (True, False))
    assert (found.cell_m, found.origin_x_m, found.origin_y_m) == (0.5, -1.0, -2.0)
    assert (found.width_m, found.height_m) == (1.0, 1.5)


def test_a_negative_map_and_its_threshold_are_read_as_they_say(tmp_path: Path) -> None:
    path = write_map(tmp_path, [[0, 100, 254]], negate=1, occupied_thresh=0.3)
    assert read_nav2_map(path).rows == ((False, True, True),)


def test_a_large_map_is_read_in_fewer_cells_and_keeps_every_obstacle(tmp_path: Path) -> None:
    cells = [[254] * 2000 for _ in range(1000)]
    cells[3][1999] = 0
    found = read_nav2_map(write_map(tmp_path, cells))
    assert len(found.rows) <= 600
    assert sum(map(sum, found.rows)) == 1
    assert found.width_m == pytest.approx(1000, abs=2)


@pytest.mark.parametrize(
    ("values", "cause"),
    [
        ({"image": "nowhere.pgm"}, "nowhere.pgm: error: the map's image cannot be read: No such file"),
        ({"image": "map.yaml"}, "map.yaml: error: the map's image cannot be read: not an image"),
        ({"origin": "[1]"}, "not a nav2 map"),
        ({"resolution": 0}, "not a nav2 map"),
        ({"resolution": "[[["}, "not a nav2 map"),
    ],
)
def test_what_is_no_map_is_refused_in_one_line(tmp_path: Path, values: dict[str, Any], cause: str) -> None:
    with pytest.raises(MapError) as refused:
        read_nav2_map(write_map(tmp_path, [[0]], **values))
    assert cause in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_map_full_of_small_obstacles_is_drawn_in_a_bounded_shape() -> None:
    chessboard = tuple(tuple((x + y) % 2 == 0 for x in range(300)) for y in range(300))
    occupancy = OccupancyMap(rows=chessboard, cell_m=0.1, origin_x_m=0, origin_y_m=0)
    frame = map_frame(FloorPlan(occupancy=occupancy), [])
    assert frame is not None
    assert 0 < occupied_cells(occupancy, frame).html.count("M") <= MOST_STRIPS


def test_a_turned_map_is_framed_whole() -> None:
    occupancy = OccupancyMap(
        rows=((True,) * 4,), cell_m=1, origin_x_m=1, origin_y_m=2, yaw_rad=math.radians(90)
    )
    frame = map_frame(FloorPlan(occupancy=occupancy), [])
    assert frame is not None
    (low_x_m, high_x_m), (low_y_m, high_y_m) = frame.x.values, frame.y.values
    assert low_x_m < 0 < 1 < high_x_m < 4  # noqa: PLR0133 - the corner lies within
    assert low_y_m < 2 < 6 < high_y_m  # noqa: PLR0133


class Decoded(RosbagDecoder):
    """A decoder of messages that are decoded already."""

    def decode(self, channel: Channel, payload: Any) -> object:
        return payload


def link(parent: str, child: str, x: float, y: float, yaw_degrees: float) -> SimpleNamespace:
    half_rad = math.radians(yaw_degrees) / 2
    return SimpleNamespace(
        header=SimpleNamespace(frame_id=parent),
        child_frame_id=child,
        transform=SimpleNamespace(
            translation=SimpleNamespace(x=x, y=y, z=0.0),
            rotation=SimpleNamespace(x=0.0, y=0.0, z=math.sin(half_rad), w=math.cos(half_rad)),
        ),
    )


def test_a_path_by_transforms_is_the_robots_base_in_the_map() -> None:
    places = TransformPlaces([TF], Decoded(), 0)
    chain: Any = SimpleNamespace(
        transforms=[link("map", "odom", 10, 0, 90), link("odom", "base_footprint", 2, 1, 30)]
    )
    moved: Any = SimpleNamespace(transforms=[link("odom", "base_footprint", 3, 1, 30)])
    places.on_message(TF, 0, chain)
    places.on_message(TF, ns_from_s(0.1), moved)
    places.on_message(TF, ns_from_s(0.3), moved)
    found = [(point.t_s, round(point.x_m, 9), round(point.y_m, 9)) for point in places.path]
    assert found == [(0.0, 9, 2), (0.3, 9, 3)]


def test_transforms_in_a_circle_come_to_an_end() -> None:
    places = TransformPlaces([TF], Decoded(), 0)
    circle: Any = SimpleNamespace(
        transforms=[link("a", "base_link", 1, 0, 0), link("base_link", "a", 1, 0, 0)]
    )
    places.on_message(TF, 0, circle)
    assert len(places.path) == 1


def test_a_robot_is_followed_by_odometry_and_by_transforms_where_a_map_asks_for_them() -> None:
    other = Channel(topic="/a/odometry", type_name=ODOM.type_name)
    follow = {by: places_in([TF, other, ODOM], Decoded(), 0, by_transforms=by) for by in (False, True)}
    plain = follow[False]
    assert plain is not None
    assert plain.source == "/odom"
    assert isinstance(follow[True], TransformPlaces)
    assert isinstance(places_in([TF], Decoded(), 0, by_transforms=False), TransformPlaces)
    assert isinstance(places_in([ODOM], Decoded(), 0, by_transforms=False), PosePlaces)
    assert places_in([], Decoded(), 0, by_transforms=False) is None


def pose(frame: str, x: float) -> Any:
    place = SimpleNamespace(position=SimpleNamespace(x=x, y=0.0))
    return SimpleNamespace(header=SimpleNamespace(frame_id=frame), pose=SimpleNamespace(pose=place))


@pytest.mark.parametrize(
    ("frame", "expected"), [("map", ("/amcl_pose", 9.6)), ("odom_2", ("/odom", 0.0)), (None, ("/odom", 0.0))]
)
def test_a_robot_that_knows_its_place_in_the_map_is_where_that_says(
    frame: str | None, expected: tuple[str, float]
) -> None:
    amcl, said = (Channel(topic=name, type_name=LOCALIZED) for name in ("/amcl_pose", "/initialpose"))
    places = places_in([said, ODOM, amcl], Decoded(), 0, by_transforms=False)
    assert places is not None
    places.on_message(ODOM, 0, pose("odom", 0.0))
    places.on_message(said, 0, pose("map", 5.0))
    if frame is not None:
        places.on_message(amcl, 0, pose(frame, 9.6))
    assert (places.source, places.path[0].x_m) == expected

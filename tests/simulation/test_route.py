# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Routes and tours, and robots that are steered along them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby, pairwise, takewhile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulation.missions import START_NS, of_topic
from smarttestudo.domain.errors import MissionError
from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import Pose
from smarttestudo.simulation.messages import RobotTopic
from smarttestudo.simulation.mission import drive_mission
from smarttestudo.simulation.robot import DifferentialDrive, DriveModel
from smarttestudo.simulation.route import Route, Tour, Waypoint, load_mission
from smarttestudo.simulation.steering import PurePursuit, WaypointFollower
from smarttestudo.simulation.warehouse import warehouse

SQUARE = [Point(0.0, 0.0), Point(4.0, 0.0), Point(4.0, 4.0), Point(0.0, 4.0)]


@given(radius_m=st.floats(0.2, 1.9))
@settings(max_examples=20, deadline=None)
def test_each_rounded_corner_of_a_square_saves_two_radii_less_a_quarter_circle(radius_m: float) -> None:
    route = Route.through(SQUARE, corner_radius_m=radius_m)

    # The arcs are drawn as chords of 5 cm, which are a little shorter.
    assert route.length_m == pytest.approx(16 - 4 * (2 - math.pi / 2) * radius_m, rel=1e-3)


@given(travelled_m=st.floats(0, 50), step_m=st.floats(0.001, 0.2))
@settings(max_examples=50, deadline=None)
def test_places_lie_no_further_apart_than_the_route_between_them(travelled_m: float, step_m: float) -> None:
    route = Route.through(SQUARE, corner_radius_m=0.5)

    assert route.at(travelled_m).distance_m(route.at(travelled_m + step_m)) <= step_m + 1e-9


def test_a_route_turns_right_and_left_and_ends_where_it_starts() -> None:
    zigzag = [
        Point(0.0, 0.0),
        Point(3.0, 0.0),
        Point(3.0, 3.0),
        Point(6.0, 3.0),
        Point(6.0, 6.0),
        Point(0.0, 6.0),
    ]
    route = Route.through(zigzag, corner_radius_m=0.5)

    assert route.points[0] == route.points[-1]
    assert max(a.distance_m(b) for a, b in pairwise(route.points)) < 5.1
    headings = [math.atan2(b.y_m - a.y_m, b.x_m - a.x_m) for a, b in pairwise(route.points) if a != b]
    assert max(abs(math.remainder(b - a, math.tau)) for a, b in pairwise(headings)) < 0.2


@pytest.mark.parametrize("aside_m", [-0.3, 0.3])
def test_a_robot_beside_its_route_comes_back_to_it(aside_m: float) -> None:
    route = Route.through(SQUARE, corner_radius_m=0.5)
    model = DriveModel()
    drive = DifferentialDrive(model, pose=Pose(2.0, aside_m, 0.0), now_ns=0)
    pursuit = PurePursuit(route, model)

    for tick in range(1, 101):
        drive.command(pursuit.command(drive))
        drive.advance_to(tick * NS_PER_S // 10)

    here = Point(drive.pose.x_m, drive.pose.y_m)
    assert min(here.distance_m(route.at(step * 0.02)) for step in range(800)) < 0.06
    assert pursuit.travelled_m > 2.0


ERRANDS = Path(__file__).parents[2] / "examples" / "errands.mission.toml"
ROUND_S = 460
STILL_M_PER_S = 0.005
STILL_RAD_PER_S = 0.01


@dataclass(frozen=True, kw_only=True)
class Moment:
    """The true state of the robot at one time."""

    t_s: float
    place: Point
    yaw_rad: float
    linear_m_per_s: float
    angular_rad_per_s: float

    @property
    def stands(self) -> bool:
        return abs(self.linear_m_per_s) < STILL_M_PER_S and abs(self.angular_rad_per_s) < STILL_RAD_PER_S


def drive(tour: Tour, seconds: float) -> list[Moment]:
    """The state ten times a second."""
    model = DriveModel()
    robot = DifferentialDrive(model, pose=tour.start, now_ns=0)
    follower = WaypointFollower(tour, model)
    moments = []
    for tick in range(1, round(seconds * 10)):
        robot.command(follower.command(robot))
        robot.advance_to(tick * NS_PER_S // 10)
        velocity = robot.velocity
        moments.append(
            Moment(
                t_s=tick / 10,
                place=Point(robot.pose.x_m, robot.pose.y_m),
                yaw_rad=robot.pose.yaw_rad,
                linear_m_per_s=velocity.linear_m_per_s,
                angular_rad_per_s=velocity.angular_rad_per_s,
            )
        )
    return moments


@pytest.fixture(scope="module")
def errands() -> Tour:
    return load_mission(ERRANDS, warehouse())


@pytest.fixture(scope="module")
def moments(errands: Tour) -> list[Moment]:
    """A whole round of the example."""
    return drive(errands, ROUND_S)


def test_the_robot_pauses_where_and_as_long_as_the_file_says(moments: list[Moment]) -> None:
    stops = [list(group) for stands, group in groupby(moments, key=lambda moment: moment.stands) if stands]
    pauses = [group for group in stops if len(group) > 20]

    asked = [(10.8, 5.0, 40), (-5.0, 3.0, 15), (-5.0, 8.2, 40), (2.0, 8.8, 20), (10.8, 5.0, 40)]
    for group, (x_m, y_m, pause_s) in zip(pauses, asked, strict=True):
        assert group[0].place.distance_m(Point(x_m, y_m)) < 0.12
        if group is not pauses[-1]:
            assert len(group) / 10 == pytest.approx(pause_s, abs=0.5)


def test_it_turns_on_the_spot_and_is_in_more_or_less_of_a_hurry(moments: list[Moment]) -> None:
    turning = [m for m in moments if abs(m.angular_rad_per_s) > 0.3 and abs(m.linear_m_per_s) < 0.01]
    driving = [round(m.linear_m_per_s, 2) for m in moments if m.linear_m_per_s > 0.01]

    assert any(m.place.distance_m(Point(-5.0, 3.0)) < 0.12 for m in turning)
    assert max(abs(m.angular_rad_per_s) for m in turning) > 0.8
    assert {0.15, 0.25, 0.26} <= {speed for speed in driving if driving.count(speed) > 50}
    assert max(driving) <= DriveModel().max_linear_m_per_s


def test_speeds_change_as_fast_as_the_wheels_can_at_most(moments: list[Moment]) -> None:
    for before, after in pairwise(moments):
        # 1 m/s² each, for a tenth of a second; 0.287 m apart.
        assert abs(after.linear_m_per_s - before.linear_m_per_s) <= 0.1 + 1e-9
        assert abs(after.angular_rad_per_s - before.angular_rad_per_s) <= 0.2 / 0.287 + 1e-9


def test_commands_change_by_what_the_velocity_smoother_allows() -> None:
    tour = load_mission(ERRANDS, warehouse())
    end_ns = START_NS + 60 * NS_PER_S
    timed = list(
        takewhile(lambda reading: reading.time_ns < end_ns, drive_mission(tour, seed=1, start_ns=START_NS))
    )
    commands = of_topic(timed, RobotTopic.CMD_VEL)

    assert len(commands) == pytest.approx(600, abs=2)
    for before, after in pairwise(commands):
        assert abs(after.linear.x - before.linear.x) <= 0.25 + 1e-9
        assert abs(after.angular.z - before.angular.z) <= 0.32 + 1e-9


def test_it_stays_on_its_way_and_touches_nothing(errands: Tour, moments: list[Moment]) -> None:
    plan, route = warehouse(), errands.route
    line = [route.at(step * 0.05) for step in range(math.ceil(route.length_m / 0.05))]

    for moment in moments[::5]:
        assert min(moment.place.distance_m(point) for point in line) < 0.15
        assert plan.clearance_m(moment.place) > DriveModel().radius_m


def test_rounds_without_a_pause_never_stop() -> None:
    square = [Point(0, 0), Point(4, 0), Point(4, 4), Point(0, 4)]
    tour = Tour([Waypoint(place=place) for place in square])

    driven = drive(tour, 200)

    assert all(moment.linear_m_per_s > 0.05 for moment in driven if moment.t_s > 2)
    # Two rounds of about 15 m at 0.25 m/s, with arcs; turned by four right angles in each.
    assert driven[-1].yaw_rad > 2 * math.tau


GOOD = "[[waypoints]]\nat_m = [10.8, 5]\n[[waypoints]]\nat_m = [10.8, 3]\n[[waypoints]]\nat_m = [5, 3]\n"


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("waypoints = 3", "not the waypoints of a mission"),
        (GOOD + "speed = 1\n", "waypoint 3: error: not a waypoint"),
        ("speed = 1\n" + GOOD, "not the waypoints of a mission"),
        (GOOD.replace("[10.8, 3]", "[10.8]"), "waypoint 2: error: at_m must be [x, y] in metres"),
        (GOOD.replace("[10.8, 3]", '[10.8, "3"]'), "waypoint 2: error: at_m must be a number"),
        (GOOD.replace("[10.8, 3]", "[nan, 3]"), "waypoint 2: error: at_m must be a number"),
        (GOOD + "pause_s = -1\n", "waypoint 3: error: pause_s must be a number from 0 to 86400"),
        (GOOD + "pause_s = true\n", "waypoint 3: error: pause_s must be a number"),
        (GOOD + "speed_m_per_s = 0.5\n", "speed_m_per_s must be a number from 0.05 to 0.26"),
        (GOOD.replace("[10.8, 3]", "[10.8, 4.9]"), "the way from waypoint 1 to the next is 0.10 m"),
        (GOOD + "pause_s = 1\n", "the robot would touch something at"),
        (GOOD + "= 3\n", "mission.toml:7:1: error: not valid TOML"),
    ],
)
def test_a_mission_that_cannot_be_driven_is_refused_with_its_place(
    text: str, cause: str, tmp_path: Path
) -> None:
    path = tmp_path / "mission.toml"
    path.write_text(text, encoding="utf-8")

    with pytest.raises(MissionError) as refused:
        load_mission(path, warehouse())

    assert cause in str(refused.value)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)


# South of the warehouse nothing is in the way.
STRAIGHT_THROUGH = [(4.0, -16.0, 0), (10.0, -16.0, 0), (16.0, -16.0, 0), (16.0, -12.0, 1)]
TWICE = (10.0, -16.0, 0)


def mission_through(waypoints: list[tuple[float, float, int]], path: Path) -> Tour:
    tables = [
        f"[[waypoints]]\nat_m = [{x_m}, {y_m}]\npause_s = {pause_s}\n" for x_m, y_m, pause_s in waypoints
    ]
    path.write_text("".join(tables), encoding="utf-8")
    return load_mission(path, warehouse())


def test_each_visit_of_a_place_has_the_corner_of_its_own_way(tmp_path: Path) -> None:
    path = tmp_path / "mission.toml"
    straight = [(9.5, -16.5, 1), TWICE, (10.5, -15.5, 1)]
    sharp = [(11.0, -15.2, 1), TWICE, (10.3, -15.1, 1)]
    corner = [(4.0, -16.0, 0), TWICE, (6.0, -12.5, 1), (6.0, -13.0, 1)]

    assert mission_through([*corner, *straight, (4.0, -14.0, 1)], path).route.length_m > 20

    with pytest.raises(MissionError, match=r"the way from waypoint 5 to the next is 1\.28 m"):
        mission_through([*STRAIGHT_THROUGH, *sharp], path)


def test_a_mission_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(MissionError, match="the mission cannot be read: No such file"):
        load_mission(tmp_path / "none.toml", warehouse())

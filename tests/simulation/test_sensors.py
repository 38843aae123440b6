# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import math
from collections import defaultdict
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from simulation.missions import driven, of_topic, poses, stamp_ns
from smarttestudo.domain.floor_plan import FloorPlan, Obstacle, ObstacleKind, Point, Rectangle
from smarttestudo.simulation.camera import FrameSize, raspberry_pi_lens, render
from smarttestudo.simulation.geometry import Pose, Quaternion
from smarttestudo.simulation.messages import RobotTopic, TimedMessage
from smarttestudo.simulation.robot import OPTICAL_FRAME, DifferentialDrive, DriveModel, fixed_frames
from smarttestudo.simulation.sensors import GRAVITY_M_PER_S2, Lidar, RayCaster, level_cast
from smarttestudo.simulation.warehouse import warehouse


@pytest.mark.full
def test_a_scan_is_360_rays_within_the_range_or_infinite(patrol_messages: list[TimedMessage]) -> None:
    ranges_m = np.array([scan.ranges for scan in of_topic(patrol_messages, RobotTopic.SCAN)])

    assert ranges_m.shape == (1000, 360)
    finite = ranges_m[np.isfinite(ranges_m)]
    assert finite.min() >= 0.12
    assert finite.max() <= 3.5
    assert np.all(ranges_m[~np.isfinite(ranges_m)] == np.inf)
    assert 0.05 < np.isinf(ranges_m).mean() < 0.95


@pytest.mark.full
def test_a_scan_measures_the_walls_from_where_the_odometry_says_the_lidar_is(
    patrol_messages: list[TimedMessage],
) -> None:
    odometry = poses(patrol_messages)
    caster = RayCaster(warehouse())
    bearings_rad = np.arange(360) * math.tau / 360
    errors = []
    for scan in of_topic(patrol_messages, RobotTopic.SCAN)[::25]:
        pose = odometry[min(odometry, key=lambda at_ns: abs(at_ns - stamp_ns(scan)))]
        origin = pose.ahead(DriveModel().scan_x_m)
        true_m = caster.cast(origin, bearings_rad + pose.yaw_rad, range_m=10).distances_m
        measured = np.isfinite(scan.ranges)
        errors.append(scan.ranges[measured] - true_m[measured])

    # 20 ms between the two readings are 5 mm of driving; the rest is the sensor's noise of 10 mm.
    assert np.median(np.abs(np.concatenate(errors))) < 0.012


def test_an_obstacle_too_near_reads_minus_infinite() -> None:
    parked = DifferentialDrive(DriveModel(scan_x_m=0.0), pose=Pose(13.95, 11.0, 0.0), now_ns=0)

    lidar = Lidar(level_cast(RayCaster(warehouse())), np.random.default_rng(0))
    ((_, scan),) = lidar.sample(parked)

    assert cast("Any", scan).ranges[0] == -np.inf


@pytest.mark.full
def test_the_imu_feels_gravity_and_the_turns_that_the_odometry_shows(
    patrol_messages: list[TimedMessage],
) -> None:
    imu = of_topic(patrol_messages, RobotTopic.IMU)
    way = list(poses(patrol_messages).values())
    last = of_topic(patrol_messages, RobotTopic.ODOM)[-1]

    turned_rad = sum(r.angular_velocity.z for r in imu) / 195
    gained_m_per_s = sum(r.linear_acceleration.x for r in imu) / 195

    assert np.mean([r.linear_acceleration.z for r in imu]) == pytest.approx(GRAVITY_M_PER_S2, abs=1e-3)
    assert turned_rad == pytest.approx(way[-1].yaw_rad - way[0].yaw_rad, abs=0.01)
    assert gained_m_per_s == pytest.approx(last.twist.twist.linear.x, abs=0.06)


def test_the_frames_form_one_tree_from_odom_to_the_sensors(patrol_messages: list[TimedMessage]) -> None:
    (static,) = of_topic(patrol_messages, RobotTopic.TF_STATIC)
    moving = of_topic(patrol_messages, RobotTopic.TF)
    frames = [frame for message in (static, *moving) for frame in message.transforms]
    parents = {frame.child_frame_id: frame.header.frame_id for frame in frames}

    for sensor in (
        "base_scan",
        "imu_link",
        "camera_rgb_optical_frame",
        "wheel_left_link",
        "wheel_right_link",
    ):
        link = sensor
        while link in parents:
            link = parents[link]
        assert link == "odom"
    for frame in frames:
        q = frame.transform.rotation
        assert math.hypot(q.x, q.y, q.z, q.w) == pytest.approx(1.0, abs=1e-12)


def test_transforms_come_as_from_gazebo_and_a_robot_state_publisher(
    patrol_messages: list[TimedMessage],
) -> None:
    stamps_ns: dict[tuple[str, ...], set[int]] = defaultdict(set)
    for message in of_topic(patrol_messages, RobotTopic.TF):
        stamps_ns[tuple(frame.child_frame_id for frame in message.transforms)].add(stamp_ns(message))
    assert stamps_ns.keys() == {("base_footprint",), ("wheel_left_link", "wheel_right_link")}
    odometry = set(map(stamp_ns, of_topic(patrol_messages, RobotTopic.ODOM)))
    joints = set(map(stamp_ns, of_topic(patrol_messages, RobotTopic.JOINT_STATES)))
    assert len(stamps_ns["base_footprint",] ^ odometry) <= 1
    assert len(stamps_ns["wheel_left_link", "wheel_right_link"] ^ joints) <= 1


def test_the_optical_frame_looks_along_the_robots_heading() -> None:
    rotation = next(frame.rotation for frame in fixed_frames(DriveModel()) if frame.child == OPTICAL_FRAME)
    back = Quaternion(-rotation.x, -rotation.y, -rotation.z, rotation.w)

    ahead = rotation.then(Quaternion(0.0, 0.0, 1.0, 0.0)).then(back)
    right = rotation.then(Quaternion(1.0, 0.0, 0.0, 0.0)).then(back)

    assert (ahead.x, ahead.y, ahead.z) == pytest.approx((1, 0, 0), abs=1e-12)
    assert (right.x, right.y, right.z) == pytest.approx((0, -1, 0), abs=1e-12)


def test_the_camera_looks_from_where_its_frame_is() -> None:
    model = DriveModel()
    frames = {frame.child: frame for frame in fixed_frames(model)}
    chain = [frames[child].translation for child in ("base_link", "camera_link", "camera_rgb_frame")]

    assert sum(step.x for step in chain) == pytest.approx(model.camera_x_m)
    assert sum(step.z for step in chain) == pytest.approx(model.camera_height_m)


def test_full_images_change_nothing_but_the_images() -> None:
    small, full = driven(0.3), driven(0.3, frames=FrameSize.FULL)
    camera = {RobotTopic.IMAGE, RobotTopic.COMPRESSED_IMAGE, RobotTopic.CAMERA_INFO}

    assert [r.time_ns for r in small] == [r.time_ns for r in full]
    assert repr([r for r in small if r.topic not in camera]) == repr(
        [r for r in full if r.topic not in camera]
    )
    image = of_topic(full, RobotTopic.IMAGE)[0]
    assert (image.height, image.width, len(image.data)) == (1080, 1920, 6_220_800)


FREE_PLACES = st.builds(Point, st.floats(-12.9, 13.9), st.floats(-7.9, 25.4)).filter(
    lambda place: warehouse().clearance_m(place) > 0.01
)


def _slab_distance_m(plan: FloorPlan, origin: Point, bearing_rad: float) -> float:
    """The naive second opinion: one ray, one box at a time, by clipping against its slabs."""
    direction = (math.cos(bearing_rad), math.sin(bearing_rad))
    best = math.inf
    for obstacle in plan.obstacles:
        box = obstacle.footprint
        enter, leave = 0.0, math.inf
        for start, step, low, high in (
            (origin.x_m, direction[0], box.min_x_m, box.max_x_m),
            (origin.y_m, direction[1], box.min_y_m, box.max_y_m),
        ):
            if step == 0:
                if not low <= start <= high:
                    leave = -1.0
                continue
            first, second = sorted(((low - start) / step, (high - start) / step))
            enter, leave = max(enter, first), min(leave, second)
        if enter <= leave:
            best = min(best, enter)
    return best


@settings(max_examples=30, deadline=None)
@example(place=Point(0.0, 0.0), turn_rad=5e-324)
@given(place=FREE_PLACES, turn_rad=st.floats(0, math.tau))
def test_casting_agrees_with_clipping_each_ray_against_each_box(place: Point, turn_rad: float) -> None:
    plan = warehouse()
    bearings_rad = turn_rad + np.linspace(0, math.tau, 90, endpoint=False)

    hits = RayCaster(plan).cast(place, bearings_rad, range_m=100.0)

    expected_m = [_slab_distance_m(plan, place, bearing_rad) for bearing_rad in bearings_rad.tolist()]
    # A ray that grazes a corner may meet or miss it by rounding: nothing else may differ.
    differing = np.flatnonzero(~np.isclose(hits.distances_m, expected_m, atol=1e-6))
    for ray in differing.tolist():
        nudged = [_slab_distance_m(plan, place, bearings_rad[ray] + nudge) for nudge in (-1e-7, 1e-7)]
        assert any(hits.distances_m[ray] == pytest.approx(distance_m, abs=1e-4) for distance_m in nudged)


def test_a_ray_names_the_obstacle_it_meets_and_none_beyond_its_range() -> None:
    boxes = [
        Rectangle(min_x_m=2, max_x_m=3, min_y_m=-1, max_y_m=1),
        Rectangle(min_x_m=-5, max_x_m=-4, min_y_m=-1, max_y_m=1),
    ]
    obstacles = tuple(Obstacle(kind=ObstacleKind.RACK, footprint=box, height_m=1.0) for box in boxes)
    plan = FloorPlan(obstacles=obstacles)

    hits = RayCaster(plan).cast(Point(0.0, 0.0), np.array([0.0, math.pi / 2, math.pi]), range_m=3.5)

    assert hits.distances_m.tolist() == [2.0, math.inf, math.inf]
    assert hits.obstacles.tolist() == [0, -1, -1]


def _view(distance_m: float) -> np.ndarray:
    rack = Rectangle(min_x_m=distance_m, max_x_m=distance_m + 1, min_y_m=-9, max_y_m=0.0)
    plan = FloorPlan(obstacles=(Obstacle(kind=ObstacleKind.RACK, footprint=rack, height_m=0.5),))
    lens = raspberry_pi_lens(FrameSize.FULL)
    return render(RayCaster(plan), Pose(0.0, 0.0, 0.0), 0.1, lens, np.random.default_rng(0))


def _is_blue(pixels: np.ndarray) -> np.ndarray:
    blue: np.ndarray = pixels[..., 2].astype(int) - pixels[..., 0] > 40
    return blue


def test_what_stands_to_the_right_is_on_the_right_of_the_image() -> None:
    blue = _is_blue(_view(2.0))

    assert not blue[:, :950].any()
    assert blue[:, 970:].any(axis=0).all()


@pytest.mark.parametrize("distance_m", [1.0, 2.0, 4.0])
def test_an_obstacle_covers_focal_length_times_height_over_distance(distance_m: float) -> None:
    focal_px = raspberry_pi_lens(FrameSize.FULL).focal_px

    rows = np.flatnonzero(_is_blue(_view(distance_m))[:, 965])

    assert rows.min() == pytest.approx(max(0, 540 - focal_px * 0.4 / distance_m), abs=0.5)
    assert rows.max() + 1 == pytest.approx(540 + focal_px * 0.1 / distance_m, abs=0.5)

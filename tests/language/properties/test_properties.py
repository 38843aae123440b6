# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What checks read of messages, on plain stand-ins with the fields of the ROS types."""

from __future__ import annotations

import math
from types import SimpleNamespace as Fields

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties import (
    conventional_types,
    gauges_for,
    is_field_path,
    property_spec,
    value_reader,
)

ODOMETRY = "nav_msgs/msg/Odometry"
SCAN = "sensor_msgs/msg/LaserScan"
BATTERY = "sensor_msgs/msg/BatteryState"
IMU = "sensor_msgs/msg/Imu"
JOINTS = "sensor_msgs/msg/JointState"


def xyz(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Fields:
    return Fields(x=x, y=y, z=z)


def turned(yaw: float) -> Fields:
    return Fields(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))


def odometry(*, yaw: float = 0.0, position: Fields | None = None, linear: Fields | None = None) -> Fields:
    pose = Fields(position=position or xyz(), orientation=turned(yaw))
    return Fields(
        pose=Fields(pose=pose), twist=Fields(twist=Fields(linear=linear or xyz(), angular=xyz(z=0.5)))
    )


def scan(*ranges: float) -> Fields:
    return Fields(range_min=0.12, range_max=3.5, ranges=list(ranges))


def test_odometry_gives_position_heading_and_velocities() -> None:
    message = odometry(yaw=math.pi / 2, position=xyz(1.0, 2.0, 3.0), linear=xyz(-3.0, 4.0))
    expected = {"pose_x": 1, "pose_y": 2, "pose_z": 3, "yaw": 90, "vel": -3, "speed": 5, "yaw_rate": 0.5}
    read = {name: value_reader(ODOMETRY, name)(message) for name in expected}
    assert read == pytest.approx(expected)


@pytest.mark.parametrize("type_name", ["PoseStamped", "PoseWithCovarianceStamped"])
def test_a_pose_gives_position_and_heading(type_name: str) -> None:
    pose = Fields(position=xyz(1.0, 2.0, 3.0), orientation=turned(math.pi / 2))
    message = Fields(pose=pose if type_name == "PoseStamped" else Fields(pose=pose))
    expected = {"pose_x": 1, "pose_y": 2, "pose_z": 3, "yaw": 90}
    read = {name: value_reader(f"geometry_msgs/msg/{type_name}", name)(message) for name in expected}
    assert read == pytest.approx(expected)


@pytest.mark.parametrize(
    ("topic", "types"),
    [
        ("/odom", (ODOMETRY,)),
        ("/tb3_0/odom", (ODOMETRY,)),
        ("/robot/imu/data", (IMU,)),
        ("/camera/image_raw", ("sensor_msgs/msg/Image",)),
        ("/camera/image_raw/compressed", ("sensor_msgs/msg/CompressedImage",)),
        ("/cmd_vel", ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")),
        ("/odom/covariance", ()),
        ("/wheel_odom", ()),
    ],
)
def test_topics_of_the_usual_names_have_conventional_types_in_any_namespace(
    topic: str, types: tuple[str, ...]
) -> None:
    assert conventional_types(topic) == types


@given(st.floats(-20, 20))
def test_yaw_lies_above_minus_180_and_up_to_180_degrees(yaw: float) -> None:
    degrees = value_reader(ODOMETRY, "yaw")(odometry(yaw=yaw))
    assert -180 < degrees <= 180
    assert math.cos(math.radians(degrees)) == pytest.approx(math.cos(yaw), abs=1e-9)


def test_facing_exactly_backwards_is_180_not_minus_180() -> None:
    message = Fields(orientation=Fields(x=0.0, y=0.0, z=-1.0, w=0.0))
    assert value_reader(IMU, "yaw")(message) == 180.0


def test_a_zero_quaternion_has_no_heading() -> None:
    message = Fields(orientation=Fields(x=0.0, y=0.0, z=0.0, w=0.0))
    assert all(math.isnan(value_reader(IMU, name)(message)) for name in ("roll", "pitch", "yaw"))


@pytest.mark.parametrize(
    ("ranges", "distance"),
    [
        ((1.0, 0.5, 2.0), 0.5),
        ((math.inf, math.inf), 3.5),
        ((2.0, -math.inf), 0.12),
        ((math.nan, 0.0, 0.05, 9.0, 1.5), 1.5),
    ],
)
def test_distance_is_the_nearest_valid_range(ranges: tuple[float, ...], distance: float) -> None:
    assert value_reader(SCAN, "distance")(scan(*ranges)) == distance


def test_a_scan_without_a_valid_range_is_unknown() -> None:
    read = value_reader(SCAN, "distance")
    assert math.isnan(read(scan(math.nan, 0.0, 99.0)))
    assert math.isnan(read(scan()))


def test_a_battery_in_fractions_is_scaled_until_it_shows_percent() -> None:
    read = value_reader(BATTERY, "level")
    levels = [read(Fields(percentage=value)) for value in (0.5, 1.0, 80.0, 0.9)]
    assert levels == [50.0, 100.0, 80.0, 0.9]


def test_the_profile_fixes_the_unit_of_a_battery() -> None:
    assert value_reader(BATTERY, "level", LevelUnit.PERCENT)(Fields(percentage=0.5)) == 0.5
    assert value_reader(BATTERY, "level", LevelUnit.FRACTION)(Fields(percentage=0.5)) == 50.0


def test_two_batteries_do_not_share_what_they_saw() -> None:
    first, second = value_reader(BATTERY, "level"), value_reader(BATTERY, "level")
    first(Fields(percentage=80.0))
    assert second(Fields(percentage=0.5)) == 50.0


def test_joints_report_the_greatest_magnitude_without_nan() -> None:
    message = Fields(velocity=[0.1, -2.0, math.nan], effort=[])
    assert value_reader(JOINTS, "max_velocity")(message) == 2.0
    assert math.isnan(value_reader(JOINTS, "max_effort")(message))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("pose.pose.position.x", 7.0),
        ("ranges[1]", 2.0),
        ("msg.rate", 5.0),
        ("armed", 1.0),
        ("rows[1].cells[0]", 9.0),
    ],
)
def test_any_numeric_field_is_read_by_its_path(path: str, value: float) -> None:
    message = odometry(position=xyz(7.0))
    message.ranges, message.rate, message.armed = [1.0, 2.0], 5, True
    message.rows = [Fields(cells=[8]), Fields(cells=[9])]
    assert value_reader("my_msgs/msg/Thing", path)(message) == value


@pytest.mark.parametrize("path", ["missing", "name", "ranges", "ranges[5]", "name[0]", "pose.pose"])
def test_what_is_not_a_number_is_unknown(path: str) -> None:
    message = odometry()
    message.name, message.ranges = "robot", [1.0]
    assert math.isnan(value_reader("my_msgs/msg/Thing", path)(message))


def test_a_message_of_another_type_is_unknown_not_an_error() -> None:
    assert math.isnan(value_reader(ODOMETRY, "pose_x")(Fields(data="x")))


@pytest.mark.parametrize(
    ("text", "valid"),
    [
        ("a.b[0].c", True),
        ("pose_x", True),
        ("a..b", False),
        ("_a", False),
        ("a[", False),
        ("a.__class__", False),
    ],
)
def test_field_paths_hold_ros_field_names_only(text: str, valid: bool) -> None:
    assert is_field_path(text) is valid


def test_ranges_of_properties_are_known_by_type_and_where_all_types_agree() -> None:
    level = property_spec(BATTERY, "level")
    assert level is not None
    assert (level.minimum, level.maximum) == (0.0, 100.0)
    assert property_spec(None, "yaw") is not None
    assert property_spec(ODOMETRY, "level") is None


@pytest.mark.parametrize("name", ["_x", "größe"])
def test_attributes_that_are_no_fields_are_unknown(name: str) -> None:
    message = Fields(_x=1.0, gr=1.0, größe=1.0)
    assert math.isnan(value_reader("geometry_msgs/msg/Point", name)(message))


NAN, INF = math.nan, math.inf


def imu(first_of_covariance: float) -> Fields:
    covariance = [first_of_covariance, *[0.0] * 8]
    return Fields(
        orientation=turned(0.5),
        orientation_covariance=covariance,
        angular_velocity=xyz(0.1),
        angular_velocity_covariance=covariance,
        linear_acceleration=xyz(0.1),
        linear_acceleration_covariance=covariance,
    )


def fix(status: int) -> Fields:
    return Fields(latitude=48.1, longitude=11.5, altitude=500.0, status=Fields(status=status))


def limited(range_min: float, range_max: float, *ranges: float) -> Fields:
    return Fields(range_min=range_min, range_max=range_max, ranges=list(ranges))


def sonar(min_range: float, max_range: float, value: float) -> Fields:
    return Fields(min_range=min_range, max_range=max_range, range=value)


RANGE, NAV_SAT_FIX = "sensor_msgs/msg/Range", "sensor_msgs/msg/NavSatFix"


@pytest.mark.parametrize(
    ("type_name", "message", "name", "value"),
    [
        *(
            (BATTERY, Fields(percentage=-1.0), name, NAN)
            for name in ("level", "percentage", "msg.percentage")
        ),
        (BATTERY, Fields(percentage=-0.01), "level", NAN),
        (BATTERY, Fields(percentage=NAN), "level", NAN),
        (BATTERY, Fields(percentage=0.0), "level", 0.0),
        (SCAN, limited(0.0, 0.0, INF), "distance", NAN),
        (SCAN, limited(0.0, 0.0, 0.0), "distance", NAN),
        (SCAN, limited(0.1, NAN, 1.0), "distance", NAN),
        (SCAN, limited(0.1, INF, 2.0), "distance", 2.0),
        (SCAN, limited(0.1, -1.0, 1.0), "ranges[0]", NAN),
        (SCAN, limited(0.0, 0.0, 1.0), "ranges[0]", NAN),
        (SCAN, limited(0.1, 9.0, 9.5), "ranges[0]", NAN),
        (SCAN, limited(0.1, 9.0, INF), "ranges[0]", INF),
        (SCAN, limited(0.1, 9.0, 2.0), "msg.ranges[0]", 2.0),
        (RANGE, sonar(0.0, 0.0, 1.0), "range", NAN),
        (RANGE, sonar(0.1, 4.0, 0.0), "msg.range", NAN),
        (RANGE, sonar(0.1, 4.0, -INF), "range", -INF),
        (RANGE, sonar(0.1, 4.0, 3.0), "range", 3.0),
        *((IMU, imu(-1.0), name, NAN) for name in ("roll", "pitch", "yaw", "acceleration", "angular_speed")),
        (IMU, imu(-1.0), "orientation.w", NAN),
        (IMU, imu(0.0), "linear_acceleration.x", 0.1),
        (IMU, imu(0.0), "angular_speed", 0.1),
        (NAV_SAT_FIX, fix(-1), "latitude", NAN),
        (NAV_SAT_FIX, fix(-1), "status.status", -1.0),
        (NAV_SAT_FIX, fix(0), "altitude", 500.0),
        ("p/msg/Own", Fields(percentage=-1.0), "percentage", -1.0),
    ],
)
def test_a_value_that_says_by_habit_that_it_is_unknown_is_unknown(
    type_name: str, message: Fields, name: str, value: float
) -> None:
    assert value_reader(type_name, name)(message) == pytest.approx(value, nan_ok=True)
    (gauge,) = gauges_for(type_name, [name])
    ((_, _, _, state, _),) = gauge.read(b"", message, 0) or ()
    assert gauge.distances[name].has_value(state) is math.isfinite(value)


@pytest.mark.parametrize("huge", [1e200, 1.7976931348623157e308, INF, NAN])
def test_a_heading_of_numbers_that_are_no_quaternion_is_unknown(huge: float) -> None:
    for name in ("roll", "pitch", "yaw"):
        message = Fields(orientation=Fields(x=0.0, y=0.0, z=huge, w=huge))
        assert math.isnan(value_reader(IMU, name)(message))

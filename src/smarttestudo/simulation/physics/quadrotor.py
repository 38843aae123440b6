# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A quadrotor: its masses, rotors, flight controller and sensors.

The velocity gives an acceleration, that a tilt, that a rate of turning, and that the torques (as in PX4).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarttestudo.simulation import messages
from smarttestudo.simulation.geometry import (
    BodyVelocity,
    FrameTransform,
    Lens,
    Pose,
    Quaternion,
    Vector,
    clamped,
)
from smarttestudo.simulation.messages import Published, RobotTopic
from smarttestudo.simulation.physics.body import BatteryType, Machine, PhysicalBody
from smarttestudo.simulation.physics.engine import Engine
from smarttestudo.simulation.physics.sensors import Localizer, elapsed_s
from smarttestudo.simulation.physics.world import camera, heading, numbers
from smarttestudo.simulation.robot import (
    BASE_LINK,
    CAMERA_FRAME,
    IMU_FRAME,
    ODOM_FRAME,
    OPTICAL_FRAME,
    RANGE_FRAME,
    optical_rotation,
)
from smarttestudo.simulation.schedule import Device
from smarttestudo.simulation.sensors import GRAVITY_M_PER_S2
from smarttestudo.simulation.steering import Steer

RANGE_MOUNT_M = 0.04
"""Of the range finder below the middle."""
_LEVEL = Quaternion(0.0, 0.0, 0.0, 1.0)
_DOWN = Quaternion.from_roll_pitch_yaw(0.0, np.pi / 2, 0.0)
_POSE_DEVIATIONS = (0.1, 0.1, 0.1, 0.01, 0.01, 0.05)
_WALK_PER_S = np.array((0.01, 0.01, 0.01, 0.002))
"""How far x, y, z and heading of visual odometry stray in a second; in n seconds √n times as far."""


def quadrotor_frames(camera_x_m: float) -> tuple[FrameTransform, ...]:
    """The frames that never move against the quadrotor."""
    return (
        FrameTransform(BASE_LINK, IMU_FRAME, Vector(0.0, 0.0, 0.0), _LEVEL),
        FrameTransform(BASE_LINK, RANGE_FRAME, Vector(0.0, 0.0, -RANGE_MOUNT_M), _DOWN),
        FrameTransform(BASE_LINK, CAMERA_FRAME, Vector(camera_x_m, 0.0, 0.0), _LEVEL),
        FrameTransform(CAMERA_FRAME, OPTICAL_FRAME, Vector(0.0, 0.0, 0.0), optical_rotation()),
    )


class VisualOdometer:
    """Odometry in three dimensions, which strays like a random walk."""

    rate_hz = 30.0
    linear_noise_m_per_s = 0.02
    angular_noise_rad_per_s = 0.005

    def __init__(self, drift: np.random.Generator, noise: np.random.Generator) -> None:
        self._drift = drift
        self._offset = np.zeros(4)
        self._noise = noise
        self._sampled_ns: int | None = None
        self.pose = Pose(0.0, 0.0, 0.0)

    def sample(self, body: PhysicalBody) -> Published:
        dt_s = elapsed_s(self._sampled_ns, body.now_ns, self.rate_hz)
        self._sampled_ns = body.now_ns
        self._offset += self._drift.standard_normal(4) * _WALK_PER_S * math.sqrt(dt_s)
        x, y, z, yaw = self._offset.tolist()
        true, engine = body.engine.position, body.engine
        place = Vector(true.x + x, true.y + y, true.z + z)
        turned = Quaternion.from_yaw(yaw).then(engine.orientation)
        self.pose = Pose(place.x, place.y, turned.yaw_rad)
        velocity, turning = engine.velocity, engine.angular_velocity
        ahead, left, up = engine.rotation.T @ (velocity.x, velocity.y, velocity.z)
        noise = self._noise.standard_normal(6).tolist()
        slow, turn = self.linear_noise_m_per_s, self.angular_noise_rad_per_s
        linear = Vector(
            float(ahead) + slow * noise[0], float(left) + slow * noise[1], float(up) + slow * noise[2]
        )
        angular = Vector(
            turning.x + turn * noise[3], turning.y + turn * noise[4], turning.z + turn * noise[5]
        )
        twist = messages.estimated_twist(linear, angular, (slow, slow, slow, turn, turn, turn))
        pose = messages.estimated_pose(place, turned, _POSE_DEVIATIONS)
        frame = FrameTransform(ODOM_FRAME, BASE_LINK, place, turned)
        return [
            (RobotTopic.ODOM, messages.odometry(body.now_ns, BASE_LINK, pose, twist)),
            (RobotTopic.TF, messages.transforms(body.now_ns, [frame])),
        ]


@dataclass(frozen=True)
class RangeFinder:
    """An infrared range finder that looks down."""

    noise: np.random.Generator
    rate_hz = 20.0
    range_min_m = 0.03
    range_max_m = 8.0
    noise_m = 0.01
    field_of_view_rad = 0.47

    def sample(self, body: PhysicalBody) -> Published:
        """The distance along the middle of the beam."""
        engine = body.engine
        down = -engine.rotation[:, 2]
        place = engine.position
        x, y, z = (down * RANGE_MOUNT_M).tolist()
        origin = Vector(place.x + x, place.y + y, place.z + z)
        (true_m,) = engine.cast(origin, down.reshape(1, 3), self.range_max_m).tolist()
        measured_m = true_m + self.noise_m * float(self.noise.standard_normal())
        if measured_m < self.range_min_m:
            measured_m = -np.inf
        message = messages.range_of(
            body.now_ns,
            measured_m if measured_m <= self.range_max_m else np.inf,
            least_m=self.range_min_m,
            most_m=self.range_max_m,
            field_of_view_rad=self.field_of_view_rad,
        )
        return [(RobotTopic.RANGE, message)]


CRUISE_HEIGHT_M = 1.5
LANDED_HEIGHT_M = 0.06
MASS_KG = 1.2
_CAMERA_X_M = 0.11
_ARM_M = 0.12
"""From the middle to a rotor, along x and along y."""
_INERTIA_KG_M2 = (0.011, 0.011, 0.02)
_MOST_THRUST_N = 6.5
_TORQUE_PER_THRUST_M = 0.016
_ROTOR_S = 0.02
_ROTORS = ((1, -1, 1), (-1, 1, 1), (1, 1, -1), (-1, -1, -1))
"""Where each rotor is ahead and to the left, and which way its drag turns the body."""
_MOST_TILT = 0.35
_MOST_HORIZONTAL_M_PER_S = 1.5
_MOST_VERTICAL_M_PER_S = 0.7
_MOST_YAW_RAD_PER_S = 1.8
_CLIMB_PER_M = 1.0
_MOST_CLIMB_M_PER_S = 0.6
_SINK_M_PER_S = -0.4
_VELOCITY_GAIN = 2.0
_CLIMB_GAIN = 4.0
_TILT_GAIN = 8.0
_RATE_GAIN = 18.0
_YAW_GAIN = 5.0
_IDLE_W = 8.0
_HOVER_W = 140.0
_DARK = "0.15 0.15 0.17 1"


class Quadrotor(Machine):
    """Rotors and flight controller; on the ground it waits for a command to climb."""

    actuator_count = len(_ROTORS)
    most = BodyVelocity(_MOST_HORIZONTAL_M_PER_S, _MOST_YAW_RAD_PER_S, climb_m_per_s=_MOST_VERTICAL_M_PER_S)
    battery = BatteryType(nominal_v=11.1, capacity_ah=5.0)
    own_topics = (RobotTopic.RANGE,)
    fixed_frames = quadrotor_frames(_CAMERA_X_M)

    def __init__(self, start: Pose) -> None:
        self._start = start
        self._velocity = BodyVelocity(0.0, 0.0)

    def body(self, lens: Lens) -> str:
        """The robot on the ground; its origin is its middle."""
        start = self._start
        rotors = "".join(
            f"""
          <geom name="rotor_{number}" type="cylinder" pos="{numbers(ahead * _ARM_M, left * _ARM_M, 0.02)}"
                size="0.07 0.006" rgba="{_DARK}"/>
          <geom name="foot_{number}" type="sphere" pos="{numbers(ahead * 0.09, left * 0.09, -0.05)}"
                size="0.01" rgba="{_DARK}"/>
          <site name="rotor_{number}" pos="{numbers(ahead * _ARM_M, left * _ARM_M, 0.02)}"/>"""
            for number, (ahead, left, _) in enumerate(_ROTORS)
        )
        return f"""
        <body name="robot" pos="{numbers(start.x_m, start.y_m, LANDED_HEIGHT_M)}" quat="{heading(start)}">
          <freejoint name="robot"/>
          <inertial pos="0 0 0" mass="{MASS_KG}" diaginertia="{numbers(*_INERTIA_KG_M2)}"/>
          <geom name="trunk" type="box" size="0.09 0.06 0.03" rgba="{_DARK}"/>{rotors}
          <site name="imu" pos="0 0 0"/>
          {camera(_CAMERA_X_M, 0.0, lens)}
        </body>"""

    def actuators(self) -> str:
        """The rotors: thrust in N, after a lag, with the drag that turns the body."""
        return "".join(
            f"""
        <general site="rotor_{number}" gear="{numbers(0, 0, 1, 0, 0, turn * _TORQUE_PER_THRUST_M)}"
                 ctrlrange="0 {_MOST_THRUST_N}" ctrllimited="true" dyntype="filter" dynprm="{_ROTOR_S}"
                 gainprm="1"/>"""
            for number, (_, _, turn) in enumerate(_ROTORS)
        )

    def devices(self, noises: Sequence[np.random.Generator]) -> list[Device[PhysicalBody]]:
        odometer = VisualOdometer(noises[0], noises[1])
        return [odometer, RangeFinder(noises[2]), Localizer(odometer, noises[3])]

    def keeping_height(self, steer: Steer[PhysicalBody]) -> Steer[PhysicalBody]:
        """``steer`` with the climb that comes first, and keeps the height."""

        def command(body: PhysicalBody) -> BodyVelocity:
            missing_m = CRUISE_HEIGHT_M - body.engine.position.z
            climb = clamped(_CLIMB_PER_M * missing_m, _MOST_CLIMB_M_PER_S)
            if missing_m > CRUISE_HEIGHT_M / 3:
                return BodyVelocity(0.0, 0.0, climb_m_per_s=climb)
            level = steer(body)
            return BodyVelocity(level.linear_m_per_s, level.angular_rad_per_s, climb_m_per_s=climb)

        return command

    def command(self, velocity: BodyVelocity) -> None:
        """Fly at ``velocity``, which is level with the ground and along the heading."""
        self._velocity = velocity

    def rest(self) -> None:
        """Sink and land: the battery is as good as empty."""
        self._velocity = BodyVelocity(0.0, 0.0, climb_m_per_s=_SINK_M_PER_S)

    def controls(self, engine: Engine) -> Sequence[float]:
        """The thrust of each rotor in the next step, in N."""
        is_grounded = engine.position.z <= LANDED_HEIGHT_M + 0.01
        if is_grounded and self._velocity.climb_m_per_s <= 0.0:
            return [0.0] * len(_ROTORS)
        roll, pitch, yaw = engine.orientation.roll_pitch_yaw_rad
        to_roll, to_pitch, thrust_n = self._tilt_and_thrust(engine, yaw, math.cos(roll) * math.cos(pitch))
        rates = engine.angular_velocity
        wanted = self._velocity
        yaw_rate = clamped(wanted.angular_rad_per_s, _MOST_YAW_RAD_PER_S)
        about_x, about_y, about_z = _INERTIA_KG_M2
        roll_n_m = about_x * _RATE_GAIN * (_TILT_GAIN * (to_roll - roll) - rates.x)
        pitch_n_m = about_y * _RATE_GAIN * (_TILT_GAIN * (to_pitch - pitch) - rates.y)
        yaw_n_m = about_z * _YAW_GAIN * (yaw_rate - rates.z)
        return [
            thrust_n / 4
            + left * roll_n_m / (4 * _ARM_M)
            - ahead * pitch_n_m / (4 * _ARM_M)
            + turn * yaw_n_m / (4 * _TORQUE_PER_THRUST_M)
            for ahead, left, turn in _ROTORS
        ]

    def power_w(self, engine: Engine) -> float:
        """Power that rotors take now: momentum theory has it as thrust to the power of 1.5."""
        hover_n = MASS_KG * GRAVITY_M_PER_S2 / 4
        shares = (max(force, 0.0) / hover_n for force in engine.actuator_forces)
        return _IDLE_W + _HOVER_W / 4 * sum(share * math.sqrt(share) for share in shares)

    def _tilt_and_thrust(self, engine: Engine, yaw: float, upright: float) -> tuple[float, float, float]:
        """Roll, pitch and thrust that bring the robot to the velocity it is to have."""
        velocity, wanted = engine.velocity, self._velocity
        forward = velocity.x * math.cos(yaw) + velocity.y * math.sin(yaw)
        leftward = velocity.y * math.cos(yaw) - velocity.x * math.sin(yaw)
        most = _MOST_HORIZONTAL_M_PER_S
        ahead = _VELOCITY_GAIN * (clamped(wanted.linear_m_per_s, most) - forward)
        aside = _VELOCITY_GAIN * (clamped(wanted.lateral_m_per_s, most) - leftward)
        climb = clamped(wanted.climb_m_per_s, _MOST_VERTICAL_M_PER_S)
        up = GRAVITY_M_PER_S2 + _CLIMB_GAIN * (climb - velocity.z)
        pitch = clamped(math.atan2(ahead, GRAVITY_M_PER_S2), _MOST_TILT)
        roll = clamped(math.atan2(-aside, GRAVITY_M_PER_S2), _MOST_TILT)
        return roll, pitch, MASS_KG * max(up, 0.0) / max(upright, 0.5)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where a robot was, from its odometry or its transforms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol

from smarttestudo.adirf.properties.motion import yaw_degrees
from smarttestudo.domain.recording import Channel, MessageDecoder
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.floor import PathPoint

_STEP_NS = NS_PER_S // 5
_ODOMETRY = "nav_msgs/msg/Odometry"
_TRANSFORMS = "tf2_msgs/msg/TFMessage"
_ROBOT_FRAMES = ("base_footprint", "base_link")
_MOST_LINKS = 50


class PathReader(Protocol):
    """Follows a robot through the messages of its recording."""

    @property
    def path(self) -> Sequence[PathPoint]:
        """Where it was so far, at most five times a second."""

    def take(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Look at the next message of the recording.

        Raises:
            RecordingError: the message should say where the robot is, and cannot be decoded.
        """


class OdometryPlaces:
    """The positions that one topic's odometry gives."""

    __slots__ = ("_channel", "_decoder", "_due_ns", "_start_ns", "path")

    def __init__(self, channel: Channel, decoder: MessageDecoder, start_ns: int) -> None:
        self.path: list[PathPoint] = []
        self._channel = channel
        self._decoder = decoder
        self._start_ns = start_ns
        self._due_ns = start_ns

    def take(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """As ``PathReader``."""
        if channel is not self._channel or stamp_ns < self._due_ns:
            return
        self._due_ns = stamp_ns + _STEP_NS
        odometry: Any = self._decoder.decode(channel, payload)
        position = odometry.pose.pose.position
        t_s = (stamp_ns - self._start_ns) / NS_PER_S
        self.path.append(PathPoint(t_s=t_s, x_m=position.x, y_m=position.y))


class TransformPlaces:
    """The place of the robot's base in the root of its transforms, seen from above.

    Frames may turn about the vertical axis; the height is left out.
    """

    __slots__ = ("_channels", "_decoder", "_due_ns", "_links", "_start_ns", "path")

    def __init__(self, channels: Sequence[Channel], decoder: MessageDecoder, start_ns: int) -> None:
        self.path: list[PathPoint] = []
        self._channels = channels
        self._decoder = decoder
        self._start_ns = start_ns
        self._due_ns = start_ns
        self._links: dict[str, tuple[str, float, float, float]] = {}

    def take(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """As ``PathReader``."""
        if not any(channel is one for one in self._channels):
            return
        message: Any = self._decoder.decode(channel, payload)
        for link in message.transforms:
            move, turn = link.transform.translation, link.transform.rotation
            parent = link.header.frame_id.lstrip("/")
            self._links[link.child_frame_id.lstrip("/")] = (
                parent,
                move.x,
                move.y,
                math.radians(yaw_degrees(turn)),
            )
        frame = next((name for name in _ROBOT_FRAMES if name in self._links), None)
        if frame is not None and stamp_ns >= self._due_ns:
            self._due_ns = stamp_ns + _STEP_NS
            x_m, y_m = self._in_root(frame)
            t_s = (stamp_ns - self._start_ns) / NS_PER_S
            self.path.append(PathPoint(t_s=t_s, x_m=x_m, y_m=y_m))

    def _in_root(self, frame: str) -> tuple[float, float]:
        x_m = y_m = 0.0
        for _ in range(_MOST_LINKS):
            if frame not in self._links:
                break
            frame, move_x_m, move_y_m, yaw_rad = self._links[frame]
            cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
            x_m, y_m = move_x_m + cos * x_m - sin * y_m, move_y_m + sin * x_m + cos * y_m
        return x_m, y_m


def places_in(
    channels: Sequence[Channel], decoder: MessageDecoder, start_ns: int, *, by_transforms: bool
) -> PathReader | None:
    """The source of the robot's position in a recording with ``channels``; ``None`` if there is none.

    That is its odometry, ``/odom`` before others, else its transforms; ``by_transforms`` takes those first.
    """
    known = [channel for channel in channels if decoder.can_decode(channel)]
    odometry = sorted(
        (channel for channel in known if channel.type_name == _ODOMETRY),
        key=lambda channel: (channel.topic != "/odom", channel.topic),
    )
    transforms = [channel for channel in known if channel.type_name == _TRANSFORMS]
    if transforms and (by_transforms or not odometry):
        return TransformPlaces(transforms, decoder, start_ns)
    return OdometryPlaces(odometry[0], decoder, start_ns) if odometry else None

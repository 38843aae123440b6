# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot that drives in virtual time, and what its messages say of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from link.protocol.simulated_link import S
from pacing.reckoning.ros_messages import joints, odometry, planar, transforms
from smarttestudo.pacing.cdr import FrameReader, JointReader, PoseReader
from smarttestudo.pacing.reckoning.motion import Twist, Vector3

START_NS = 1_000 * S
"""What the stamps say when the run begins."""


# The same few messages are looked at again after everything that happens.
@lru_cache(maxsize=1000)
def read(topic: str, payload: bytes) -> Mapping[str, float]:
    if topic == "/odom":
        pose = PoseReader(2, has_twist=True).read(payload)
        assert pose is not None
        return {"": pose[1][0]}
    if topic == "/tf":
        return {one.child_frame: one.numbers[0] for one in FrameReader().transforms(payload)}
    states = JointReader().read(payload)
    assert states is not None
    return dict(zip(states[0], states[1], strict=True))


@dataclass
class Source:
    """A robot that hurries, waits and turns back, and what its messages say of it."""

    topic: str
    names: Sequence[str] = ("base", "arm")
    offset_ns: int = 0
    has_stamps: bool = True
    has_velocities: bool = False
    crowd: int | None = None
    """With a crowd, every second message is of a part that nobody heard of before."""
    shift: float = 0.0
    stands: bool = False
    frames: tuple[str, str] = field(default=("odom", "base"))

    def write(self, number: int, now_ns: int) -> bytes:
        at_s = 0.0 if self.stands else now_ns / S
        x = self.shift + math.sin(at_s) + 0.2 * math.sin(5 * at_s)
        speed = 0.0 if self.stands else math.cos(at_s) + math.cos(5 * at_s)
        stamp_ns = START_NS + now_ns + self.offset_ns if self.has_stamps else 0
        if self.topic == "/odom":
            twist = Twist(Vector3(speed, 0, 0), Vector3(0, 0, 0))
            return odometry(stamp_ns, planar(x, 0, 0), twist, self.frames)
        every = (self.names, self.names[:1], self.names[1:], self.names)
        names = [*every[number % 4]] or [*self.names]
        if self.crowd is not None and number % 2:
            self.crowd += 1
            names = [f"person_{self.crowd}"]
        far = {name: place + 1 for place, name in enumerate(self.names)}
        places = {name: x * far.get(name, 1) for name in names}
        if self.topic == "/tf":
            return transforms(stamp_ns, {name: planar(at, 0, 0) for name, at in places.items()})
        velocities = [speed * far.get(name, 1) for name in names] if self.has_velocities else []
        return joints(stamp_ns, places, velocities)

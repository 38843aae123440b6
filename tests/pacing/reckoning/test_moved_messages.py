# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages with some of their parts elsewhere are those that another implementation of ROS 2 writes."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pacing.reckoning.ros_messages import JOINTS, STORE, TRANSFORMS, joints, planar, transforms
from smarttestudo.pacing.cdr import FrameReader, JointReader
from smarttestudo.pacing.reckoning.motion import SpatialPose

names = st.lists(st.text("abcdefghi_é", max_size=9), unique=True, min_size=1, max_size=5)
stamps_ns = st.integers(0, 2**31 * 10**9 - 1)
numbers = st.floats(-9, 9)


def _written(payload: bytes, type_name: str, *, is_little: bool) -> bytes:
    message = STORE.deserialize_cdr(payload, type_name)
    return bytes(STORE.serialize_cdr(message, type_name, little_endian=is_little))


def _all_numbers(pose: SpatialPose) -> tuple[float, ...]:
    return (*pose.position, *pose.orientation)


@given(names, st.data(), st.booleans(), stamps_ns)
def test_some_frames_elsewhere(children: list[str], data: st.DataObject, is_little: bool, at_ns: int) -> None:
    kept = [child for child in children if data.draw(st.booleans())]
    before = _written(
        transforms(7, {child: planar(1, 2, 3) for child in children}), TRANSFORMS, is_little=is_little
    )
    places = {child: planar(data.draw(numbers), 0, 1) for child in kept}
    moved = FrameReader().moved(before, {child: (at_ns, _all_numbers(places[child])) for child in kept})
    assert moved == _written(transforms(at_ns, places), TRANSFORMS, is_little=is_little)


@given(names, st.data(), st.booleans(), stamps_ns, st.tuples(st.booleans(), st.booleans()))
def test_some_joints_elsewhere(
    every: list[str], data: st.DataObject, is_little: bool, at_ns: int, has: tuple[bool, bool]
) -> None:
    has_velocities, has_efforts = has
    kept = [place for place in range(len(every)) if data.draw(st.booleans())]
    velocities = [float(place) for place in range(len(every))] if has_velocities else []

    def message(stamp_ns: int, places: list[int], positions: list[float]) -> bytes:
        said = dict(zip([every[place] for place in places], positions, strict=True))
        read: Any = STORE.deserialize_cdr(
            joints(stamp_ns, said, [velocities[place] for place in places] if velocities else [], "body"),
            JOINTS,
        )
        read.effort = np.array([place + 0.5 for place in places] if has_efforts else [], dtype=np.float64)
        return bytes(STORE.serialize_cdr(read, JOINTS, little_endian=is_little))

    positions = [data.draw(numbers) for _ in kept]
    moved = JointReader().moved(
        message(7, [*range(len(every))], [0.0] * len(every)),
        at_ns,
        {every[place]: position for place, position in zip(kept, positions, strict=True)},
    )
    assert moved == message(at_ns, kept, positions)


def test_a_time_that_no_stamp_can_hold_is_not_written() -> None:
    beyond_ns = 2**31 * 10**9
    pose = planar(1, 2, 3)
    assert FrameReader().moved(transforms(7, {"a": pose}), {"a": (beyond_ns, _all_numbers(pose))}) is None
    assert JointReader().moved(joints(7, {"a": 1.0}), beyond_ns, {"a": 2.0}) is None

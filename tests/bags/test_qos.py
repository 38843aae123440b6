# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Quality-of-service profiles are read as they were written."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2.metadata import dump_qos_v8

from smarttestudo.bags.qos import qos_profiles, qos_text

TIMES = st.builds(QosTime, st.integers(0, 2**31), st.integers(0, 999_999_999))
PROFILES = st.builds(
    Qos,
    history=st.sampled_from(QosHistory),
    depth=st.integers(0, 2**31),
    reliability=st.sampled_from(QosReliability),
    durability=st.sampled_from(QosDurability),
    deadline=TIMES,
    lifespan=TIMES,
    liveliness=st.sampled_from(QosLiveliness),
    liveliness_lease_duration=TIMES,
    avoid_ros_namespace_conventions=st.booleans(),
)


@given(st.lists(PROFILES, max_size=3).map(tuple))
def test_profiles_are_read_as_written_here_and_by_rosbags(profiles: tuple[Qos, ...]) -> None:
    assert qos_profiles(qos_text(profiles)) == profiles
    assert qos_profiles(dump_qos_v8([*profiles])) == profiles

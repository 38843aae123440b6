# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Short missions for tests."""

from __future__ import annotations

from itertools import takewhile

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.mission import MissionRequest, drive_mission
from smarttestudo.simulation.readings import Reading, TimedReading, Topic
from smarttestudo.simulation.warehouse import patrol, warehouse

START_NS = 1_750_000_000 * NS_PER_S


def readings(seconds: float, *, seed: int = 1, frames: FrameSize = FrameSize.SMALL) -> list[TimedReading]:
    request = MissionRequest(plan=warehouse(), route=patrol(), seed=seed, start_ns=START_NS, frames=frames)
    end_ns = START_NS + round(seconds * NS_PER_S)
    return list(takewhile(lambda reading: reading.time_ns < end_ns, drive_mission(request)))


def of_topic(timed: list[TimedReading], topic: Topic) -> list[Reading]:
    return [reading.reading for reading in timed if reading.topic is topic]

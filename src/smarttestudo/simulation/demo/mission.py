# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recording the simulated robot's mission."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.simulation.camera import FULL_JPEG_BYTES, FrameSize
from smarttestudo.simulation.messages import RobotMessages, Topic
from smarttestudo.simulation.mission import MissionRequest, drive_mission
from smarttestudo.simulation.mission_file import load_mission
from smarttestudo.simulation.route import Route
from smarttestudo.simulation.tour import Tour
from smarttestudo.simulation.warehouse import patrol, warehouse

START_NS = 1_767_600_000 * NS_PER_S
IMAGE_BYTES = 6_220_872
DECLARED_BYTES = {Topic.IMAGE.value: IMAGE_BYTES, Topic.COMPRESSED_IMAGE.value: FULL_JPEG_BYTES}
_MESSAGES_PER_REPORT = 1000
_SMALL_BYTES_PER_S = 500_000
_FULL_BYTES_PER_S = 216_000_000


def route_of(mission: Path | None) -> Route | Tour:
    """The tour in the mission file, without one the patrol of the thesis; raises ``MissionError``."""
    return patrol() if mission is None else load_mission(mission, warehouse())


def bytes_per_second(*, full_images: bool) -> int:
    """About how much disk both recordings of a mission take for each of its seconds."""
    return _FULL_BYTES_PER_S if full_images else _SMALL_BYTES_PER_S


def record_mission(
    path: Path,
    *,
    route: Route | Tour,
    seconds: float,
    seed: int,
    full_images: bool,
    report: Callable[[float], None],
) -> None:
    """Write ``seconds`` of the drive to a new recording at ``path``; ``report`` gets the share done.

    Unless ``full_images``, camera frames are small, and the recording declares the size of whole ones.

    Raises:
        RecordingError: the recording cannot be written.
    """
    frames = FrameSize.FULL if full_images else FrameSize.SMALL
    request = MissionRequest(plan=warehouse(), route=route, seed=seed, start_ns=START_NS, frames=frames)
    messages = RobotMessages()
    duration_ns = ns_from_s(seconds)
    declared_bytes = {} if full_images else DECLARED_BYTES
    with create_recording(path, declared_bytes=declared_bytes) as recording:
        for channel in messages.channels.values():
            recording.add(channel)
        for count, timed in enumerate(drive_mission(request)):
            elapsed_ns = timed.time_ns - START_NS
            if elapsed_ns >= duration_ns:
                break
            recording.write(
                messages.channels[timed.topic], timed.time_ns, messages.payload(timed.topic, timed.message)
            )
            if count % _MESSAGES_PER_REPORT == 0:
                report(elapsed_ns / duration_ns)

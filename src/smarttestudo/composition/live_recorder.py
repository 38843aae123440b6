# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recording what a robot publishes, and what an operator receives of it, while both run."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from smarttestudo.adapters.rosbag import create_recording
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.recording import Channel, RecordingWriter
from smarttestudo.domain.robot import Inlet, Qos, Robot

_QOS = Qos(reliable=True, transient_local=False, depth=100)


@contextmanager
def recorded(
    robot: Robot,
    folder: Path,
    channels: Iterable[Channel],
    declared_bytes: Mapping[str, int],
    heard_as: Callable[[str], str] = str,
) -> Iterator[None]:
    """Record the topics of ``channels`` into a new recording ``folder`` while the block handles messages.

    They are recorded by their own name, and heard by that which ``heard_as`` makes of it. Stamps are the
    node's time at which messages came.

    Raises:
        RecordingError: it cannot be written.
        RosError: a topic cannot be heard.
    """
    with create_recording(folder, declared_bytes=declared_bytes) as recording, ExitStack() as inlets:
        for channel in channels:
            recording.add(channel)
            inlets.callback(_heard(robot, channel, heard_as(channel.topic), recording).close)
        yield


def _heard(robot: Robot, channel: Channel, topic: str, recording: RecordingWriter) -> Inlet:
    def receive(payload: Payload, _publisher: Hashable) -> None:
        recording.write(channel, robot.now_ns(), payload[:])

    return robot.data_path.subscribe(topic, channel.type_name, _QOS, receive)

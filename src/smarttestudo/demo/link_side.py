# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A process of the demo over a link, in the network namespace of robot or operator, until a signal comes.

Its arguments are the value of a ``LinkRole`` and a file: a new recording, or for ``ZENOH_ROBOT`` the profile.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Hashable
from contextlib import ExitStack
from enum import Enum
from pathlib import Path
from queue import Empty, SimpleQueue

from smarttestudo.bags.writer import create_recording
from smarttestudo.demo.live import recorded, relayed_name, robot_channels
from smarttestudo.demo.network_namespaces import OPERATOR_ADDRESS
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.robot import Qos
from smarttestudo.robot.ros import open_robot
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.simulation.messages.messages import RobotMessages

ENDPOINT = f"tcp/{OPERATOR_ADDRESS}:7447"
READY = "ready"
_NODE = ("-r", "__node:=recorder")
_QOS = Qos(reliable=True, transient_local=False, depth=100)
_WAIT_S = 0.1
_CLASSES = ("INTERACTIVE_HIGH", "INTERACTIVE_LOW", "DATA_HIGH", "DATA", "DATA_LOW", "BACKGROUND")


class LinkRole(Enum):
    """The role of the process: a recorder beside the robot, an end of plain Zenoh, or a ROS operator's."""

    WITNESS = "witness"
    ZENOH_ROBOT = "zenoh-robot"
    ZENOH_OPERATOR = "zenoh-operator"
    ROS_OPERATOR = "ros-operator"


def zenoh_priorities(topics: list[str], profile: Profile) -> dict[str, str]:
    """Zenoh's priority of each topic: the profile's order, in as many of Zenoh's classes as there are."""
    ranks = sorted({profile.topic(topic).priority for topic in topics}, reverse=True)
    return {
        topic: _CLASSES[min(ranks.index(profile.topic(topic).priority), len(_CLASSES) - 1)]
        for topic in topics
    }


def _record(folder: Path, heard_as: Callable[[str], str], stopped: threading.Event) -> None:
    with open_robot(_NODE) as robot:
        channels, _ = robot_channels(robot, full_images=False)
        with recorded(robot, folder, channels, {}, heard_as):
            print(READY, flush=True)  # noqa: T201
            while not stopped.is_set():
                robot.wait(None, _WAIT_S)


def _send_by_zenoh(profile_file: Path, stopped: threading.Event) -> None:
    from smarttestudo.link.zenoh.plain import plain_robot  # noqa: PLC0415  the others need no zenoh

    profile = load_profile(profile_file)
    with ExitStack() as opened:
        robot = opened.enter_context(open_robot(_NODE))
        channels, _ = robot_channels(robot, full_images=False)
        priorities = zenoh_priorities([channel.topic for channel in channels], profile)
        puts, is_connected = opened.enter_context(plain_robot(ENDPOINT, priorities, compresses=True))
        while not is_connected() and not stopped.is_set():
            time.sleep(_WAIT_S)
        for channel in channels:
            topic = relayed_name(channel.topic)
            receive = _forward(puts[channel.topic])
            opened.callback(robot.data_path.subscribe(topic, channel.type_name, _QOS, receive).close)
        print(READY, flush=True)  # noqa: T201
        while not stopped.is_set():
            robot.wait(None, _WAIT_S)


def _forward(put: Callable[[bytes], None]) -> Callable[[Payload, Hashable], None]:
    return lambda payload, _publisher: put(payload[:])


def _record_zenoh(folder: Path, stopped: threading.Event) -> None:
    from smarttestudo.link.zenoh.plain import plain_operator  # noqa: PLC0415  the others need no zenoh

    channels = {channel.topic: channel for channel in RobotMessages().channels.values()}
    arrived: SimpleQueue[tuple[str, int, bytes]] = SimpleQueue()

    def note(topic: str, payload: bytes) -> None:
        arrived.put((topic, time.time_ns(), payload))

    with create_recording(folder) as recording, plain_operator(ENDPOINT, note, compresses=True):
        print(READY, flush=True)  # noqa: T201
        while not stopped.is_set():
            try:
                topic, stamp_ns, payload = arrived.get(timeout=_WAIT_S)
            except Empty:
                continue
            recording.write(channels[topic], stamp_ns, payload)


def _main(role: LinkRole, file: Path) -> int:
    stopped = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: stopped.set())
    try:
        match role:
            case LinkRole.WITNESS:
                _record(file, str, stopped)
            case LinkRole.ROS_OPERATOR:
                _record(file, relayed_name, stopped)
            case LinkRole.ZENOH_ROBOT:
                _send_by_zenoh(file, stopped)
            case LinkRole.ZENOH_OPERATOR:
                _record_zenoh(file, stopped)
    except TestudoError as error:
        print(error, file=sys.stderr)  # noqa: T201
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(_main(LinkRole(sys.argv[1]), Path(sys.argv[2])))

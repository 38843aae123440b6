# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo in real time: robot and runtime are processes of their own, and this one records both."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.errors import RosError, TestudoError
from smarttestudo.domain.names import DECISIONS_TOPIC, output_name
from smarttestudo.domain.recording import Channel, RecordingWriter
from smarttestudo.domain.robot import Payload, Qos, Robot, Subscription
from smarttestudo.domain.units import NS_PER_S, grouped, ns_from_s
from smarttestudo.robot.output_topics import DEFAULT_OUTPUT_TOPIC
from smarttestudo.simulation.demo.folder import ADAPTIVE, BASELINE, DECISIONS, LOGS, RULES, DemoRequest
from smarttestudo.simulation.messages import CAMERA_TOPICS, RobotMessages, RobotTopic
from smarttestudo.simulation.mission import DECLARED_BYTES

_QOS = Qos(reliable=True, transient_local=False, depth=100)


@contextmanager
def recorded(
    robot: Robot,
    folder: Path,
    channels: Iterable[Channel],
    declared_bytes: Mapping[str, int],
    subscribed_as: Callable[[str], str] = str,
) -> Iterator[Mapping[str, Subscription]]:
    """Record the topics of ``channels`` into a new recording ``folder`` while the block handles messages.

    They are recorded by their own name, and subscribed to by the name that ``subscribed_as`` gives. Stamps
    are the node's time at which messages arrived. The block is given the subscriptions by topic.

    Raises:
        RecordingError: it cannot be written.
        RosError: a topic cannot be received.
    """
    with create_recording(folder, declared_bytes=declared_bytes) as recording, ExitStack() as subscriptions:
        subscribed: dict[str, Subscription] = {}
        for channel in channels:
            recording.add(channel)
            subscribed[channel.topic] = _subscribed(robot, channel, subscribed_as(channel.topic), recording)
            subscriptions.callback(subscribed[channel.topic].close)
        yield subscribed


def lost_lines(folder: Path, subscribed: Mapping[str, Subscription]) -> list[str]:
    """Messages that the recording ``folder`` lacks of those sent to it, a line for each topic."""
    return [
        f"{folder.name}: {grouped(subscription.dropped)} of {grouped(subscription.sent)} messages of {topic} "
        "were lost on their way"
        for topic, subscription in subscribed.items()
        if subscription.dropped and subscription.sent
    ]


def _subscribed(robot: Robot, channel: Channel, topic: str, recording: RecordingWriter) -> Subscription:
    def receive(payload: Payload, _publisher: Hashable) -> None:
        recording.write(channel, robot.now_ns(), payload[:])

    qos = replace(_QOS, transient_local=channel.transient_local)
    return robot.data_path.subscribe(topic, channel.type_name, qos, receive)


_LOST_TIME = "s of real time so far, in which the robot stood still"
_POLL_S = 0.1
_START_TIMEOUT_S = 40.0
_END_TIMEOUT_S = 10.0


def record_live(
    request: DemoRequest, folder: Path, robot: Robot, report: Callable[[float], None]
) -> tuple[str, ...]:
    """Let the robot drive under the runtime, and record both in ``folder``; what was left out, a line each.

    Raises:
        TestudoError: one of the processes failed.
        RecordingError: a recording cannot be written.
    """
    blind = None
    if request.physics:
        # This needs the extra physics.
        from smarttestudo.simulation.physics.drive import camera_problem  # noqa: PLC0415

        blind = camera_problem()
    channels, left_out = _robot_channels(robot, full_images=request.full_images, camera_problem=blind)
    declared_bytes = {} if request.full_images else DECLARED_BYTES
    relayed = partial(output_name, pattern=DEFAULT_OUTPUT_TOPIC)
    runtime_log, robot_log = (folder / name for name in LOGS)
    with (
        recorded(robot, folder / BASELINE, channels, declared_bytes) as baseline,
        recorded(robot, folder / ADAPTIVE, channels, declared_bytes, relayed) as adaptive,
        _testudo("runtime", _run_arguments(request, folder), runtime_log) as runtime,
    ):
        _await_publisher(robot, DECISIONS_TOPIC, runtime)
        with _testudo("simulated robot", _simulate_arguments(request), robot_log) as driver:
            _await_publisher(robot, RobotTopic.ODOM.value, driver)
            end_ns = robot.now_ns() + ns_from_s(request.seconds)
            while (left_ns := end_ns - robot.now_ns()) > 0 and runtime.is_running() and driver.is_running():
                robot.wait(end_ns, _POLL_S)
                report(1 - left_ns / NS_PER_S / request.seconds)
            # It ends before the robot does, which would be a change of plans of its own.
            runtime.end()
        lost = [*lost_lines(folder / BASELINE, baseline), *lost_lines(folder / ADAPTIVE, adaptive)]
    return (*left_out, *lost, *_lost_time(robot_log))


def _lost_time(log: Path) -> list[str]:
    """The robot's last words on time that it lost, if it did."""
    said = [line for line in log.read_text("utf-8", "replace").splitlines() if _LOST_TIME in line]
    return [
        f"the robot: {line.partition(_LOST_TIME)[0].rpartition(': ')[2]}{_LOST_TIME}" for line in said[-1:]
    ]


def _robot_channels(
    robot: Robot, *, full_images: bool, camera_problem: str | None = None
) -> tuple[list[Channel], tuple[str, ...]]:
    """The topics that the robot will publish, and why it will not publish the others."""
    channels, left_out = [], []
    for topic, channel in RobotMessages().channels.items():
        if topic is RobotTopic.IMAGE and not full_images:
            left_out.append(f"{topic.value}: off without --full-images")
        elif camera_problem is not None and topic in CAMERA_TOPICS:
            left_out.append(f"{topic.value}: no camera: {camera_problem}")
        elif not robot.data_path.knows(channel.type_name):
            left_out.append(f"{topic.value}: the message type {channel.type_name} is not installed")
        else:
            channels.append(channel)
    return channels, tuple(left_out)


def _await_publisher(robot: Robot, topic: str, process: _Process) -> None:
    deadline_ns = robot.now_ns() + ns_from_s(_START_TIMEOUT_S)
    while not robot.publishers(topic):
        if not process.is_running() or robot.now_ns() > deadline_ns:
            raise RosError(f"nobody published {topic}", remedy="try again with another ROS_DOMAIN_ID")
        robot.wait(None, _POLL_S)


def _run_arguments(request: DemoRequest, folder: Path) -> list[str]:
    files = ("--rules", str(folder / RULES), "--decisions", str(folder / DECISIONS))
    return ["run", *files, "--when-slow", request.when_slow.value]


def _simulate_arguments(request: DemoRequest) -> list[str]:
    return [
        *("simulate", "--seed", str(request.seed)),
        *(("--physics",) if request.physics else ()),
        *(("--mission", str(request.mission)) if request.mission is not None else ()),
        *(("--full-images",) if request.full_images else ()),
    ]


@dataclass(frozen=True, slots=True)
class _Process:
    """A running process, whose output goes to the file ``log``."""

    name: str
    process: subprocess.Popen[bytes]
    log: Path

    def is_running(self) -> bool:
        """Whether it still runs. Raises ``TestudoError`` with the last line of its log where it failed."""
        code = self.process.poll()
        if code in (None, 0):
            return code is None
        lines = self.log.read_text("utf-8", "replace").splitlines()
        said = lines[-1] if lines else f"exit code {code}"
        raise TestudoError(f"the {self.name} failed: {said}")

    def end(self) -> None:
        """Ask it to end as by Ctrl-C, and make it if it does not."""
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(_END_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


@contextmanager
def _testudo(name: str, arguments: Sequence[str], log: Path) -> Iterator[_Process]:
    """``testudo`` with ``arguments`` while the block lasts, then ended."""
    with log.open("wb") as output:
        process = subprocess.Popen(  # noqa: S603  our own programs, with arguments that we make
            [sys.executable, "-m", "smarttestudo", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            # Ctrl-C in the terminal ends this process, which ends the others in order.
            start_new_session=True,
        )
        child = _Process(name, process, log)
        try:
            yield child
        finally:
            child.end()

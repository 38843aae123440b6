# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that are relayed without Python, and what is lost or doubled where they come and go: nothing."""

from __future__ import annotations

import os
import random
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from ros.ros_processes import SmallRobot, threads_of
from smarttestudo.domain.compiled_relay import (
    CompiledRelay,
    Copying,
    FlowCounts,
    MessageCopy,
    PacedStream,
    RelayCounts,
    RelayState,
)
from smarttestudo.domain.robot import DataPathKind, Payload, Qos, Robot
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.robot.ros import open_robot

pytestmark = pytest.mark.usefixtures("compiled_relays")

TEXT = "std_msgs/msg/String"
IMU = {"type": "sensor_msgs/msg/Imu", "hz": 200}
TIMEOUT_S = 120.0
AHEAD = 4
NONE = FlowCounts()


@pytest.fixture(params=[True, False], ids=["reliable", "best-effort"])
def qos(request: pytest.FixtureRequest) -> Qos:
    return Qos(reliable=request.param, transient_local=False)


@pytest.fixture
def fast(in_domain: None) -> Iterator[Robot]:
    with open_robot(data_path=DataPathKind.FAST) as opened:
        yield opened


def text(number: int, size_bytes: int = 0) -> bytes:
    """A std_msgs/String as CDR, as long as the middleware makes it."""
    data = f"{number:08}".encode() + bytes(size_bytes) + b"\x00" * 4
    return b"\x00\x01\x00\x00" + len(data).to_bytes(4, "little") + data


class Echo:
    """A topic relayed to another at Full or at a pace, by Python or without it, whose echo is heard.

    ``seen`` are the numbers and stamps of all messages that Python was given, as they came or as copies.
    """

    def __init__(self, robot: Robot, qos: Qos, pace: Pace) -> None:
        path = robot.data_path
        assert path.compiled is not None
        self.robot, self.compiled, self.pace = robot, path.compiled, pace
        self.state = RelayState(
            now_ns=robot.now_ns(),
            period_ns=pace.period_ns,
            streams=(),
            counts=RelayCounts(arrived=NONE, relayed=NONE),
        )
        self.relay: CompiledRelay | None = None
        self.heard: list[int] = []
        self.seen: list[tuple[int, int]] = []
        self.by_python = 0
        self.source = path.advertise("/numbers", TEXT, qos)
        self.publisher = path.advertise("/testudo/numbers", TEXT, qos)
        self.subscription = path.subscribe("/numbers", TEXT, qos, self._relay)
        path.subscribe(
            "/testudo/numbers", TEXT, qos, lambda payload, _: self.heard.append(int(payload[8:16]))
        )
        self.publish_until_heard()

    def publish_until_heard(self) -> None:
        while not self.heard:
            self.source.publish(text(0))
            self.robot.wait(None, 0.1)
        self.heard.clear()

    def begin(self, *, is_copied: bool = False) -> None:
        copying = Copying(received=self._see_copy, has_payload=True) if is_copied else Copying()
        self.relay = self.compiled.begin(
            self.subscription, self.publisher, lambda: self.state, self._ended, copying
        )

    def end(self) -> None:
        if self.relay is not None:
            self.relay.end()

    def wait_until(self, condition: Callable[[], bool]) -> None:
        end_s = time.monotonic() + TIMEOUT_S
        while not condition():
            assert time.monotonic() < end_s, "nothing came in time"
            self.robot.wait(None, 0.01)

    def wait_for(self, number: int) -> None:
        self.wait_until(lambda: number <= 0 or (bool(self.heard) and self.heard[-1] >= number))

    def _ended(self, state: RelayState) -> None:
        self.relay, self.state = None, state

    def _see_copy(self, copy: MessageCopy) -> None:
        assert copy.payload is not None
        self._see(copy.payload, copy.at.clock_ns)

    def _see(self, payload: Payload, stamp_ns: int) -> None:
        self.seen.append((int(payload[8:16]), stamp_ns))

    def _relay(self, payload: Payload, _publisher: object) -> None:
        now_ns = self.robot.now_ns()
        self.compiled.deliver(self.robot.steady_ns())
        self._see(payload, now_ns)
        self.by_python += 1
        self.publisher.publish(payload)


@pytest.mark.contract
def test_nothing_is_lost_or_doubled_where_a_topic_comes_and_goes(fast: Robot, qos: Qos) -> None:
    echo, chance = Echo(fast, qos, Pace(0)), random.Random(7)
    before = echo.by_python
    for number in range(1, 2001):
        if chance.random() < 0.2:
            echo.end() if echo.relay is not None else echo.begin()
        echo.source.publish(text(number, chance.choice([0, 0, 1, 40_000])))
        # No queue may overflow, which would lose messages, too.
        echo.wait_for(number - AHEAD)
    echo.wait_for(2000)
    echo.end()
    assert [number for number in echo.heard if number] == list(range(1, 2001))
    assert 100 < echo.by_python - before < 1900
    assert echo.subscription.sent == echo.by_python + echo.state.counts.arrived.messages
    assert echo.subscription.dropped == 0


def test_of_a_recorded_topic_python_sees_each_message_once_and_in_order_whoever_takes_it(
    fast: Robot, qos: Qos
) -> None:
    echo, chance = Echo(fast, qos, Pace(0)), random.Random(8)
    before = echo.by_python
    for number in range(1, 2001):
        if chance.random() < 0.2:
            echo.end() if echo.relay is not None else echo.begin(is_copied=True)
        echo.source.publish(text(number, chance.choice([0, 0, 1, 40_000])))
        echo.wait_for(number - AHEAD)
        if chance.random() < 0.1:
            echo.compiled.deliver(fast.steady_ns())
    echo.wait_for(2000)
    echo.end()
    assert [number for number in echo.heard if number] == list(range(1, 2001))
    assert [number for number, _ in echo.seen if number] == list(range(1, 2001))
    assert 100 < echo.by_python - before < 1900
    stamps = [stamp_ns for _, stamp_ns in echo.seen]
    assert stamps == sorted(stamps)
    assert (echo.subscription.sent, echo.subscription.dropped) == (len(echo.seen), 0)


def test_what_comes_right_before_a_topic_is_taken_back_is_not_left_where_it_is(fast: Robot, qos: Qos) -> None:
    echo = Echo(fast, qos, Pace(0))

    def publish_four(first: int) -> None:
        for number in range(first, first + AHEAD):
            echo.source.publish(text(number))

    for first in range(1, 1200, AHEAD):
        publishing = threading.Thread(target=publish_four, args=(first,))
        publishing.start()
        while publishing.is_alive():
            echo.begin()
            echo.end()
        publishing.join()
        echo.wait_for(first + AHEAD - 1)
    assert [number for number in echo.heard if number] == list(range(1, 1201))


def test_what_was_held_when_a_topic_comes_back_is_there(fast: Robot, qos: Qos) -> None:
    echo = Echo(fast, qos, Pace.at(0.01))
    echo.begin()
    for number in (1, 2, 3):
        echo.source.publish(text(number))
    echo.wait_until(lambda: echo.relay is not None and echo.relay.counts().arrived.messages == 3)
    echo.end()
    (stream,) = echo.state.streams
    assert stream.held is not None
    assert (stream.held[:], sum(count for count, *_ in stream.gaps)) == (text(3), 2)
    assert echo.state.counts.relayed.messages == 1
    # Given to another one, it is the final message at its time, which here is now.
    due = PacedStream(publisher=stream.publisher, due_ns=-NEVER_NS, held=stream.held, held_ns=stream.held_ns)
    echo.state = RelayState(now_ns=echo.state.now_ns, period_ns=1, streams=[due], counts=echo.state.counts)
    echo.begin()
    echo.wait_for(3)
    echo.end()
    assert echo.state.streams[0].held is None


def test_what_is_held_of_a_publisher_whose_number_was_forgotten_stays_in_python(
    fast: Robot, qos: Qos
) -> None:
    echo = Echo(fast, qos, Pace.at(0.01))
    held = PacedStream(publisher=b"gone", due_ns=0, last_ns=0, held=text(9), held_ns=0)
    echo.state = replace(echo.state, streams=[held])
    echo.begin()
    assert echo.relay is None
    assert echo.state.streams == [held]
    by_python = echo.by_python
    echo.source.publish(text(1))
    echo.wait_for(1)
    assert echo.by_python == by_python + 1


def test_closing_a_publisher_ends_its_relay_first_and_what_was_copied_is_given(fast: Robot, qos: Qos) -> None:
    echo = Echo(fast, qos, Pace(0))
    echo.begin(is_copied=True)
    echo.source.publish(text(1))
    echo.wait_until(lambda: echo.relay is not None and echo.relay.counts().arrived.messages == 1)
    echo.publisher.close()
    assert echo.relay is None
    assert echo.seen[-1][0] == 1
    echo.publisher = fast.data_path.advertise("/testudo/numbers", TEXT, qos)
    echo.begin()
    assert echo.relay is not None


def test_closing_a_subscription_or_the_path_ends_its_relay_first(fast: Robot, qos: Qos) -> None:
    echo = Echo(fast, qos, Pace(0))
    threads = threads_of(os.getpid())
    echo.begin()
    of_relay = threads_of(os.getpid()) - threads
    assert of_relay
    echo.source.publish(text(1))
    echo.subscription.close()
    assert echo.relay is None
    echo.wait_until(lambda: of_relay.isdisjoint(threads_of(os.getpid())))
    echo.subscription = fast.data_path.subscribe("/numbers", TEXT, qos, lambda *_: None)
    echo.begin()
    assert echo.relay is not None


READ = (
    'begin SetFrequency /imu 50 Rule "Turn" If (CheckValue /imu orientation_x > 3) '
    "Then SetFrequency /imu 60 EndIf end"
)


RECORDED = (
    'begin SetFrequency /imu 50 Rule "Stop" If (CheckValue /stop data > 0) '
    'Then Record "stop" /imu Before 5 s After 1 s EndIf end'
)


@pytest.mark.contract
def test_a_topic_is_relayed_without_python_while_no_rule_reads_it(robot: SmallRobot) -> None:
    path = robot.folder / "rules0.adirf"
    incidents = str(robot.folder / "incidents")
    runtime = robot.runtime(READ, "--data-path", "fast", "--incidents", incidents)
    operator, remote = robot.operator(imu=IMU), robot.remote()
    runtime.line_with("compiled relays")
    robot.source(imu=IMU)
    operator.line_with("heard")
    threads = threads_of(runtime.pid)
    for text, more in (("begin SetFrequency /imu 50 end", 1), (READ, 0), (RECORDED, 1), (READ, 0)):
        path.write_text(text, encoding="utf-8")
        assert remote.ask("reload")[0]
        end_s = time.monotonic() + TIMEOUT_S
        while len(begun := threads_of(runtime.pid) - threads) != more:
            assert time.monotonic() < end_s, (begun, more)
            operator.line_with("heard")

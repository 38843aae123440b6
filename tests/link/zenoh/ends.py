# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of a link on this machine, for tests."""

from __future__ import annotations

import atexit
import functools
import itertools
import socket
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress

import pytest
import zenoh

from first_free import first_free
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.zenoh import link_client, open_operator_end, open_robot_end, session
from smarttestudo.link.zenoh.arrivals import LinkEvent
from smarttestudo.link.zenoh.operator_end import OperatorEnd
from smarttestudo.link.zenoh.robot_end import RobotEnd
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.link.zenoh.session import open_session

WITHIN_S = 30.0
# Linux gives none of these to who asks for any port or connects to somebody; pages are served below them.
PORTS = range(21_000, 30_000)
PORTS_OF_RUN = 100
ODOM = StreamInfo(
    topic="/odom",
    type_name="nav_msgs/msg/Odometry",
    qos=Qos(reliable=True, transient_local=False, depth=5),
    definition="float64 x",
)
MAP = StreamInfo(
    topic="/map",
    type_name="nav_msgs/msg/OccupancyGrid",
    qos=Qos(reliable=True, transient_local=True, depth=1),
)


@pytest.fixture
def quick_watch(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have who is connected looked at often: a cause is said once it was there twice."""
    for module in (link_client, session):
        monkeypatch.setattr(module, "POLL_PERIOD_S", 0.2)


def free_endpoint(protocol: str = "tcp", host: str = "127.0.0.1") -> str:
    """An endpoint of this machine where nobody listens, and no other test run will."""
    return f"{protocol}/{host}:{next(filter(_is_free, _own_ports()))}"


@functools.cache
def _own_ports() -> Iterator[int]:
    """Ports of this process, again and again."""
    held = ExitStack()
    atexit.register(held.close)
    first = held.enter_context(first_free("ports", PORTS[::PORTS_OF_RUN]))
    return itertools.cycle(range(first, first + PORTS_OF_RUN))


def _is_free(port: int) -> bool:
    with socket.socket() as probe, suppress(OSError):
        # What an earlier connection left of a port keeps nobody from listening there.
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind(("127.0.0.1", port))
        return True
    return False


def refuse_warning(text: str) -> None:
    """Nobody should be warned, except of an end that stands still with its machine."""
    if not text.endswith(("that process stands still", "it cannot be reached: timed out")):
        raise AssertionError(text)


@contextmanager
def robot_end(
    endpoint: str, name: str = "r1", warn: Callable[[str], None] = refuse_warning
) -> Iterator[RobotEnd]:
    """A robot that connects to ``endpoint``."""
    with open_robot_end(name, LinkOptions(connect=(endpoint,)), warn) as end:
        yield end


@contextmanager
def operator_end(endpoint: str, warn: Callable[[str], None] = refuse_warning) -> Iterator[OperatorEnd]:
    """An operator that listens at ``endpoint``."""
    with open_operator_end(LinkOptions(listen=(endpoint,)), warn) as end:
        yield end


@contextmanager
def stranger_at(endpoint: str, mode: str = "client") -> Iterator[zenoh.Session]:
    """A session of somebody else."""
    with open_session(LinkOptions(connect=(endpoint,)), mode, refuse_warning) as opened:
        yield opened.session


def until(
    condition: Callable[[], bool], act: Callable[[], object] = lambda: None, *, within_s: float = WITHIN_S
) -> None:
    """Wait for ``condition``, and ``act`` again and again meanwhile."""
    end_s = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < end_s, "it took too long"
        act()
        time.sleep(0.02)


class Reader:
    """What an operator has read so far."""

    def __init__(self, end: OperatorEnd) -> None:
        self.end = end
        self.events: list[LinkEvent] = []

    def read(self) -> list[LinkEvent]:
        """All events so far."""
        self.events += self.end.wait(0.02)
        return self.events

    def payloads(self, topic: str = "/odom", robot: str = "r1") -> list[bytes]:
        """The messages of a topic so far."""
        return [message.payload for message in messages(self.read()) if _is_of(message, topic, robot)]


def messages(events: Iterable[LinkEvent]) -> list[ReceivedMessage]:
    """The messages among ``events``."""
    return [event for event in events if isinstance(event, ReceivedMessage)]


def _is_of(message: ReceivedMessage, topic: str, robot: str) -> bool:
    return message.stream.topic == topic and message.robot == robot

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The processes at both ends of a link: SmartTestudo's, plain Zenoh's, and a plain TCP flow beside them.

Both ends run on one machine and read the same monotonic clock, so that arrival minus publication is the age.
"""

from __future__ import annotations

import heapq
import json
import os
import resource
import socket
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager

from thin_link.fast_dds import fast_dds_operator, fast_dds_robot
from thin_link.foxglove_websocket import foxglove_operator, foxglove_robot
from thin_link.network_namespaces import OPERATOR_ADDRESS
from thin_link.traffic import HEAD, Note, Publish, Publishing, Topic

ENDPOINT = f"tcp/{OPERATOR_ADDRESS}:7447"
FLOW_PORT = 7448
_CONNECTED_WITHIN_S = 15.0


def be_robot(contender: str, topics: Sequence[Topic], seconds: float, endpoint: str = ENDPOINT) -> None:
    """Connect, wait for a line, publish for ``seconds``, and tell what that took."""
    with _robot(contender, topics, endpoint) as end:
        give_up_s = time.monotonic() + _CONNECTED_WITHIN_S
        while not end.is_connected():
            if time.monotonic() > give_up_s:
                return
            time.sleep(0.05)
        print(json.dumps("connected"), flush=True)
        sys.stdin.readline()
        cpu_s = _cpu_s()
        start_ns = time.monotonic_ns()
        print(json.dumps(start_ns), flush=True)
        published = _publish(topics, end.publishers, start_ns, seconds)
        print(json.dumps({"cpu_s": _cpu_s() - cpu_s, "published": published}), flush=True)
        sys.stdin.readline()
        print(json.dumps(end.counts()), flush=True)
        sys.stdin.readline()


def be_operator(contender: str, topics: Sequence[Topic], endpoint: str = ENDPOINT) -> None:
    """Receive until a line comes, and tell what arrived: topic, number, published and arrived in ns, size."""
    arrived: list[tuple[str, int, int, int, int]] = []

    def note(topic: str, payload: bytes) -> None:
        stamp_ns, number = HEAD.unpack_from(payload)
        arrived.append((topic, number, stamp_ns, time.monotonic_ns(), len(payload)))

    with _operator(contender, note, topics, endpoint):
        print(json.dumps("listening"), flush=True)
        sys.stdin.readline()
        print(json.dumps(arrived), flush=True)


def be_flow_source(seconds: float) -> None:
    """Send as much as TCP lets through."""
    block = os.urandom(65_536)
    with socket.create_connection((OPERATOR_ADDRESS, FLOW_PORT)) as flow:
        end_s = time.monotonic() + seconds
        while time.monotonic() < end_s:
            flow.send(block)


def be_flow_sink() -> None:
    """Receive one flow, and tell how many bytes had come by when, in ns."""
    seen: list[tuple[int, int]] = []
    listener = socket.create_server((OPERATOR_ADDRESS, FLOW_PORT))

    def receive() -> None:
        flow, _ = listener.accept()
        total = 0
        while data := flow.recv(65_536):
            total += len(data)
            seen.append((time.monotonic_ns(), total))

    threading.Thread(target=receive, daemon=True).start()
    print(json.dumps("listening"), flush=True)
    sys.stdin.readline()
    print(json.dumps(seen), flush=True)


def _publish(
    topics: Sequence[Topic], publishers: Sequence[Publish], start_ns: int, seconds: float
) -> Sequence[int]:
    """Publish each topic on its grid; how many messages that were."""
    bodies = [topic.payload() for topic in topics]
    numbers = [0] * len(topics)
    due = [(topic.from_s, at) for at, topic in enumerate(topics)]
    heapq.heapify(due)
    # A publisher may block; what was due then is late, and is old when it arrives.
    while due[0][0] < seconds and time.monotonic_ns() - start_ns < seconds * 1e9:
        due_s, at = heapq.heappop(due)
        time.sleep(max(0.0, due_s - (time.monotonic_ns() - start_ns) / 1e9))
        publishers[at](HEAD.pack(start_ns + round(due_s * 1e9), numbers[at]) + bodies[at])
        numbers[at] += 1
        heapq.heappush(due, (due_s + 1 / topics[at].hz, at))
    return numbers


def _cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def warn(text: str) -> None:
    """Say what somebody should read."""
    print(text, file=sys.stderr)


def _robot(contender: str, topics: Sequence[Topic], endpoint: str) -> AbstractContextManager[Publishing]:
    match contender:
        case "testudo":
            return _testudo_robot(topics, endpoint, needs_datagrams=False)
        case "testudo-datagrams":
            return _testudo_robot(topics, endpoint, needs_datagrams=True)
        case "fastdds":
            return fast_dds_robot(topics)
        case "foxglove":
            return foxglove_robot(topics)
        case "none":
            return _no_robot(topics)
        case _:
            return _zenoh_robot(contender, topics, endpoint)


def _operator(
    contender: str, note: Note, topics: Sequence[Topic], endpoint: str
) -> AbstractContextManager[None]:
    match contender:
        case "testudo" | "testudo-datagrams":
            return _testudo_operator(note, endpoint)
        case "fastdds":
            return fast_dds_operator(note, topics)
        case "foxglove":
            return foxglove_operator(note, topics)
        case _:
            return _zenoh_operator(contender, note, topics, endpoint)


@contextmanager
def _testudo_robot(topics: Sequence[Topic], endpoint: str, *, needs_datagrams: bool) -> Iterator[Publishing]:
    from smarttestudo.domain.link import LinkNeeds, StreamInfo  # noqa: PLC0415
    from smarttestudo.domain.robot import Qos  # noqa: PLC0415
    from smarttestudo.link.zenoh import open_robot_end  # noqa: PLC0415  the rival needs none of it
    from smarttestudo.link.zenoh.security import LinkOptions  # noqa: PLC0415

    qos = Qos(reliable=False, transient_local=False, depth=5)
    options = LinkOptions(connect=(endpoint,), insecure=True, needs_datagrams=needs_datagrams)
    with open_robot_end("robot", options, warn) as end:
        end.follow(
            {
                one.name: LinkNeeds(priority=one.priority, floor_hz=one.floor_hz, is_full=one.is_full)
                for one in topics
            }
        )
        infos = [StreamInfo(topic=one.name, type_name="std_msgs/msg/String", qos=qos) for one in topics]
        yield Publishing(
            publishers=[end.advertise(info).publish for info in infos],
            is_connected=lambda: end.state.is_connected,
            counts=lambda: {topic: (one.sent, one.overflowed) for topic, one in end.counts().items()},
        )


@contextmanager
def _no_robot(topics: Sequence[Topic]) -> Iterator[Publishing]:
    """The same source without a link."""
    yield Publishing(publishers=[lambda _payload: None for _ in topics], is_connected=lambda: True)


@contextmanager
def _testudo_operator(note: Note, endpoint: str) -> Iterator[None]:
    from smarttestudo.domain.link import ReceivedMessage  # noqa: PLC0415
    from smarttestudo.link.zenoh import open_operator_end  # noqa: PLC0415  the rival needs none of it
    from smarttestudo.link.zenoh.security import LinkOptions  # noqa: PLC0415

    is_closed = threading.Event()
    with open_operator_end(LinkOptions(listen=(endpoint,), insecure=True), warn) as end:

        def read() -> None:
            while not is_closed.is_set():
                for event in end.wait(0.1):
                    if isinstance(event, ReceivedMessage):
                        note(event.stream.topic, event.payload)

        reader = threading.Thread(target=read)
        reader.start()
        try:
            yield
        finally:
            is_closed.set()
            reader.join()


@contextmanager
def _zenoh_robot(way: str, topics: Sequence[Topic], endpoint: str) -> Iterator[Publishing]:
    from thin_link.plain_zenoh import plain_robot  # noqa: PLC0415  needs zenoh

    priorities = {one.name: one.zenoh_priority for one in topics}
    with plain_robot(way, endpoint, priorities, compresses=_compresses(topics)) as (puts, is_connected):
        yield Publishing(publishers=[puts[one.name] for one in topics], is_connected=is_connected)


@contextmanager
def _zenoh_operator(way: str, note: Note, topics: Sequence[Topic], endpoint: str) -> Iterator[None]:
    from thin_link.plain_zenoh import plain_operator  # noqa: PLC0415  needs zenoh

    with plain_operator(way, endpoint, note, compresses=_compresses(topics)):
        yield


def _compresses(topics: Sequence[Topic]) -> bool:
    return any(topic.noise < 1 for topic in topics)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Many robots' ends in one process, a Zenoh router, and an operator's end that nobody reads."""

from __future__ import annotations

import json
import sys
import threading
import time
from contextlib import ExitStack

from smarttestudo.domain.link import LinkNeeds, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions
from thin_link.network_namespaces import OPERATOR_ADDRESS
from thin_link.roles import ENDPOINT, warn

ROUTER = f"tcp/{OPERATOR_ADDRESS}:7449"
_BYTES, _HZ = 720, 10
FLEET_BYTES_PER_S = _BYTES * _HZ


def be_fleet(count: int, endpoint: str) -> None:
    """So many robots that each send odometry, until a line comes."""
    qos = Qos(reliable=False, transient_local=False, depth=5)
    info = StreamInfo(topic="/odom", type_name="nav_msgs/msg/Odometry", qos=qos)
    options = LinkOptions(connect=(endpoint,), insecure=True)
    payload = bytes(range(240)) * (_BYTES // 240)
    with ExitStack() as opened:
        ends = [opened.enter_context(open_robot_end(f"r{number}", options, warn)) for number in range(count)]
        for end in ends:
            end.follow({info.topic: LinkNeeds(priority=1, floor_hz=0)})
        streams = [end.advertise(info) for end in ends]
        while not all(end.state.is_connected for end in ends):
            time.sleep(0.1)
        ended = set_by_a_line()
        print(json.dumps("connected"), flush=True)
        start_s = time.monotonic()
        number = 0
        while not ended.is_set():
            # One after the other, as robots do that know nothing of each other.
            time.sleep(max(0.0, start_s + number / (_HZ * count) - time.monotonic()))
            streams[number % count].publish(payload)
            number += 1


def set_by_a_line() -> threading.Event:
    """An event that is set once a line comes."""
    come = threading.Event()

    def listen() -> None:
        sys.stdin.readline()
        come.set()

    threading.Thread(target=listen, daemon=True).start()
    return come


def be_router() -> None:
    """Connect whoever connects, until a line comes."""
    import zenoh  # noqa: PLC0415  only this role needs it itself

    config = zenoh.Config()
    for key, value in {
        "mode": "router",
        "listen/endpoints": [ROUTER],
        "scouting/multicast/enabled": False,
        "transport/shared_memory/enabled": False,
    }.items():
        config.insert_json5(key, json.dumps(value))
    with zenoh.open(config):
        print(json.dumps("listening"), flush=True)
        sys.stdin.readline()


def be_stuck() -> None:
    """An operator's end that is read until a line comes, and from then on by nobody."""
    with open_operator_end(LinkOptions(listen=(ENDPOINT,), insecure=True), warn) as end:
        print(json.dumps("listening"), flush=True)
        stopped = set_by_a_line()
        while not stopped.is_set():
            end.wait(0.1)
        print(json.dumps("stopped"), flush=True)
        threading.Event().wait()

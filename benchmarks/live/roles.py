# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The processes of benchmarks beside the runtime: sources, an operator, a plain rclpy relay and recorder.

usage: roles.py source|operator|hearer|plain_relay|c_relay|plain_recorder|alarm JSON, where JSON is a list of
topics: {"name": "/imu", "type": "sensor_msgs/msg/Imu", "hz": 195, "target_hz": 50, "size_bytes": 324}. Every
message is bytes that are sent as they are, with the monotonic time of sending in its header's stamp. What is
relayed of it has ``prefix`` before its name. A line on stdin asks for a result in JSON, the end of stdin ends
the process.
"""

from __future__ import annotations

import ctypes
import importlib
import json
import math
import os
import signal
import struct
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STAMP = struct.Struct("<iI")
STAMP_AT = 4
NS_PER_S = 1_000_000_000
SMALL_BYTES = 65_536
PREFIX = "/testudo"
DIRECT = "/direct"

Topic = dict[str, Any]


def message_class(topic: Topic) -> Any:
    """The class of the topic's type."""
    package, _, name = topic["type"].split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def stamp_now(payload: bytearray) -> bytes:
    """The payload, sent now."""
    STAMP.pack_into(payload, STAMP_AT, *divmod(time.monotonic_ns(), NS_PER_S))
    return bytes(payload)


def age_ns(payload: bytes) -> int:
    """How long ago the payload was sent."""
    seconds, nanoseconds = STAMP.unpack_from(payload, STAMP_AT)
    return int(time.monotonic_ns() - seconds * NS_PER_S - nanoseconds)


def answers(answer: Any) -> threading.Event:
    """Answer each line of stdin; the event is set when stdin ends."""
    ended = threading.Event()

    def listen() -> None:
        for line in sys.stdin:
            print(json.dumps(answer(line.strip())), flush=True)
        ended.set()

    threading.Thread(target=listen, daemon=True).start()
    return ended


def source(node: Any, topics: list[Topic]) -> None:
    """Publish each topic at its rate; answers how many messages of all were sent.

    ``pause`` has it send nothing until ``resume``.
    """
    sent: Counter[str] = Counter()
    may_send = threading.Event()
    may_send.set()
    publishers = [node.create_publisher(message_class(topic), topic["name"], 10) for topic in topics]
    payloads = [bytearray(b"\x00\x01\x00\x00" + bytes(topic["size_bytes"])) for topic in topics]
    due_s = [time.monotonic()] * len(topics)

    def answer(line: str) -> int:
        if line == "pause":
            may_send.clear()
        elif line == "resume":
            may_send.set()
        return sum(sent[topic["name"]] for topic in topics)

    ended = answers(answer)
    while not ended.is_set():
        if not may_send.wait(0.1):
            due_s = [time.monotonic()] * len(topics)
            continue
        for number, topic in enumerate(topics):
            if due_s[number] <= time.monotonic():
                publishers[number].publish(stamp_now(payloads[number]))
                sent[topic["name"]] += 1
                due_s[number] += 1 / topic["hz"]
        time.sleep(max(min(due_s) - time.monotonic(), 0))


def operator(node: Any, topics: list[Topic], prefix: str = PREFIX) -> None:
    """Hear what is relayed, under names with ``prefix``; answers the ages at arrival in µs.

    Those of small messages, if there are any. ``forget`` begins anew, ``endpoints NAME`` answers how many
    readers and writers the node NAME has.
    """
    ages_us: list[float] = []
    has_small = any(topic["size_bytes"] <= SMALL_BYTES for topic in topics)

    def heard(payload: bytes) -> None:
        if len(payload) <= SMALL_BYTES or not has_small:
            ages_us.append(age_ns(payload) / 1000)

    subscriptions = [
        node.create_subscription(
            message_class(topic),
            topic["name"] if topic["name"] == DIRECT else topic.get("prefix", prefix) + topic["name"],
            heard,
            QoSProfile(depth=100),
            raw=True,
        )
        for topic in topics
    ]

    def answer(line: str) -> Any:
        if line == "forget":
            ages_us.clear()
        elif line.startswith("endpoints "):
            return endpoints(node, line.split()[1])
        return ages_us

    ended = answers(answer)
    while not ended.is_set():
        rclpy.spin_once(node, timeout_sec=0.1)
    del subscriptions


def endpoints(node: Any, name: str) -> list[int]:
    """How many readers and writers the node of that name has."""
    topics = [topic for topic, _ in node.get_topic_names_and_types()]
    found = (node.get_subscriptions_info_by_topic, node.get_publishers_info_by_topic)
    return [sum(one.node_name == name for topic in topics for one in find(topic)) for find in found]


def plain_relay(node: Any, topics: list[Topic]) -> None:
    """What one writes in an hour: raw subscriptions, the usual gate, rclpy's default executor."""
    last_s: dict[str, float] = {}

    def relay(publisher: Any, name: str, target_hz: float, payload: bytes) -> None:
        now_s = time.monotonic()
        if now_s - last_s.get(name, -math.inf) >= 1 / target_hz:
            last_s[name] = now_s
            publisher.publish(payload)

    kept = []
    for topic in topics:
        name, kind = topic["name"], message_class(topic)
        publisher = node.create_publisher(kind, PREFIX + name, 10)
        received = partial(relay, publisher, name, topic["target_hz"])
        kept.append(node.create_subscription(kind, name, received, 10, raw=True))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    ended = answers(lambda _: None)
    while not ended.is_set():
        executor.spin_once(timeout_sec=0.2)


def c_relay(node: Any, topics: list[Topic]) -> None:
    """What one writes in an hour in C: see c_relay.c, compiled to the file that C_RELAY names."""
    # Its loop looks at no signal.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    subscriptions, publishers = [], []
    for topic in topics:
        name, kind = topic["name"], message_class(topic)
        subscriptions.append(node.create_subscription(kind, name, print, 10, raw=True))
        publishers.append(node.create_publisher(kind, topic.get("prefix", PREFIX) + name, 10))
    ctypes.CDLL("librcl.so", mode=os.RTLD_NOLOAD | ctypes.RTLD_GLOBAL)
    periods_ns = [int(NS_PER_S / topic["target_hz"]) for topic in topics]
    pointers = ctypes.c_void_p * len(topics)
    answers(lambda _: None)
    ctypes.CDLL(os.environ["C_RELAY"]).relay(
        ctypes.c_void_p(node.context.handle.pointer),
        ctypes.c_size_t(len(topics)),
        pointers(*(one.handle.pointer for one in subscriptions)),
        pointers(*(one.handle.pointer for one in publishers)),
        (ctypes.c_int64 * len(topics))(*periods_ns),
        (ctypes.c_int64 * len(topics))(),
    )


def plain_recorder(node: Any, topics: list[Topic]) -> None:
    """What one writes in an hour to record: raw subscriptions, and the writer of rosbags."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Writer(f"{folder}/bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer,
    ):

        def record(connection: Any, payload: bytes) -> None:
            writer.write(connection, time.time_ns(), payload)

        kept = []
        store = get_typestore(Stores.ROS2_JAZZY)
        for topic in topics:
            connection = writer.add_connection(topic["name"], topic["type"], typestore=store)
            received = partial(record, connection)
            kept.append(node.create_subscription(message_class(topic), topic["name"], received, 10, raw=True))
        ended = answers(lambda _: None)
        while not ended.is_set():
            rclpy.spin_once(node, timeout_sec=0.2)


def alarm(node: Any, topics: list[Topic]) -> None:
    """Publish on the first topic, a std_msgs/Float64, the number that a line holds; answers with the time."""
    publisher = node.create_publisher(message_class(topics[0]), topics[0]["name"], 10)

    def publish(line: str) -> float:
        publisher.publish(b"\x00\x01\x00\x00" + struct.pack("<d", float(line)))
        return time.monotonic()

    ended = answers(publish)
    while not ended.is_set():
        rclpy.spin_once(node, timeout_sec=0.2)


def main() -> None:
    """Run the role."""
    roles: dict[str, Callable[..., None]] = {
        "source": source,
        "operator": operator,
        "hearer": partial(operator, prefix=""),
        "plain_relay": plain_relay,
        "c_relay": c_relay,
        "plain_recorder": plain_recorder,
        "alarm": alarm,
    }
    rclpy.init()
    node = rclpy.create_node(sys.argv[1])
    roles[sys.argv[1]](node, json.loads(sys.argv[2]))


if __name__ == "__main__":
    main()

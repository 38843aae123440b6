# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of plain ROS 2 over Fast DDS, by UDP alone: namespaces share /dev/shm, in which it would meet."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

from thin_link.traffic import Note, Publishing, Topic

ENVIRONMENT: Mapping[str, str] = {
    "ROS_DOMAIN_ID": "79",
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
    "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
}
# Bytes are sent as they are, behind what says that they are CDR.
_CDR = b"\x00\x01\x00\x00"


@contextmanager
def _node(name: str) -> Iterator[Any]:
    import rclpy  # noqa: PLC0415  the others need no ROS

    rclpy.init()
    try:
        yield rclpy.create_node(name)
    finally:
        rclpy.try_shutdown()


def _qos(topic: Topic) -> Any:
    """What a driver offers: sensors are best effort, all else is reliable."""
    from rclpy.qos import QoSProfile, qos_profile_sensor_data  # noqa: PLC0415  see above

    return QoSProfile(depth=10) if topic.reliable else qos_profile_sensor_data


@contextmanager
def fast_dds_robot(topics: Sequence[Topic]) -> Iterator[Publishing]:
    """A publisher for each topic."""
    from std_msgs.msg import String  # noqa: PLC0415  see above

    with _node("robot") as node:
        publishers = [node.create_publisher(String, one.name, _qos(one)) for one in topics]

        def put(publisher: Any, payload: bytes) -> None:
            publisher.publish(_CDR + payload)

        yield Publishing(
            publishers=[partial(put, publisher) for publisher in publishers],
            is_connected=lambda: all(publisher.get_subscription_count() for publisher in publishers),
        )


@contextmanager
def fast_dds_operator(note: Note, topics: Sequence[Topic]) -> Iterator[None]:
    """A subscriber for each topic, in a thread of its own."""
    from rclpy.executors import SingleThreadedExecutor  # noqa: PLC0415  see above
    from std_msgs.msg import String  # noqa: PLC0415

    def take(topic: str, data: bytes) -> None:
        note(topic, data[len(_CDR) :])

    with _node("operator") as node:
        for one in topics:
            node.create_subscription(String, one.name, partial(take, one.name), _qos(one), raw=True)
        executor, is_closed = SingleThreadedExecutor(), threading.Event()
        executor.add_node(node)

        def read() -> None:
            while not is_closed.is_set():
                executor.spin_once(timeout_sec=0.1)

        reader = threading.Thread(target=read)
        reader.start()
        try:
            yield
        finally:
            is_closed.set()
            reader.join()

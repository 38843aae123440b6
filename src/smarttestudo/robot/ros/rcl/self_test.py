# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tests whether librcl does here what its path relies on."""

from __future__ import annotations

import time
from contextlib import ExitStack
from ctypes import c_void_p
from typing import Any

from rclpy.serialization import serialize_message

from smarttestudo.domain.compiled_relay import MessageCopy
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import DataPathKind, Qos
from smarttestudo.robot.ros.message_types import message_type
from smarttestudo.robot.ros.rcl.bindings import InfoLayout, MessageInfo, RclBuffers, RclLibrary
from smarttestudo.robot.ros.rcl.compiled_relays import relay_settings
from smarttestudo.robot.ros.rcl.message_copies import MessageCopies
from smarttestudo.robot.ros.rcl.publisher import RclPublisher
from smarttestudo.robot.ros.rcl.relay_library import RelayLibrary, RelaySettings
from smarttestudo.robot.ros.rcl.subscription import RclSubscription
from smarttestudo.robot.ros.rcl.wake_ups import RclWakeUps

TOPIC = "~/_self_test"
"""Hidden and private; it exists for some milliseconds."""
RELAYED_TOPIC = "~/_self_test_relayed"
TYPE_NAME = "builtin_interfaces/msg/Time"
TIMEOUT_S = 5.0
# Latched, so that the message arrives whenever the two have found each other.
QOS = Qos(reliable=True, transient_local=True, depth=1)


def tested_layout(node: Any, library: RclLibrary) -> InfoLayout:
    """Publish a message to oneself, be woken for it and take it; what was found of its info.

    Raises ``RosError`` where the message does not arrive as it was sent.
    """
    publisher = RclPublisher(node, library, TOPIC, TYPE_NAME, QOS)
    subscription = RclSubscription(node, library, TOPIC, TYPE_NAME, QOS)
    buffers = RclBuffers(library)
    try:
        sent = serialize_message(message_type(TYPE_NAME, TOPIC)(sec=1, nanosec=2))
        publisher.publish(sent)
        info = MessageInfo(InfoLayout(gid_bytes=0, is_numbered=False))
        received = _Receiver(subscription, buffers, info).first(TIMEOUT_S)
        if received != sent:
            raise RosError("a message sent through librcl came back changed")
        return InfoLayout.found_in(info.raw, _own_gid(node))
    finally:
        buffers.close()
        subscription.close()
        publisher.close()


def tested_relays(
    node: Any, library: RclLibrary, layout: InfoLayout, kind: DataPathKind
) -> RelayLibrary | None:
    """Library of compiled relays; ``None`` where it does not work, or is not wanted by the ``kind`` of path.

    Raises ``RosError`` where it does not work, and nothing else is wanted.
    """
    if kind is DataPathKind.RCL:
        return None
    try:
        relays = RelayLibrary()
        _require_relays(node, library, relays, layout)
    except RosError:
        if kind is DataPathKind.FAST:
            raise
        return None
    return relays


def _require_relays(node: Any, library: RclLibrary, relays: RelayLibrary, layout: InfoLayout) -> None:
    """Have a message to oneself relayed without Python.

    Raises ``RosError`` where messages have no numbers, or it does not arrive as it was sent.
    """
    if not layout.is_numbered:
        raise RosError("the middleware does not number messages")
    with ExitStack() as opened:
        publisher = RclPublisher(node, library, TOPIC, TYPE_NAME, QOS)
        opened.callback(publisher.close)
        relayed = RclPublisher(node, library, RELAYED_TOPIC, TYPE_NAME, QOS)
        opened.callback(relayed.close)
        source = RclSubscription(node, library, TOPIC, TYPE_NAME, QOS)
        opened.callback(source.close)
        copies = MessageCopies(_fail)
        opened.callback(copies.close)
        settings = RelaySettings(
            **relay_settings(library, layout), subscription=source.pointer, publisher=relayed.pointer
        )
        copied: list[MessageCopy] = []
        copied_source = copies.of_taken(
            c_void_p(settings.rcl.take),
            source.pointer,
            layout.gid_bytes,
            lambda _, copy: copied.append(copy),
            has_payload=True,
        )
        settings.rcl.take, settings.subscription = copies.take, copied_source.address
        relay = relays.new(settings)
        opened.callback(relays.free, relay)
        if not relays.start(relay):
            raise RosError("no thread could be started")
        opened.callback(relays.stop, relay)
        opened.callback(source.wake, wanted=False)
        source.call(relays.on_message, relay)
        subscription = RclSubscription(node, library, RELAYED_TOPIC, TYPE_NAME, QOS)
        opened.callback(subscription.close)
        buffers = RclBuffers(library)
        opened.callback(buffers.close)
        sent = serialize_message(message_type(TYPE_NAME, TOPIC)(sec=3, nanosec=4))
        publisher.publish(sent)
        info = MessageInfo(layout)
        if _Receiver(subscription, buffers, info).first(TIMEOUT_S) != sent:
            raise RosError("a message relayed without Python came back changed")
        copies.remove([copied_source])
        if [copy.payload for copy in copied] != [sent]:
            raise RosError("the copy of a message relayed without Python is another one")


def _fail(error: RosError) -> None:
    raise error


class _Receiver:
    """Is woken for a message and takes it."""

    priority = 1.0

    def __init__(self, subscription: RclSubscription, buffers: RclBuffers, info: MessageInfo) -> None:
        self._subscription = subscription
        self._buffers = buffers
        self._info = info
        self._received: bytes | None = None

    def first(self, timeout_s: float) -> bytes:
        """The first message that wakes; ``RosError`` after ``timeout_s``, or if it cannot be taken."""
        wake_ups = RclWakeUps()
        wake_ups.add(self._subscription.event_fd, self)
        self._subscription.wake(wanted=True)
        end_s = time.monotonic() + timeout_s
        try:
            while self._received is None and time.monotonic() < end_s:
                wake_ups.wait(end_s - time.monotonic())
        finally:
            wake_ups.close()
        if self._received is None:
            raise RosError(f"librcl announced no message to its publisher's own process in {timeout_s:g} s")
        return self._received

    def serve(self, most: int) -> bool:  # noqa: ARG002 - there is but one
        payload = self._subscription.take(self._buffers, self._info)
        self._received = None if payload is None else payload[:]
        return False


def _own_gid(node: Any) -> bytes:
    endpoints = node.get_publishers_info_by_topic(node.resolve_topic_name(TOPIC))
    return next((bytes(one.endpoint_gid) for one in endpoints if one.node_name == node.get_name()), b"")

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A subscription whose messages are taken by librcl, not by rclpy's executor."""

from __future__ import annotations

import os
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks

from smarttestudo.adapters.ros.message_info import MessageInfo
from smarttestudo.adapters.ros.message_types import message_type
from smarttestudo.adapters.ros.qos import qos_profile
from smarttestudo.adapters.ros.rcl_buffers import RclBuffers, RclPayload
from smarttestudo.adapters.ros.rcl_library import (
    RCL_RET_OK,
    RCL_RET_SUBSCRIPTION_TAKE_FAILED,
    RclLibrary,
)
from smarttestudo.adapters.ros.ros_errors import ros_errors
from smarttestudo.domain.robot import Qos


class Unattended(CallbackGroup):  # type: ignore[misc]
    """Entities that rclpy's executor leaves alone."""

    def can_execute(self, entity: Any) -> bool:  # noqa: ARG002 - of any entity
        """Never."""
        return False


class RclSubscription:
    """Takes messages, and counts new ones up on ``event_fd`` while it is to wake.

    ``is_heard`` says whether any message came. All calls raise ``RosError``.
    """

    def __init__(self, node: Any, library: RclLibrary, topic: str, type_name: str, qos: Qos) -> None:
        self._node = node
        self._library = library
        self._topic = topic
        with ros_errors(topic):
            self._handle = node.create_subscription(
                message_type(type_name, topic),
                topic,
                _never_called,
                qos_profile(qos),
                callback_group=Unattended(),
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
                raw=True,
            )
        self._pointer: int = self._handle.handle.pointer
        self.is_heard = False
        self.event_fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)

    def wake(self, *, wanted: bool) -> None:
        """Wake for new messages from now on, those that are already there included; or for none."""
        self._library.wake_on_message(self._pointer, self.event_fd if wanted else None)

    def take(self, buffers: RclBuffers, info: MessageInfo) -> RclPayload | None:
        """The oldest message that waits, described by ``info``; ``None`` if there is none."""
        library = self._library
        code = library.take(self._pointer, buffers.next().address, info.address, None)
        if code == RCL_RET_OK:
            self.is_heard = True
            return buffers.lend()
        if code != RCL_RET_SUBSCRIPTION_TAKE_FAILED:
            raise library.error(code, self._topic)
        return None

    def close(self) -> None:
        """Receive nothing more."""
        self.wake(wanted=False)
        self._node.destroy_subscription(self._handle)
        os.close(self.event_fd)


def _never_called(message: object) -> None:
    """What rclpy wants for a callback."""

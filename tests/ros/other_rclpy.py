# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo`` on an rclpy that lacks something.

usage: other_rclpy.py LACK COMMAND …
With LACK ``event_handler`` that module has the name it has in Humble, ``qos_event``; with ``pointer`` nothing
tells us its address, and with ``service_pointer`` no service does. The executor of rclpy itself needs them.
With ``serialized_bytes`` what takes messages serialized gets none that has a ``uint8[]``, as in Lyrical.
"""

from __future__ import annotations

import sys
import types
from typing import Any

import rclpy.node
from rclpy.impl.implementation_singleton import rclpy_implementation

from smarttestudo.cli.main import main

WITHOUT_POINTER = {
    "pointer": ("Publisher", "Subscription", "Service", "Client"),
    "service_pointer": ("Service",),
}


def take_away(lack: str) -> None:
    if lack == "event_handler":
        moved = types.ModuleType("rclpy.qos_event")
        moved.SubscriptionEventCallbacks = rclpy.node.SubscriptionEventCallbacks  # type: ignore[attr-defined]
        sys.modules["rclpy.qos_event"] = moved
        sys.modules["rclpy.event_handler"] = None  # type: ignore[assignment]
        return
    if lack == "serialized_bytes":
        deafen_raw_subscriptions()
        return
    for name in WITHOUT_POINTER[lack]:
        hide_pointer(getattr(rclpy_implementation, name))


def deafen_raw_subscriptions() -> None:
    create = rclpy.node.Node.create_subscription

    def create_elsewhere(
        node: Any, kind: Any, topic: str, *rest: Any, raw: bool = False, **options: Any
    ) -> Any:
        is_deaf = raw and "sequence<uint8>" in kind.get_fields_and_field_types().values()
        return create(node, kind, f"{topic}_unread" if is_deaf else topic, *rest, raw=raw, **options)

    rclpy.node.Node.create_subscription = create_elsewhere


def hide_pointer(entity: type) -> None:
    pointer = entity.pointer  # type: ignore[attr-defined]

    def for_rclpy(self: object) -> int:
        if sys._getframe(1).f_globals["__name__"].startswith("smarttestudo"):
            raise AttributeError(f"{entity.__name__!r} object has no attribute 'pointer'")
        address: int = pointer.__get__(self)
        return address

    entity.pointer = property(for_rclpy)  # type: ignore[attr-defined]


take_away(sys.argv[1])
sys.exit(main(sys.argv[2:]))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Foxglove's server on the robot, and a client of its protocol at the operator's end."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from thin_link.network_namespaces import ROBOT_ADDRESS
from thin_link.traffic import Note, Publishing, Topic

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

_PORT = 7450
_MESSAGE_DATA, _HEAD_BYTES = 1, 13
_TRY_AGAIN_S = 0.2


@contextmanager
def foxglove_robot(topics: Sequence[Topic]) -> Iterator[Publishing]:
    """A server with a channel for each topic."""
    import foxglove  # noqa: PLC0415  the others need none of it
    from foxglove.websocket import ChannelView, Client, ServerListener  # noqa: PLC0415  see above

    subscribed = set[str]()

    class Listener(ServerListener):
        def on_subscribe(self, client: Client, channel: ChannelView) -> None:  # noqa: ARG002  as it is called
            subscribed.add(channel.topic)

    text = foxglove.Schema(name="std_msgs/msg/String", encoding="ros2msg", data=b"string data")
    channels = [foxglove.Channel(one.name, message_encoding="cdr", schema=text) for one in topics]
    server = foxglove.start_server(host=ROBOT_ADDRESS, port=_PORT, server_listener=Listener())
    try:
        yield Publishing(
            publishers=[channel.log for channel in channels],
            is_connected=lambda: subscribed >= {one.name for one in topics},
        )
    finally:
        server.stop()


@contextmanager
def foxglove_operator(note: Note, topics: Sequence[Topic]) -> Iterator[None]:
    """A client that subscribes to all topics once there is a server."""
    reader = threading.Thread(target=_receive, args=(note, {one.name for one in topics}), daemon=True)
    reader.start()
    yield


def _receive(note: Note, topics: set[str]) -> None:
    connection = _connected()
    names = dict[int, str]()
    for data in connection:
        if isinstance(data, bytes):
            if data[0] == _MESSAGE_DATA:
                note(names[int.from_bytes(data[1:5], "little")], data[_HEAD_BYTES:])
        elif (said := json.loads(data))["op"] == "advertise":
            found = {one["id"]: one["topic"] for one in said["channels"] if one["topic"] in topics}
            names |= found
            wanted = [{"id": number, "channelId": number} for number in found]
            connection.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))


def _connected() -> ClientConnection:
    from websockets.sync.client import connect  # noqa: PLC0415  the others need none of it
    from websockets.typing import Subprotocol  # noqa: PLC0415  see above

    while True:
        with suppress(OSError):
            address = f"ws://{ROBOT_ADDRESS}:{_PORT}"
            return connect(address, subprotocols=[Subprotocol("foxglove.sdk.v1")], max_size=None)
        time.sleep(_TRY_AGAIN_S)

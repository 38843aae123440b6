# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bags back to plain values, with our reader and with two others."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from bags.bag_factory import BagMessage
from smarttestudo.bags.reader import open_recording


@dataclass(frozen=True)
class ReadBag:
    messages: list[BagMessage]
    notices: list[str]


def read_bag(path: Path) -> ReadBag:
    with open_recording(path) as recording:
        messages = [
            BagMessage(channel.topic, stamp, payload) for channel, stamp, payload in recording.messages()
        ]
        return ReadBag(messages, list(recording.notices()))


def read_with_rosbags(path: Path) -> list[BagMessage]:
    with AnyReader([path]) as reader:
        return [
            BagMessage(connection.topic, stamp, bytes(data)) for connection, stamp, data in reader.messages()
        ]


def read_with_mcap(path: Path) -> list[BagMessage]:
    with path.open("rb") as file:
        return [
            BagMessage(channel.topic, message.log_time, message.data)
            for _, channel, message in make_reader(file).iter_messages()
        ]

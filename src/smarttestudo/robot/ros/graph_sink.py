# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Publication of what arrives over a link into the local ROS graph."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import TOPIC_PLACEHOLDER, output_name
from smarttestudo.domain.robot import DataPath, Publisher

MAX_DEPTH = 1000
"""Messages that a publisher keeps at most, whatever depth a robot announces."""
_StreamKey = tuple[str, str, int]


@dataclass(slots=True, kw_only=True)
class _OpenStream:
    """``publisher`` is ``None`` where none can be had, which was said.

    Predicted messages have a publisher of their own, so that they can be told from what arrived.
    """

    stream: StreamInfo
    publisher: Publisher | None
    predicting: Publisher | None = None


class GraphSink:
    """A ``Sink`` with a publisher for each stream, of the type and QoS of the robot's.

    So a late subscriber gets what each of the robot's publishers latched. ``pattern`` names topics, with
    ``{topic}`` and, where there are several robots, ``{robot}``. What goes wrong costs its stream only and is
    said to ``warn`` once. Raises ``UsageError`` for a pattern that makes no names.
    """

    def __init__(
        self, path: DataPath, warn: Callable[[str], None], *, pattern: str = TOPIC_PLACEHOLDER
    ) -> None:
        output_name("/topic", pattern, "robot")
        self._path = path
        self._warn = warn
        self._pattern = pattern
        self._streams: dict[_StreamKey, _OpenStream] = {}
        self._robot_of: dict[str, str] = {}
        self._said: set[str] = set()

    def open(self, robot: str, stream: StreamInfo) -> None:
        """Publish the stream, anew where its type or QoS is another one than before."""
        key = (robot, stream.topic, stream.publisher)
        before = self._streams.get(key)
        if before is not None:
            if (before.stream.type_name, before.stream.qos) == (stream.type_name, stream.qos):
                return
            _close(before)
        self._streams[key] = _OpenStream(stream=stream, publisher=self._advertise(robot, stream))

    def write(self, message: ReceivedMessage) -> None:
        """Publish the message of a stream that is open."""
        stream = self._streams.get((message.robot, message.stream.topic, message.stream.publisher))
        if stream is None or stream.publisher is None:
            return
        publisher: Publisher | None = stream.publisher
        if message.is_predicted:
            if stream.predicting is None:
                stream.predicting = self._advertise(message.robot, stream.stream)
            publisher = stream.predicting
        if publisher is None:
            return
        try:
            publisher.publish(message.payload)
        except TestudoError as error:
            self._say(str(error))

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """Publish nothing more of the stream, latched messages included."""
        gone = self._streams.pop((robot, stream.topic, stream.publisher), None)
        if gone is not None:
            _close(gone)

    def close(self) -> None:
        """Publish nothing more, latched messages included."""
        for stream in self._streams.values():
            _close(stream)
        self._streams.clear()

    def _advertise(self, robot: str, stream: StreamInfo) -> Publisher | None:
        try:
            output = output_name(stream.topic, self._pattern, robot)
            qos = replace(stream.qos, depth=min(max(stream.qos.depth, 1), MAX_DEPTH))
            publisher = self._path.advertise(output, stream.type_name, qos)
        except TestudoError as error:
            self._say(str(error))
            return None
        other = self._robot_of.setdefault(output, robot)
        if other != robot:
            self._say(
                f"the topics of {other} and {robot} have the same names here; "
                "tell them apart with --output-topic '/{robot}{topic}'"
            )
        return publisher

    def _say(self, line: str) -> None:
        if line not in self._said:
            self._said.add(line)
            self._warn(line)


def _close(stream: _OpenStream) -> None:
    for publisher in (stream.publisher, stream.predicting):
        if publisher is not None:
            publisher.close()

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Publication of what arrives over a link into the local ROS graph."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace

from smarttestudo.domain.errors import TestudoError, error_at
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import TOPIC_PLACEHOLDER, output_name, require_publishable
from smarttestudo.domain.robot import DataPath, Publisher
from smarttestudo.domain.texts import SayOnce

MAX_DEPTH = 1000
"""Messages that a publisher keeps at most, whatever depth a robot announces."""
_StreamKey = tuple[str, str, int]


@dataclass(slots=True, kw_only=True)
class _OpenStream:
    """``publisher`` is ``None`` where none can be had, which was said, for ``problem``.

    Predicted messages have a publisher of their own, so that they can be told from what arrived.
    """

    stream: StreamInfo
    output: str = ""
    publisher: Publisher | None = None
    problem: str | None = None
    predicting: Publisher | None = None

    def publishes(self, stream: StreamInfo) -> bool:
        """Whether it does for ``stream``."""
        is_alike = (self.stream.type_name, self.stream.qos) == (stream.type_name, stream.qos)
        return is_alike and self.publisher is not None


class GraphSink:
    """A ``Sink`` with a publisher for each stream, of the type and QoS of the robot's.

    So a late subscriber gets what each of the robot's publishers latched. ``pattern`` names topics, with
    ``{topic}`` and, where there are several robots, ``{robot}``. What goes wrong costs its stream only, is
    said to ``warn`` once, and is tried again when the stream is said again, or another one of its name is
    gone. Raises ``UsageError`` for a pattern that makes no names.
    """

    def __init__(
        self, path: DataPath, warn: Callable[[str], None], *, pattern: str = TOPIC_PLACEHOLDER
    ) -> None:
        output_name("/topic", pattern, "robot")
        self._path = path
        self._say = SayOnce(warn)
        self._pattern = pattern
        self._streams: dict[_StreamKey, _OpenStream] = {}
        self._robot_of: dict[str, str] = {}

    def open(self, robot: str, stream: StreamInfo) -> str | None:
        """Publish the stream, anew where its type or QoS is another one than before."""
        key = (robot, stream.topic, stream.publisher)
        before = self._streams.get(key)
        if before is not None and before.publishes(stream):
            return None
        self._end(key)
        opened = self._streams[key] = _OpenStream(stream=stream)
        self._open(robot, opened)
        return opened.problem

    def write(self, message: ReceivedMessage) -> str | None:
        """Publish the message of a stream that is open. Raises ``RosError``."""
        stream = self._streams.get((message.robot, message.stream.topic, message.stream.publisher))
        if stream is None or stream.publisher is None:
            return None if stream is None else stream.problem
        publisher = stream.publisher
        if message.is_predicted:
            if stream.predicting is None:
                stream.predicting = self._advertise(stream)
            publisher = stream.predicting
        publisher.publish(message.payload)
        return None

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """Publish nothing more of the stream, latched messages included."""
        self._end((robot, stream.topic, stream.publisher))

    def close(self) -> None:
        """Publish nothing more, latched messages included."""
        for stream in self._streams.values():
            self._close(stream)
        self._streams.clear()

    def _open(self, robot: str, stream: _OpenStream) -> None:
        try:
            stream.output = output_name(stream.stream.topic, self._pattern, robot)
            require_publishable(stream.output, stream.stream.topic)
            stream.publisher = self._advertise(stream)
        except Exception as error:  # noqa: BLE001 - whatever the middleware refuses costs this stream
            refused = error_at(stream.stream.topic, error)
            stream.problem = refused.cause
            self._say(str(refused))
            return
        stream.problem = None
        other = self._robot_of.setdefault(stream.output, robot)
        if other != robot:
            self._say(
                f"the topics of {other} and {robot} have the same names here; "
                "tell them apart with --output-topic '/{robot}{topic}'"
            )

    def _advertise(self, stream: _OpenStream) -> Publisher:
        info = stream.stream
        qos = replace(info.qos, depth=min(max(info.qos.depth, 1), MAX_DEPTH))
        return self._path.advertise(stream.output, info.type_name, qos)

    def _end(self, key: _StreamKey) -> None:
        """Publish nothing more of a stream; another one may then have its name here."""
        gone = self._streams.pop(key, None)
        if gone is None:
            return
        self._close(gone)
        for (robot, _, _), stream in self._streams.items():
            if stream.publisher is None and stream.output == gone.output:
                self._open(robot, stream)

    def _close(self, stream: _OpenStream) -> None:
        try:
            with ExitStack() as closing:
                for publisher in filter(None, (stream.publisher, stream.predicting)):
                    closing.callback(publisher.close)
        except TestudoError as error:
            self._say(str(error))

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that arrive over a link, served to the Foxglove app."""

from __future__ import annotations

import logging
import re
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from foxglove import Channel, Context, Schema, start_server
from foxglove.websocket import ChannelView, Client, ServerListener

from smarttestudo.bags.definition_text import is_idl_definition
from smarttestudo.bags.definitions import TypeLibrary
from smarttestudo.domain import recording
from smarttestudo.domain.errors import PortError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.texts import SayOnce

MOST_LATCHED = 100
"""Messages that are kept of one publisher, whatever depth it announces."""
BACKLOG = 128
"""Messages that wait for one client; the oldest gives way. The SDK lets a client go that does not even take
so many announcements of topics."""
MOST_UNKNOWN = 1000
"""Refused subscriptions that wait to be answered; the oldest give way, since a client can send any number."""
_SDK_PREFIX = "FoxgloveError: "
_SERVER_LOG = "foxglove.websocket.server"
_HANDSHAKE_FAILED = re.compile(r"handshake failed\Z")
_CLIENT_LOG = "foxglove.websocket.connected_client"
_UNKNOWN_CHANNEL = re.compile(r"attempted to subscribe to unknown channel: (\d+)\Z")
_REFUSED = (
    "Foxglove: a client was refused, as it does not offer the protocol foxglove.sdk.v1; "
    "use the current Foxglove app, or Lichtblick 1.22 or newer"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Topic:
    """A topic of a robot; ``latched`` are payload and stamp of what late clients get, by publisher."""

    robot: str
    stream: StreamInfo
    channel: Channel
    latched: dict[int, deque[tuple[bytes, int]]] = field(default_factory=dict)

    def is_served_as(self, stream: StreamInfo) -> bool:
        """Whether clients can read the messages of ``stream``, whose definition need not be told again."""
        is_defined = stream.definition in ("", self.stream.definition)
        return self.stream.type_name == stream.type_name and is_defined


class FoxgloveSink:
    """A ``Sink`` with a channel for each topic, ``/<robot>/<topic>`` where several robots are heard.

    Messages are stamped with ``now_ns`` as they arrive. Who subscribes late gets the last messages of latched
    topics, and so does, once more, who was there before: the SDK sends to all. A topic whose type nobody
    defines is not served, which ``warn`` is told once, and so it is of clients that are refused. The SDK
    announces a channel before it takes subscriptions to it: who subscribes in between is refused, so the
    topic is announced anew with the next message. Raises ``PortError`` where it cannot listen.
    """

    def __init__(
        self, port: int, warn: Callable[[str], None], now_ns: Callable[[], int], *, host: str = "127.0.0.1"
    ) -> None:
        self._say = SayOnce(warn)
        self._now_ns = now_ns
        self._types = TypeLibrary()
        self._topics: dict[tuple[str, str], _Topic] = {}
        self._robots: set[str] = set()
        self._unknown_channels: deque[int] = deque(maxlen=MOST_UNKNOWN)
        # Clients subscribe in the SDK's thread. It is never held where the SDK might wait for that thread.
        self._lock = threading.Lock()
        self._context = Context()
        self._logs = {
            # The SDK does not say why it refuses a client.
            logging.getLogger(_SERVER_LOG): _Replaced(_HANDSHAKE_FAILED, lambda _: self._say(_REFUSED)),
            logging.getLogger(_CLIENT_LOG): _Replaced(
                _UNKNOWN_CHANNEL, lambda found: self._unknown_channels.append(int(found[1]))
            ),
        }
        try:
            self._server = start_server(
                name="SmartTestudo",
                host=host,
                port=port,
                context=self._context,
                server_listener=_Listener(self._resend),
                message_backlog_size=BACKLOG,
            )
        except (RuntimeError, OverflowError) as error:
            cause = f"the Foxglove server cannot listen there: {str(error).removeprefix(_SDK_PREFIX)}"
            remedy = "give another port, or end what listens there"
            raise PortError(cause, place=f"{host}:{port}", remedy=remedy) from error
        for log, replaced in self._logs.items():
            log.addFilter(replaced)

    @property
    def port(self) -> int:
        return self._server.port

    def open(self, robot: str, stream: StreamInfo) -> None:
        """Announce the stream's topic, anew where it has another type than before."""
        if robot not in self._robots:
            self._robots.add(robot)
            if len(self._robots) == 2:
                self._rename_all()
        before = self._topics.get((robot, stream.topic))
        if before is not None:
            if before.is_served_as(stream):
                return
            self._close(before)
        schema = self._schema(robot, stream)
        if schema is not None:
            topic = _Topic(robot=robot, stream=stream, channel=self._channel(robot, stream.topic, schema))
            with self._lock:
                self._topics[robot, stream.topic] = topic

    def write(self, message: ReceivedMessage) -> None:
        """Send the message of a topic that is served to whom it may concern."""
        if self._unknown_channels:
            self._reopen_unknown()
        stream = message.stream
        topic = self._topics.get((message.robot, stream.topic))
        if topic is None or topic.stream.type_name != stream.type_name:
            return
        now_ns = self._now_ns()
        with self._lock:
            if stream.qos.transient_local:
                depth = min(max(stream.qos.depth, 1), MOST_LATCHED)
                kept = topic.latched.setdefault(stream.publisher, deque(maxlen=depth))
                kept.append((message.payload, now_ns))
            topic.channel.log(message.payload, log_time=now_ns)

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """Give late clients nothing more of the stream; its topic stays."""
        topic = self._topics.get((robot, stream.topic))
        if topic is not None:
            with self._lock:
                topic.latched.pop(stream.publisher, None)

    def close(self) -> None:
        self._server.stop()
        for log, replaced in self._logs.items():
            log.removeFilter(replaced)
        for topic in list(self._topics.values()):
            self._close(topic)

    def _schema(self, robot: str, stream: StreamInfo) -> Schema | None:
        described = recording.Channel(
            topic=stream.topic, type_name=stream.type_name, definition=stream.definition or None
        )
        definition, _ = self._types.definition_and_digest(described)
        if not definition:
            self._say(
                f"{stream.topic}: not served to Foxglove, because nobody defines {stream.type_name}; "
                f"install the package of that type on {robot}"
            )
            return None
        encoding = "ros2idl" if is_idl_definition(definition) else "ros2msg"
        return Schema(name=stream.type_name, encoding=encoding, data=definition.encode())

    def _channel(self, robot: str, topic: str, schema: Schema) -> Channel:
        name = f"/{robot}{topic}" if len(self._robots) > 1 else topic
        return Channel(name, message_encoding="cdr", schema=schema, context=self._context)

    def _close(self, topic: _Topic) -> None:
        with self._lock:
            del self._topics[topic.robot, topic.stream.topic]
        topic.channel.close()

    def _rename_all(self) -> None:
        for topic in list(self._topics.values()):
            self._reopen(topic)

    def _reopen_unknown(self) -> None:
        refused = {self._unknown_channels.popleft() for _ in range(len(self._unknown_channels))}
        for topic in list(self._topics.values()):
            if topic.channel.id() in refused:
                self._reopen(topic)

    def _reopen(self, topic: _Topic) -> None:
        self._close(topic)
        schema = topic.channel.schema()
        assert schema is not None
        channel = self._channel(topic.robot, topic.stream.topic, schema)
        reopened = _Topic(robot=topic.robot, stream=topic.stream, channel=channel, latched=topic.latched)
        with self._lock:
            self._topics[topic.robot, topic.stream.topic] = reopened
            _send_latched(reopened)

    def _resend(self, channel_number: int) -> None:
        with self._lock:
            for topic in self._topics.values():
                if topic.channel.id() == channel_number:
                    _send_latched(topic)


def _send_latched(topic: _Topic) -> None:
    kept = (message for messages in topic.latched.values() for message in messages)
    for payload, stamp_ns in sorted(kept, key=lambda message: message[1]):
        topic.channel.log(payload, log_time=stamp_ns)


class _Replaced(logging.Filter):
    """Gives a line of the SDK's log to ``on_line``, in place of logging it."""

    def __init__(self, line: re.Pattern[str], on_line: Callable[[re.Match[str]], None]) -> None:
        super().__init__()
        self._line = line
        self._on_line = on_line

    def filter(self, record: logging.LogRecord) -> bool:
        found = self._line.search(record.getMessage())
        if found is not None:
            self._on_line(found)
        return found is None


class _Listener(ServerListener):
    """Tells of each client that subscribes."""

    def __init__(self, subscribed: Callable[[int], None]) -> None:
        self._subscribed = subscribed

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:  # noqa: ARG002 - the SDK's words
        """Called by the SDK, in a thread of its own."""
        self._subscribed(channel.id)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reception of ``testudo echo``: rates, bandwidth and the last values of topics."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Mapping, Sequence, Sized
from dataclasses import dataclass, replace
from difflib import get_close_matches
from itertools import islice

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.rate_meter import Flow, FlowMeter
from smarttestudo.domain.robot import Payload, Qos, Robot, Subscription, is_visible
from smarttestudo.domain.texts import first_names
from smarttestudo.domain.units import NS_PER_S, grouped
from smarttestudo.language.properties import part_reader, properties_of, value_reader
from smarttestudo.robot.source import LiveSource, live_source, suits

PlainValue = bool | int | float | str | list["PlainValue"] | dict[str, "PlainValue"] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """How many items of an array and characters of a text are shown; ``None``: all of them."""

    items: int | None = 8
    characters: int | None = 200


def message_values(
    message: object, type_name: str, fields: Sequence[str], bounds: Bounds
) -> Mapping[str, PlainValue]:
    """The ``fields`` of the message, by property or path, ``None`` where it has none; all without ``fields``.

    What is beyond the ``bounds`` is left out, and a text at the end says how much that is.
    """
    if not fields:
        whole = _plain(message, bounds)
        return whole if isinstance(whole, dict) else {"": whole}
    return {name: _plain(_reader(type_name, name)(message), bounds) for name in fields}


def in_words(message: object) -> str:
    """The names of the outermost fields."""
    fields = getattr(message, "get_fields_and_field_types", dict)
    return ", ".join(fields()) or "no fields"


def _reader(type_name: str, name: str) -> Callable[[object], object]:
    return value_reader(type_name, name) if name in properties_of(type_name) else part_reader(name)


def _plain(value: object, bounds: Bounds) -> PlainValue:
    if isinstance(value, bool | int | float | None):
        return value
    if isinstance(value, str):
        return _shortened(value, bounds.characters)
    if isinstance(value, bytes) and len(value) == 1:
        return value[0]
    fields = getattr(value, "get_fields_and_field_types", None)
    if fields is not None:
        return {name: _plain(getattr(value, name), bounds) for name in fields()}
    if isinstance(value, Sized) and hasattr(value, "__getitem__"):
        return _items(value, bounds)
    # A number of a numpy array is not a Python number; ``item`` converts it.
    item = getattr(value, "item", None)
    return str(value) if item is None else _plain(item(), bounds)


def _items(value: Sized, bounds: Bounds) -> list[PlainValue]:
    """Only what is shown is looked at: an image has millions of them."""
    shown = [_plain(value[index], bounds) for index in islice(range(len(value)), bounds.items)]  # type: ignore[index]
    hidden = len(value) - len(shown)
    return [*shown, f"… {grouped(hidden)} more"] if hidden else shown


def _shortened(text: str, characters: int | None) -> str:
    if characters is None or len(text) <= characters:
        return text
    return f"{text[:characters]}… {grouped(len(text) - characters)} more characters"


# What queued up while the subscription was made comes at once, and would count as a higher rate.
_WARM_UP_NS = NS_PER_S // 2
# On a slow machine the queue comes later than that: all that is measured so far came within this.
_AT_ONCE_NS = NS_PER_S // 20
# Latched messages of before come one after the other, for so long, until such a pause.
_HISTORY_NS = NS_PER_S
_HISTORY_PAUSE_NS = 3 * NS_PER_S // 10
# Messages wait here while others are counted and shown.
_DEPTH = 100
_MOST_SUGGESTIONS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Echo:
    """State of a topic's reception, with the values of one of its messages and that message's type.

    ``state`` is why nothing is received, or why a message cannot be read; rate and bandwidth are those of the
    last ten seconds.
    """

    topic: str
    type_name: str | None
    messages: int
    rate_hz: float | None
    kb_per_s: float
    size_bytes: int | None
    values: Mapping[str, PlainValue] | None
    state: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Received:
    number: int
    type_name: str
    payload: Payload


class EchoedTopic:
    """Receives one topic from when it is first published, with the QoS of its publishers.

    All messages are counted and metered as bytes; only those that are shown are decoded. The first ``keep``
    wait for ``take_kept``; of latched ones from before, the newest.
    """

    def __init__(self, robot: Robot, topic: str, *, fields: Sequence[str], bounds: Bounds, keep: int) -> None:
        self.topic = topic
        self.error: RosError | None = None
        self._robot = robot
        self._fields = fields
        self._bounds = bounds
        self._keep = keep
        self._kept: deque[_Received] = deque()
        self._left = keep
        self._source: LiveSource | None = None
        self._subscription: Subscription | None = None
        self._last: _Received | None = None
        self._flow = Flow()
        self._meter = FlowMeter(self._flow)
        self._is_metered = False

    @property
    def messages(self) -> int:
        """How many came."""
        return self._flow.messages

    @property
    def state(self) -> str:
        """Why nothing is received; empty if something is."""
        if self.error is not None:
            return self.error.cause
        if self._source is None:
            return "waiting for a publisher"
        if not self._source.publishers:
            return "no publisher left"
        return "" if self.messages else "waiting for a message"

    def poll(self) -> None:
        """Follow what the publishers of the topic are now."""
        had, self._source = self._source, live_source(self._robot.publishers(self.topic), self._source)
        if self._source is None or (had is not None and suits(had, self._source)):
            return
        if self._subscription is not None:
            self._subscription.close()
        self._subscription, self.error = None, None
        try:
            self._subscription = self._subscribe(self._source.type_name, self._source.subscription_qos)
        except RosError as error:
            self.error = error

    def echo(self) -> Echo:
        """State of the reception now, with the last message."""
        if self._is_metered:
            self._measure(self._robot.steady_ns())
        return self._echo(self._last)

    def take_kept(self) -> list[Echo]:
        """The messages that were kept since the last call."""
        if self._is_history(self._robot.steady_ns()):
            return []
        kept, self._kept = self._kept, deque()
        self._left -= len(kept)
        return [self._echo(received) for received in kept]

    def _is_history(self, now_ns: int) -> bool:
        """Whether what comes may be of before, with newer ones behind it."""
        is_begun = self._left < self._keep
        if is_begun or self._source is None or not self._source.qos.transient_local:
            return False
        return self._flow.span_ns < _HISTORY_NS and now_ns - self._flow.last_ns < _HISTORY_PAUSE_NS

    def _measure(self, now_ns: int) -> None:
        transient_local = self._source is not None and self._source.qos.transient_local
        self._meter.measure(now_ns, transient_local=transient_local)
        if 0 < self._meter.span_ns < _AT_ONCE_NS:
            self._meter = FlowMeter(self._flow)
            self._meter.measure(now_ns, transient_local=transient_local)

    def _subscribe(self, type_name: str, qos: Qos) -> Subscription:
        def receive(payload: Payload, _publisher: Hashable) -> None:
            now_ns = self._robot.steady_ns()
            is_history = self._is_history(now_ns)
            self._flow.record(now_ns, len(payload))
            self._last = _Received(number=self.messages, type_name=type_name, payload=payload)
            if not self._is_metered and self._flow.span_ns >= _WARM_UP_NS:
                self._is_metered = True
                self._meter.measure(now_ns)
            if len(self._kept) < self._left:
                self._kept.append(self._last)
            elif self._left and is_history:
                self._kept.popleft()
                self._kept.append(self._last)

        deep = replace(qos, depth=max(_DEPTH, qos.depth))
        return self._robot.data_path.subscribe(self.topic, type_name, deep, receive)

    def _echo(self, received: _Received | None) -> Echo:
        values, state = None, self.state
        if received is not None:
            try:
                message = self._robot.data_path.decode(self.topic, received.type_name, received.payload)
                values = message_values(message, received.type_name, self._fields, self._bounds)
                if self._fields and all(value is None for value in values.values()):
                    state = (
                        f"nothing at {', '.join(self._fields)}: {received.type_name} has {in_words(message)}"
                    )
            except RosError as error:
                state = error.cause
        return Echo(
            topic=self.topic,
            type_name=None if received is None else received.type_name,
            messages=self.messages if received is None else received.number,
            rate_hz=self._meter.rate_hz,
            kb_per_s=self._meter.kb_per_s,
            size_bytes=None if received is None else len(received.payload),
            values=values,
            state=state,
        )


def no_message_error(robot: Robot, topic: EchoedTopic, timeout_s: float) -> RosError:
    """The error after ``timeout_s`` without a message."""
    if topic.error is not None:
        return topic.error
    if robot.publisher_count(topic.topic):
        return RosError(f"no message came within {timeout_s:g} s", place=topic.topic, remedy="wait longer")
    names = sorted(name for name in robot.topics() if is_visible(name) and robot.publisher_count(name))
    return RosError(
        f"nobody published it within {timeout_s:g} s", place=topic.topic, remedy=_remedy(topic.topic, names)
    )


def _remedy(topic: str, names: Sequence[str]) -> str:
    if not names:
        return "no other topic is published either: start the robot's nodes, with the same ROS_DOMAIN_ID"
    last_part = topic.rpartition("/")[2]
    near = [
        *get_close_matches(topic, names, n=_MOST_SUGGESTIONS),
        *(name for name in names if name.rpartition("/")[2] == last_part),
    ]
    if near:
        return f"did you mean {' or '.join(list(dict.fromkeys(near))[:_MOST_SUGGESTIONS])}?"
    return f"there are {first_names(names, _MOST_SUGGESTIONS)}"

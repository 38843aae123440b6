# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The types of recorded messages, and the values in a recording of what rules read."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.checks.context import ObservedValues
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel, RecordingReader, first_of_topics
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.units import counted
from smarttestudo.language.parser.cursor import closest
from smarttestudo.language.properties import ARRIVAL_PROPERTIES, properties_of
from smarttestudo.language.properties.field_path import MESSAGE_PREFIX, is_field_path, part_reader
from smarttestudo.language.properties.signal_readers import SignalReader, signal_reader

if TYPE_CHECKING:
    from smarttestudo.bags.definitions import TypeLibrary

_COUNTED = "its messages are counted, but cannot be decoded"
_HEADER = "std_msgs/msg/Header"


class MessageTypes:
    """Types by the recording's own definitions, or else by those of ROS 2."""

    def notices(self, channels: Iterable[Channel], so: str = _COUNTED) -> Iterator[str]:
        """A notice of each channel whose messages cannot be decoded, and what follows from that."""
        for channel in channels:
            why = self._types.why_undecodable(channel)
            if why is not None:
                yield f"{channel.topic}: {why}; {so}"

    def has_header(self, channel: Channel) -> bool:
        """Whether messages begin with a std_msgs/Header; false if no definition says so."""
        types = self._types.types_for(channel)
        if types is None:
            return False
        from smarttestudo.bags.definitions import is_standard  # noqa: PLC0415  as below

        fields = types[channel.type_name][1]
        return bool(fields) and fields[0][1][1] == _HEADER and is_standard(types, _HEADER)

    @cached_property
    def _types(self) -> TypeLibrary:
        from smarttestudo.bags.definitions import TypeLibrary  # noqa: PLC0415  most recordings need none

        return TypeLibrary()


_MOST_TEXTS = 50


class _Observed:
    """Values of one signal so far, and the last message without one."""

    def __init__(self, read: SignalReader) -> None:
        self.read = read
        self.texts: dict[str, None] = {}
        self.messages = self.undecodable = 0
        self.greatest = -math.inf
        self.without: object | None = None

    def on_message(self, message: object | None) -> None:
        self.messages += 1
        if message is None:
            self.undecodable += 1
            return
        values = self.read(message)
        for value in values if isinstance(values, tuple) else (values,):
            if isinstance(value, str):
                if len(self.texts) < _MOST_TEXTS:
                    self.texts[value] = None
            elif value is None or math.isnan(value):
                self.without = message
            else:
                self.greatest = max(self.greatest, value)


def observed_values(
    recording: RecordingReader, signals: Collection[Signal], profile: Profile | None = None
) -> dict[Signal, ObservedValues]:
    """Values of each of ``signals`` whose topic the recording has; of two types the first counts."""
    channels = first_of_topics(recording.channels)
    decoder, found = RosbagDecoder(), dict[str, dict[Signal, _Observed]]()
    for signal in signals:
        if signal.topic in channels and signal.property not in ARRIVAL_PROPERTIES:
            unit = profile.topic(signal.topic).level_unit if profile else None
            read = signal_reader(channels[signal.topic].type_name, signal, unit)
            found.setdefault(signal.topic, {})[signal] = _Observed(read)
    for channel, _, payload in recording.messages(found) if found else ():
        if channels[channel.topic].type_name != channel.type_name:
            continue
        try:
            message: object | None = decoder.decode(channel, payload)
        except RecordingError:
            message = None
        for observed in found[channel.topic].values():
            observed.on_message(message)
    return {
        signal: _observed_values(
            signal, observed_signal, channels[signal.topic].type_name, decoder.reason(signal.topic)
        )
        for of_topic in found.values()
        for signal, observed_signal in of_topic.items()
    }


def _observed_values(signal: Signal, observed: _Observed, type_name: str, reason: str) -> ObservedValues:
    if observed.texts:
        return ObservedValues(texts=tuple(observed.texts))
    if observed.greatest > -math.inf:
        return ObservedValues(greatest=observed.greatest)
    if not observed.messages:
        return ObservedValues(why="it holds no message of it")
    messages = counted(observed.messages, "message")
    if observed.without is None:
        return ObservedValues(why=f"none of its {messages} can be decoded{reason}")
    why, close = _lacks(observed.without, signal.property, type_name)
    return ObservedValues(why=why or f"it is unknown in all of its {messages}", close=close)


def _lacks(message: object, name: str, type_name: str) -> tuple[str, str | None]:
    """Why ``message`` has no number at a path, and the path that may be meant; empty if it may have one."""
    if name in properties_of(type_name) or not is_field_path(name):
        return "", None
    prefix = MESSAGE_PREFIX if name.startswith(MESSAGE_PREFIX) else ""
    steps = name.removeprefix(MESSAGE_PREFIX).split(".")
    for number, step in enumerate(steps):
        here: Any = part_reader(".".join(steps[:number]))(message) if number else message
        field, bracket, index = step.partition("[")
        names = _fields(here)
        if names and field not in names:
            close = closest(field, names)
            path = ".".join([*steps[:number], f"{close}{bracket}{index}", *steps[number + 1 :]])
            return f"its messages have no {'.'.join([*steps[:number], field])}", close and f"{prefix}{path}"
    value = part_reader(name)(message)
    if isinstance(value, str):
        return "it is a text, and no number", None
    if _fields(value):
        return f"it has parts, such as {name}.{_fields(value)[0]}", None
    if hasattr(value, "__len__"):
        return f"it is a list, of which {name}[0] is the first element", None
    return "", None


def _fields(value: object) -> list[str]:
    if not dataclasses.is_dataclass(value):
        return []
    return [field.name for field in dataclasses.fields(value) if not field.name.startswith("_")]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Serialized messages to objects, by the bag's own type definitions or those of ROS 2."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosbags.serde import SerdeError

from smarttestudo.adapters.rosbag.definitions import TypeLibrary
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_DECODED_FORMAT = "cdr"
# What rosbags' generated code raises on bytes that are no message of the type.
_BROKEN_MESSAGE = (SerdeError, LookupError, ArithmeticError, ValueError, TypeError, MemoryError)


class RosbagDecoder:
    """Decodes CDR, little or big endian. Types are compiled on first use."""

    def __init__(self) -> None:
        self._types = TypeLibrary()
        self._stores: dict[tuple[str, str], Typestore | None] = {}

    def can_decode(self, channel: Channel) -> bool:
        """Whether the channel's messages are CDR of a type that the bag defines or ROS 2 knows."""
        return channel.serialization_format == _DECODED_FORMAT and self._store(channel) is not None

    def decode(self, channel: Channel, payload: bytes) -> object:
        """The message in ``payload``.

        Raises ``RecordingError`` for an unknown type, or bytes that are not a message of it.
        """
        store = self._store(channel)
        if store is None:
            raise RecordingError(f"the type {channel.type_name} is unknown", place=channel.topic)
        try:
            return store.deserialize_cdr(payload, channel.type_name)
        except _BROKEN_MESSAGE as error:
            raise RecordingError(f"not a {channel.type_name}: {error}", place=channel.topic) from error

    def _store(self, channel: Channel) -> Typestore | None:
        key = (channel.topic, channel.type_name)
        if key not in self._stores:
            self._stores[key] = self._types.store_for(channel)
        return self._stores[key]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Type definitions, and serialized messages decoded by them."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore

from smarttestudo.bags.definition_text import SEPARATOR, is_idl_definition
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict
    from rosbags.typesys.store import Typestore

_STORES_KEPT = 256
# A bag without definitions was recorded by Humble or an older release, so Humble's come first.
_STORES = (
    Stores.ROS2_HUMBLE,
    Stores.ROS2_KILTED,
    Stores.ROS2_GALACTIC,
    Stores.ROS2_FOXY,
    Stores.ROS2_ELOQUENT,
    Stores.ROS2_DASHING,
)
# Registering a definition runs rosbags' parser and code generator, which fail in these ways on a broken one.
_BROKEN_DEFINITION = (TypesysError, ValueError, KeyError, SyntaxError, AssertionError, RecursionError)


class TypeLibrary:
    """The types of ROS 2's standard packages, release by release, each loaded when first asked for."""

    def __init__(self) -> None:
        self._stores: dict[Stores, Typestore] = {}

    def store_for(self, channel: Channel) -> Typestore | None:
        """A store that holds the channel's type, from its own definition if it has one."""
        if channel.definition is not None:
            return _store_of(channel.definition, channel.type_name)
        for release in _STORES:
            store = self._release(release)
            if channel.type_name in store.fielddefs:
                return store
        return None

    def definition_and_digest(self, channel: Channel) -> tuple[str, str]:
        """Definition and digest of the channel's type in a bag; empty strings where nobody knows."""
        if channel.definition is not None and channel.digest:
            return channel.definition, channel.digest
        store = self.store_for(channel)
        if store is None:
            return channel.definition or "", channel.digest
        definition = channel.definition
        if definition is None:
            definition, _ = store.generate_msgdef(channel.type_name, ros_version=2)
        return definition, channel.digest or _digest(store, channel.type_name)

    def _release(self, release: Stores) -> Typestore:
        if release not in self._stores:
            self._stores[release] = get_typestore(release)
        return self._stores[release]


# Every reader of a recording asks for the same few, and compiling one takes milliseconds.
@lru_cache(maxsize=_STORES_KEPT)
def _store_of(definition: str, type_name: str) -> Typestore | None:
    store = get_typestore(Stores.EMPTY)
    try:
        store.register(_parse(definition, type_name))
        store.get_msgdef(type_name)
    except _BROKEN_DEFINITION:
        return None
    return store


def _parse(definition: str, type_name: str) -> Typesdict:
    if not is_idl_definition(definition):
        return get_types_from_msg(definition, type_name)
    types: Typesdict = {}
    for part in definition.split(SEPARATOR)[1:]:
        types.update(get_types_from_idl(part.partition("\n")[2]))
    return types


def _digest(store: Typestore, type_name: str) -> str:
    try:
        return store.hash_rihs01(type_name)
    except _BROKEN_DEFINITION:
        return ""


def digest_of(definition: str | None, type_name: str) -> str:
    """The digest of the fields of a type; an empty string where the definition is none."""
    store = _store_of(definition or "", type_name)
    return "" if store is None else _digest(store, type_name)


_DECODED_FORMAT = "cdr"
# What rosbags' generated code raises on bytes that are no message of the type.
_BROKEN_MESSAGE = (SerdeError, LookupError, ArithmeticError, ValueError, TypeError, MemoryError)


class RosbagDecoder:
    """Decodes CDR, little or big endian. Types are compiled on first use."""

    def __init__(self) -> None:
        self._types = TypeLibrary()
        self._stores: dict[tuple[str, str | None], Typestore | None] = {}

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
        key = (channel.type_name, channel.definition)
        if key not in self._stores:
            self._stores[key] = self._types.store_for(channel)
        return self._stores[key]

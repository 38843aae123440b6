# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Type definitions: as bags hold them, and those that every ROS 2 knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore

from smarttestudo.domain.recording import Channel

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict
    from rosbags.typesys.store import Typestore

_SEPARATOR = "=" * 80 + "\n"
_IDL_HEADER = f"{_SEPARATOR}IDL: "
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


def normal_definition(text: str, *, type_name: str, is_idl: bool) -> str | None:
    """``text`` as rosbag2 writes it, where IDL starts with a header line; ``None`` for an empty one."""
    if not text:
        return None
    if is_idl and not text.startswith(_IDL_HEADER):
        return f"{_IDL_HEADER}{type_name}\n{text}"
    return text


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
        """What a bag says about the channel's type; empty strings for what nobody knows."""
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


def _store_of(definition: str, type_name: str) -> Typestore | None:
    store = get_typestore(Stores.EMPTY)
    try:
        store.register(_parse(definition, type_name))
        store.get_msgdef(type_name)
    except _BROKEN_DEFINITION:
        return None
    return store


def _parse(definition: str, type_name: str) -> Typesdict:
    if not definition.startswith(_IDL_HEADER):
        return get_types_from_msg(definition, type_name)
    types: Typesdict = {}
    for part in definition.split(_SEPARATOR)[1:]:
        types.update(get_types_from_idl(part.partition("\n")[2]))
    return types


def _digest(store: Typestore, type_name: str) -> str:
    try:
        return store.hash_rihs01(type_name)
    except _BROKEN_DEFINITION:
        return ""

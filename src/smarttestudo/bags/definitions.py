# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Type definitions, and serialized messages decoded by them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore

from smarttestudo.bags.definition_text import SEPARATOR, is_idl_definition
from smarttestudo.bags.generated_types import generated_texts, texts_within
from smarttestudo.bags.readable_types import BROKEN_MESSAGE, ReadableType, types_within, with_inner
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.type_names import TypeName

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc, Typesdict
    from rosbags.typesys.store import Typestore

_STORES_KEPT = 256
_INCLUDE = re.compile(r"^[ \t]*#.*", re.MULTILINE)
_WIDE_CONSTANT = re.compile(r"^[ \t]*wstring(?:<=\d+)?(?=[ \t]+\w+[ \t]*=)", re.MULTILINE)
_WIDE_FIELD = re.compile(r"^[ \t]*wstring(?:<=\d+)?(?=[ \t\[])", re.MULTILINE)
_WIDE, _WIDE_NAME = "testudo/WideText", "testudo/msg/WideText"
_WIDE_TEXT: FieldDesc = (Nodetype.BASE, ("wstring", 0))
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

    def readable(self, channel: Channel) -> ReadableType | None:
        """The channel's type, to read its messages; ``None`` where nobody defines it."""
        if channel.definition is not None:
            return _readable_of(channel.definition, channel.type_name)
        store = self.store_for(channel)
        return None if store is None else ReadableType(store.fielddefs, channel.type_name, is_idl=False)

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


# Every reader of a recording asks for the same few.
@lru_cache(maxsize=_STORES_KEPT)
def _store_of(definition: str, type_name: str) -> Typestore | None:
    store = get_typestore(Stores.EMPTY)
    try:
        store.register(types_within(_parse(definition, type_name), type_name))
    except _BROKEN_DEFINITION:
        return None
    return store


@lru_cache(maxsize=_STORES_KEPT)
def _readable_of(definition: str, type_name: str) -> ReadableType | None:
    store = _store_of(definition, type_name)
    if store is None:
        return None
    try:
        return ReadableType(store.fielddefs, type_name, is_idl=is_idl_definition(definition))
    except _BROKEN_DEFINITION:
        return None


def _parse(definition: str, type_name: str) -> Typesdict:
    name, definition = TypeName.read(type_name), definition.replace("\r\n", "\n")
    generated = None if name is None or name.kind == "msg" else name
    if is_idl_definition(definition):
        types: Typesdict = {}
        for part in definition.split(SEPARATOR)[1:]:
            types.update(get_types_from_idl(_INCLUDE.sub("", part.partition("\n")[2])))
    elif generated is not None:
        types = _types_of(texts_within(definition, generated), generated)
    else:
        types = _types_from_msg(definition, type_name)
    return types if generated is None else {**_types_of(generated_texts(generated), generated), **types}


def _types_of(texts: Mapping[str, str], name: TypeName) -> Typesdict:
    """Types by their names of two parts, as those within the service or action of ``name``."""
    types: Typesdict = {}
    for one, text in texts.items():
        types.update(_types_from_msg(text, one))

    def renamed(type_name: str) -> str:
        # rosbags makes each a name of msg.
        package, *_, last = type_name.split("/")
        generated = f"{package}/{name.kind}/{last}"
        return type_name if TypeName.read(generated) is None else generated

    return _with_names(types, lambda one: (Nodetype.NAME, renamed(one)), renamed)


def _types_from_msg(text: str, name: str) -> Typesdict:
    """As rosbags, which knows no wstring."""
    types = get_types_from_msg(_WIDE_FIELD.sub(_WIDE, _WIDE_CONSTANT.sub("string", text)), name)
    return _with_names(types, lambda one: _WIDE_TEXT if one == _WIDE_NAME else (Nodetype.NAME, one))


def _with_names(
    types: Typesdict, field_type: Callable[[str], FieldDesc], type_name: Callable[[str], str] = str
) -> Typesdict:
    def replace(inner: FieldDesc) -> FieldDesc:
        return field_type(inner[1]) if inner[0] == Nodetype.NAME else inner

    return {
        type_name(name): (constants, [(field, with_inner(desc, replace)) for field, desc in fields])
        for name, (constants, fields) in types.items()
    }


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


class RosbagDecoder:
    """Decodes CDR, little or big endian. Types are compiled on first use."""

    def __init__(self) -> None:
        self._library = TypeLibrary()
        self._types: dict[tuple[str, str | None], ReadableType | None] = {}

    def can_decode(self, channel: Channel) -> bool:
        """Whether the channel's messages are CDR of a type that the bag defines or ROS 2 knows."""
        return channel.serialization_format == _DECODED_FORMAT and self._type(channel) is not None

    def unread(self, channel: Channel) -> Sequence[str]:
        """The paths, without indices, of fields that stay unknown, as ROS 2 lacks them in Python."""
        kind = self._type(channel)
        return () if kind is None else kind.unread

    def decode(self, channel: Channel, payload: bytes) -> object:
        """The message in ``payload``.

        Raises ``RecordingError`` for an unknown type, or bytes that are not a message of it.
        """
        kind = self._type(channel)
        if kind is None:
            raise RecordingError(f"the type {channel.type_name} is unknown", place=channel.topic)
        try:
            return kind.read(payload)
        except BROKEN_MESSAGE as error:
            raise RecordingError(f"not a {channel.type_name}: {error}", place=channel.topic) from error

    def _type(self, channel: Channel) -> ReadableType | None:
        key = (channel.type_name, channel.definition)
        if key not in self._types:
            self._types[key] = self._library.readable(channel)
        return self._types[key]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Type definitions, and serialized messages decoded by them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, cast

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_typestore

from smarttestudo.bags.definition_text import Section, is_idl_definition, sections
from smarttestudo.bags.readable_types import (
    BROKEN_MESSAGE,
    ReadableType,
    empty_store,
    layout,
    nest_at_most,
    other_encapsulation,
    require_few_statements,
    require_few_values,
    types_within,
    with_inner,
)
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import TypeName, full_type_name
from smarttestudo.domain.recording import Channel

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Fielddefs, FieldDesc, Typesdict
    from rosbags.typesys.store import Typestore

_NAME = r"[A-Za-z]\w*"
_FIELD = re.compile(
    rf"(?:@\w+[ \t]+)*(?P<type>{_NAME}(?:/{_NAME}){{0,2}})(?:<=(?P<characters>\d+))?"
    rf"(?:\[[ \t]*(?P<bounded><=)?[ \t]*(?P<length>\d*)[ \t]*\])?[ \t]+(?P<field>{_NAME})"
    r"(?:[ \t]*(?P<constant>=)|[ \t#]|\Z)",
    re.ASCII,
)
_NOTHING = re.compile(r"(?:#.*|@\w+|=*)\Z")
_TEXTS = frozenset({"string", "wstring"})
_BASE_TYPES = _TEXTS.union(
    ("bool", "byte", "char", "float32", "float64"),
    (f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)),
)
_ALIASES = {
    "Header": "std_msgs/msg/Header",
    "time": "builtin_interfaces/msg/Time",
    "duration": "builtin_interfaces/msg/Duration",
}
_SHOWN = 40


class DefinitionError(ValueError):
    """Text that defines no type; its message says where."""


def msg_fields(section: Section, package: str, kind: str) -> Fielddefs:
    """The fields in ``section``, in which types without one are those of ``package``.

    Types of that ``kind``, such as srv, are among those that it names. Raises ``DefinitionError`` for a line
    that is none.
    """
    fields: dict[str, FieldDesc] = {}
    for number, line in enumerate(section.text.split("\n"), section.line):
        text = line.strip()
        if _NOTHING.match(text):
            continue
        match = _FIELD.match(text)
        if match is None or (match["characters"] and match["type"] not in _TEXTS):
            shown = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"
            raise DefinitionError(f"line {number}: {shown!r} is no field")
        name = match["field"]
        if name in fields:
            raise DefinitionError(f"line {number}: a second field {name}")
        if match["constant"] is None:
            fields[name] = _desc(match, package, kind)
    return [*fields.items()]


def _desc(match: re.Match[str], package: str, kind: str) -> FieldDesc:
    name = match["type"]
    inner: FieldDesc = (Nodetype.NAME, _ALIASES.get(name) or full_type_name(name, package, kind))
    if name in _BASE_TYPES:
        inner = cast("FieldDesc", (Nodetype.BASE, (name, int(match["characters"] or 0))))
    if match["length"] is None:
        return inner
    is_array = match["length"] and not match["bounded"]
    node = Nodetype.ARRAY if is_array else Nodetype.SEQUENCE
    return cast("FieldDesc", (node, (inner, int(match["length"] or 0))))


_PARTS = re.compile(r"^---[ \t]*$", re.MULTILINE)
_NAMES = {2: ("Request", "Response"), 3: ("Goal", "Result", "Feedback")}
_UUID = "unique_identifier_msgs/UUID"
_KNOWN = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    _UUID: "uint8[16] uuid\n",
    "service_msgs/ServiceEventInfo": "uint8 REQUEST_SENT = 0\nuint8 REQUEST_RECEIVED = 1\n"
    "uint8 RESPONSE_SENT = 2\nuint8 RESPONSE_RECEIVED = 3\nuint8 event_type\n"
    "builtin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number\n",
}


def messages_within(section: Section, name: TypeName) -> Iterator[Section]:
    """The parts of a section that is the file of a service or action, that of ``name``; else the section."""
    parts = _PARTS.split(section.text)
    if len(parts) not in _NAMES:
        yield section
        return
    line = section.line
    for part, text in zip(_NAMES[len(parts)], parts, strict=True):
        yield Section(name=f"{name.package}/{name.defined_in}_{part}", text=text, line=line, is_idl=False)
        line += text.count("\n")


def generated_sections(name: TypeName) -> list[Section]:
    """Texts of what rosidl adds to the parts of the service or action of ``name``, and of the types in it.

    There are none for a message.
    """
    of = f"{name.package}/{name.defined_in}"
    texts = {"msg": {}, "srv": _of_service(of), "action": _of_action(of)}[name.kind]
    texts = {**_KNOWN, **texts} if texts else {}
    return [Section(name=one, text=text, line=1, is_idl=False) for one, text in texts.items()]


def _of_service(of: str) -> dict[str, str]:
    event = f"service_msgs/ServiceEventInfo info\n{of}_Request[<=1] request\n{of}_Response[<=1] response\n"
    return {f"{of}_Event": event}


def _of_action(of: str) -> dict[str, str]:
    return {
        f"{of}_FeedbackMessage": f"{_UUID} goal_id\n{of}_Feedback feedback\n",
        f"{of}_SendGoal_Request": f"{_UUID} goal_id\n{of}_Goal goal\n",
        f"{of}_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp\n",
        f"{of}_GetResult_Request": f"{_UUID} goal_id\n",
        f"{of}_GetResult_Response": f"int8 status\n{of}_Result result\n",
        **_of_service(f"{of}_SendGoal"),
        **_of_service(f"{of}_GetResult"),
    }


_DEFINITIONS_KEPT = 256
_DEEPEST = 64
_INCLUDE = re.compile(r"^[ \t]*#.*", re.MULTILINE)
_ENUM = re.compile(r"(?:@bit_bound\s*\(\s*(?P<bits>\d+)\s*\)\s*)?\benum\s+(?P<name>\w+)\s*\{[^{}]*\}")
_ENUM_FIELD = "number_of_enum"
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
_DECODED_FORMAT = "cdr"
_NO_TYPE_NAME = re.compile(r"[^A-Za-z0-9_/]")


class TypeLibrary:
    """The types of recordings, by their own definitions, else by those of ROS 2's standard packages."""

    def types_for(self, channel: Channel) -> Typesdict | None:
        """The channel's type and those within it; ``None`` where its messages cannot be decoded."""
        known = _known(channel)
        return None if isinstance(known, str) else known

    def readable(self, channel: Channel) -> ReadableType | None:
        """The channel's type, to read its messages; ``None`` where they cannot be decoded."""
        types, definition = self.types_for(channel), channel.definition
        if types is None:
            return None
        is_own = definition is not None and not isinstance(_types_in(definition, channel.type_name), str)
        try:
            return ReadableType(
                types, channel.type_name, is_idl=is_own and is_idl_definition(definition or "")
            )
        except _BROKEN_DEFINITION:
            return None

    def why_undecodable(self, channel: Channel) -> str | None:
        """Why no message of the channel can be decoded; ``None`` where they can."""
        known = _known(channel)
        return known if isinstance(known, str) else None

    def is_standard(self, channel: Channel) -> bool:
        """Whether messages have the bytes of the type of that name in ROS 2, as far as anybody knows."""
        types = self.types_for(channel)
        return types is None or is_standard(types, channel.type_name)

    def definition_and_digest(self, channel: Channel) -> tuple[str, str]:
        """Definition and digest of the channel's type in a bag; empty strings where nobody knows."""
        if channel.definition is not None and channel.digest:
            return channel.definition, channel.digest
        types = self.types_for(channel)
        if types is None:
            return channel.definition or "", channel.digest
        store = _store(types)
        definition = channel.definition
        if definition is None:
            definition, _ = store.generate_msgdef(channel.type_name, ros_version=2)
        return definition, channel.digest or _digest(store, channel.type_name)


def _known(channel: Channel) -> Typesdict | str:
    """The types of a channel, or why they are not known."""
    name, definition, form = channel.type_name, channel.definition, channel.serialization_format
    if form != _DECODED_FORMAT:
        return f"recorded as {form or 'no known format'}, not as cdr"
    if not name:
        return "recorded without a type"
    if _NO_TYPE_NAME.search(name):
        return "its type has letters that no type of ROS 2 has"
    own = None if definition is None else _types_in(definition, name)
    if own is not None and not isinstance(own, str):
        return own
    for release in _STORES:
        known = _release(release).fielddefs
        if name in known:
            return types_within(known, name)
    if own is not None:
        return f"its definition of {name} is not understood: {own}"
    schema = channel.foreign_schema
    if schema is not None:
        return f"its type {name} is defined in {schema.encoding or 'no known language'}, not by ROS 2"
    return f"neither the recording nor ROS 2 defines {name}"


def is_standard(types: Typesdict, name: str) -> bool:
    """Whether a type has the fields of that of ROS 2, in whatever release; true of one that ROS 2 lacks."""
    known = [fields for release in _STORES if name in (fields := _release(release).fielddefs)]
    own = layout(types, name)
    return not known or any(layout(fields, name) == own for fields in known)


@lru_cache(maxsize=len(_STORES))
def _release(release: Stores) -> Typestore:
    return get_typestore(release)


# Every reader of a recording asks for the same few.
@lru_cache(maxsize=_DEFINITIONS_KEPT)
def _types_in(definition: str, type_name: str) -> Typesdict | str:
    """The type and those within it, or what of the definition is not understood.

    What the definition names and does not define is as in ROS 2.
    """
    try:
        found = _with_inner(_parsed(definition, type_name), type_name)
        require_few_values(found, type_name)
    except _BROKEN_DEFINITION as error:
        return str(error)
    return found


def _with_inner(types: Typesdict, type_name: str) -> Typesdict:
    """The type and those within it, of ROS 2 where ``types`` lack one. Raises ``DefinitionError``."""
    lacks = type_name
    for release in (None, *_STORES) if type_name in types else ():
        known = types if release is None else {**_release(release).fielddefs, **types}
        try:
            found = types_within(known, type_name)
        except KeyError as error:
            lacks = str(error.args[0])
            continue
        if not nest_at_most(found, _DEEPEST):
            raise DefinitionError(f"its types nest without end, or beyond {_DEEPEST}")
        return found
    raise DefinitionError(f"it does not define {lacks}")


def _parsed(definition: str, type_name: str) -> Typesdict:
    """The types that a definition defines. Raises one of ``_BROKEN_DEFINITION``."""
    name = TypeName.read(type_name)
    is_generated = name is not None and name.kind != "msg"
    require_few_statements(definition, is_idl=False)
    own = sections(definition, type_name)
    types: Typesdict = {}
    for section in (*(generated_sections(name) if name else ()), *own):
        if section.is_idl:
            types.update(_types_of_idl(section))
            continue
        for part in messages_within(section, name) if name and is_generated else (section,):
            of = full_type_name(part.name, "", name.kind if name else "msg")
            try:
                types[of] = [], msg_fields(part, of.partition("/")[0], name.kind if name else "msg")
            except DefinitionError:
                if of == type_name or not _is_of_ros(of):
                    raise
    types = _with_numbers_for_enums(types)
    if not own[0].is_idl and not is_generated:
        # The first text is that of the type, whatever its header calls it.
        types.setdefault(type_name, types[full_type_name(own[0].name, "")])
    return types


def _types_of_idl(section: Section) -> Typesdict:
    require_few_statements(section.text, is_idl=True)
    try:
        return get_types_from_idl(_ENUM.sub(_struct_of_enum, _INCLUDE.sub("", section.text)))
    except _BROKEN_DEFINITION as error:
        raise DefinitionError(f"the text from line {section.line} on is no IDL that ROS 2 has") from error


def _struct_of_enum(enum: re.Match[str]) -> str:
    """A struct in the place of an enum, of which rosbags makes no type: one number, as in CDR."""
    bits = int(enum["bits"] or 32)
    width = next((width_bits for width_bits in (8, 16, 32) if bits <= width_bits), 32)
    return f"struct {enum['name']} {{ uint{width} {_ENUM_FIELD}; }}"


def _with_numbers_for_enums(types: Typesdict) -> Typesdict:
    """``types`` whose fields are numbers where they were of enums, wherever those are defined."""
    enums = {
        name: fields[0][1]
        for name, (_, fields) in types.items()
        if [field for field, _ in fields] == [_ENUM_FIELD]
    }

    def number(desc: FieldDesc) -> FieldDesc:
        return enums.get(desc[1], desc) if desc[0] == Nodetype.NAME else desc

    return {
        name: (constants, [(field, with_inner(desc, number)) for field, desc in fields])
        for name, (constants, fields) in types.items()
        if name not in enums
    }


def _is_of_ros(type_name: str) -> bool:
    return any(type_name in _release(release).fielddefs for release in _STORES)


def _store(types: Typesdict) -> Typestore:
    """A store that knows the fields of ``types``, and reads no messages."""
    store = empty_store()
    store.fielddefs.update(types)
    return store


def _digest(store: Typestore, type_name: str) -> str:
    try:
        return store.hash_rihs01(type_name)
    except _BROKEN_DEFINITION:
        return ""


def digest_of(definition: str | None, type_name: str) -> str:
    """The digest of the fields of a type; an empty string where the definition is none."""
    types = _types_in(definition or "", type_name)
    return "" if isinstance(types, str) else _digest(_store(types), type_name)


class RosbagDecoder:
    """Turns CDR, little or big endian, into objects with the fields of their type as attributes.

    Types are compiled on first use.
    """

    def __init__(self) -> None:
        self._library = TypeLibrary()
        self._types: dict[tuple[str, str, str | None], ReadableType | None] = {}
        self._reasons: dict[str, str] = {}

    def why_undecodable(self, channel: Channel) -> str | None:
        """Why no message of the channel can be decoded; ``None`` for CDR of a type of the bag or of ROS 2."""
        return self._library.why_undecodable(channel)

    def is_standard(self, channel: Channel) -> bool:
        """Whether messages have the bytes of the type of that name in ROS 2, as far as anybody knows."""
        return self._library.is_standard(channel)

    def unread(self, channel: Channel) -> Sequence[str]:
        """The paths, without indices, of fields that stay unknown, as ROS 2 lacks them in Python."""
        kind = self._type(channel)
        return () if kind is None else kind.unread

    def decode(self, channel: Channel, payload: bytes) -> object:
        """The message in ``payload``.

        Raises ``RecordingError`` for what cannot be decoded at all, or bytes that are not a message of it.
        """
        kind = self._type(channel)
        if kind is None:
            why = self.why_undecodable(channel) or f"the type {channel.type_name} cannot be read"
            raise RecordingError(why, place=channel.topic)
        other = other_encapsulation(payload)
        if other is not None:
            self._reasons.setdefault(channel.topic, other)
            raise RecordingError(other, place=channel.topic)
        try:
            return kind.read(payload)
        except BROKEN_MESSAGE as error:
            raise RecordingError(f"not a {channel.type_name}: {error}", place=channel.topic) from error

    def reason(self, topic: str) -> str:
        """Reason for a notice of messages of the topic that could not be decoded, with a colon before it.

        Empty where their bytes are no message of its type.
        """
        return f": {self._reasons[topic]}" if topic in self._reasons else ""

    def _type(self, channel: Channel) -> ReadableType | None:
        key = (channel.type_name, channel.serialization_format, channel.definition)
        if key not in self._types:
            self._types[key] = self._library.readable(channel)
        return self._types[key]

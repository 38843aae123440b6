# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Channels of the texts that storage files and metadata have of them, and what is one channel in several."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from smarttestudo.bags.definition_text import stored_definition
from smarttestudo.bags.qos import is_transient_local, qos_profiles
from smarttestudo.domain.names import ros_type_name
from smarttestudo.domain.recording import Channel, ForeignSchema

if TYPE_CHECKING:
    from smarttestudo.bags.mcap.summary import ChannelEntry, SchemaEntry

MAX_COMPARED = 20
"""With so many definitions of a topic another one is compared; with more it counts as one of its own."""
ChannelKey = tuple[str, str, str, str | None]
Definition = tuple[str | None, ForeignSchema | None]
NO_DEFINITION: Definition = (None, None)


def with_escapes(text: str) -> str:
    r"""``text`` with ``\xe9`` for each byte that was no UTF-8, which decoding left as a surrogate."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


class ChannelReader:
    """Makes channels of texts with such surrogates; what makes no sense costs itself.

    ``notices`` has a line for each channel and each definition of which a text was left out or is not UTF-8.
    """

    def __init__(self) -> None:
        self.notices: list[str] = []

    def channel(
        self,
        *,
        topic: str,
        type_name: str,
        serialization_format: str,
        qos: object,
        digest: str = "",
        definition: Definition = NO_DEFINITION,
    ) -> Channel:
        """The channel; ``qos`` is a text of YAML, or a list from version 9 of the metadata on."""
        texts = {
            "name": topic,
            "type": type_name,
            "serialization format": serialization_format,
            "hash": digest,
        }
        escaped = {name: with_escapes(text) for name, text in texts.items()}
        odd = " and ".join(name for name, text in texts.items() if escaped[name] != text)
        if odd:
            self.notices.append(f"{escaped['name']}: its {odd} {'are' if ' and ' in odd else 'is'} not UTF-8")
        try:
            profiles = qos_profiles(qos)
        except ValueError:
            self.notices.append(f"the QoS profiles of {escaped['name']} cannot be read and were left out")
            profiles = ()
        text, foreign = definition
        return Channel(
            topic=escaped["name"],
            type_name=ros_type_name(escaped["type"], escaped["serialization format"]),
            definition=text,
            digest=escaped["hash"],
            qos=profiles,
            serialization_format=escaped["serialization format"],
            transient_local=is_transient_local(profiles),
            foreign_schema=foreign,
        )

    def of_mcap(self, record: ChannelEntry, schema: SchemaEntry | None) -> Channel:
        """The channel of a record, with its type if the file has a ``schema`` for it."""
        type_name, definition = "", NO_DEFINITION
        if schema is not None:
            type_name = ros_type_name(schema.name, record.message_encoding)
            definition = self.definition(type_name, schema.encoding, schema.data)
        return self.channel(
            topic=record.topic,
            type_name=type_name,
            serialization_format=record.message_encoding,
            qos=record.metadata.get("offered_qos_profiles"),
            digest=record.metadata.get("topic_type_hash", ""),
            definition=definition,
        )

    def definition(self, type_name: str, encoding: str, data: bytes) -> Definition:
        """The definition of a type, or its schema in another language."""
        text, foreign = stored_definition(type_name, encoding, data)
        if text is not None and "\ufffd" in text and not _is_utf8(data):
            notice = f"the definition of {with_escapes(type_name)} is not UTF-8"
            self.notices += [notice] if notice not in self.notices else []
        return text, foreign


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def key_of(channel: Channel) -> ChannelKey:
    """Key of a channel: topic, type, and how messages are to be decoded."""
    return channel.topic, channel.type_name, channel.serialization_format, channel.definition


class MergedChannels:
    """One channel for each topic and type; what an earlier one leaves open, later ones fill in.

    A topic has several of one type where its definitions differ in their fields: messages mean what their
    own says.
    """

    def __init__(self, channels: Iterable[Channel]) -> None:
        self._numbers: dict[ChannelKey, int] = {}
        self._alike: dict[tuple[str, str], list[int]] = {}
        self._merged: list[Channel] = []
        for channel in channels:
            self._add(channel)

    def all(self) -> tuple[Channel, ...]:
        """The merged channels, in the order in which they were added."""
        return tuple(self._merged)

    def of(self, channel: Channel) -> Channel:
        """The merged channel that ``channel`` went into."""
        return self._merged[self._numbers[key_of(channel)]]

    def _add(self, channel: Channel) -> None:
        alike = self._alike.setdefault((channel.topic, channel.type_name), [])
        number = self._numbers.get(key_of(channel))
        if number is None:
            number = next(
                (key for key in alike[:MAX_COMPARED] if _means_the_same(self._merged[key], channel)), None
            )
        if number is None:
            number = len(self._merged)
            self._merged.append(channel)
            alike.append(number)
        self._numbers[key_of(channel)] = number
        self._merged[number] = _filled_in(self._merged[number], channel)


def _means_the_same(known: Channel, other: Channel) -> bool:
    if known.serialization_format != other.serialization_format:
        return False
    if not known.definition or not other.definition or known.definition == other.definition:
        return True
    if known.digest and other.digest:
        return known.digest == other.digest
    from smarttestudo.bags.definitions import digest_of  # noqa: PLC0415  slow to import, and seldom needed

    digests = {digest_of(channel.definition, channel.type_name) for channel in (known, other)}
    return len(digests) == 1 and "" not in digests


def _filled_in(known: Channel, other: Channel) -> Channel:
    takes_qos = not known.qos
    return replace(
        known,
        definition=known.definition or other.definition,
        digest=known.digest or other.digest,
        foreign_schema=known.foreign_schema or other.foreign_schema,
        qos=other.qos if takes_qos else known.qos,
        transient_local=other.transient_local if takes_qos else known.transient_local,
    )

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Channels of a recording in an MCAP file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from smarttestudo.bags.definition_text import stored_definition
from smarttestudo.bags.qos import QosReader, is_transient_local
from smarttestudo.domain.names import ros_type_name
from smarttestudo.domain.recording import Channel

if TYPE_CHECKING:
    from mcap.records import Channel as ChannelRecord
    from mcap.records import Schema

    from smarttestudo.bags.mcap.summary import ChannelEntry, SchemaEntry


def stored_channel(
    record: ChannelRecord | ChannelEntry, schema: Schema | SchemaEntry | None, qos_reader: QosReader
) -> Channel:
    """The channel of a record, with its type if the file has a ``schema`` for it."""
    metadata: Mapping[str, str] = record.metadata
    qos = qos_reader.read_or_note(record.topic, metadata.get("offered_qos_profiles"))
    type_name, definition, foreign = "", None, None
    if schema is not None:
        type_name = ros_type_name(schema.name, record.message_encoding)
        definition, foreign = stored_definition(type_name, schema.encoding, bytes(schema.data))
    return Channel(
        topic=record.topic,
        type_name=type_name,
        definition=definition,
        digest=metadata.get("topic_type_hash", ""),
        qos=qos,
        serialization_format=record.message_encoding,
        transient_local=is_transient_local(qos),
        foreign_schema=foreign,
    )

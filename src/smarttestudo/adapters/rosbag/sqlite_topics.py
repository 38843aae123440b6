# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics that a .db3 file announces, with their types."""

from __future__ import annotations

from contextlib import suppress

import apsw

from smarttestudo.adapters.rosbag.definitions import normal_definition
from smarttestudo.adapters.rosbag.qos import QosReader, is_transient_local
from smarttestudo.domain.recording import Channel

BROKEN = (apsw.Error, LookupError, TypeError, ValueError)
"""What reading topics raises on a damaged file."""


def read_topics(database: apsw.Connection, qos: QosReader) -> dict[int, Channel]:
    """The channels that SQLite can read, by their numbers.

    Raises one of ``BROKEN`` where it finds no table of them.
    """
    definitions = _definitions(database)
    channels: dict[int, Channel] = {}
    rows = database.execute("SELECT * FROM topics ORDER BY id")
    with suppress(apsw.Error):
        for row in rows:
            columns = dict(zip((column[0] for column in rows.description), row, strict=True))
            channels[int(columns["id"])] = _channel(columns, definitions, qos)
    return channels


def _channel(columns: dict[str, apsw.SQLiteValue], definitions: dict[str, str], qos: QosReader) -> Channel:
    topic, type_name = str(columns["name"]), str(columns["type"])
    profiles = qos.read_or_note(topic, columns.get("offered_qos_profiles"))
    return Channel(
        topic=topic,
        type_name=type_name,
        definition=definitions.get(type_name),
        digest=str(columns.get("type_description_hash") or ""),
        qos=profiles,
        serialization_format=str(columns["serialization_format"]),
        transient_local=is_transient_local(profiles),
    )


def _definitions(database: apsw.Connection) -> dict[str, str]:
    """Definitions by type name; none in a bag of Humble or older, which has no such table."""
    definitions: dict[str, str] = {}
    with suppress(apsw.Error):
        for name, encoding, text in database.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        ):
            definition = normal_definition(str(text), type_name=str(name), is_idl=encoding == "ros2idl")
            if definition is not None:
                definitions[str(name)] = definition
    return definitions

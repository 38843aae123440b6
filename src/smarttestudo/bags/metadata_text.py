# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The ``metadata.yaml`` of a rosbag2 (version 8, which all from Humble on read), written without YAML."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from smarttestudo.bags.mcap.record_bytes import StoredChannel
    from smarttestudo.bags.mcap.writer import FileContent
    from smarttestudo.domain.robot import Qos

METADATA_NAME = "metadata.yaml"
_UNLIMITED = "{sec: 9223372036, nsec: 854775807}"
_KEEP_LAST, _AUTOMATIC = 1, 1
_RELIABLE, _BEST_EFFORT = 1, 2
_TRANSIENT_LOCAL, _VOLATILE = 1, 2


def offered_qos(qos: Qos) -> str:
    """Entry for a publisher with ``qos`` in a bag's metadata."""
    return qos_entry(
        depth=qos.depth,
        reliability=_RELIABLE if qos.reliable else _BEST_EFFORT,
        durability=_TRANSIENT_LOCAL if qos.transient_local else _VOLATILE,
    )


def qos_entry(
    *,
    history: int = _KEEP_LAST,
    depth: int,
    reliability: int,
    durability: int,
    deadline: str = _UNLIMITED,
    lifespan: str = _UNLIMITED,
    liveliness: int = _AUTOMATIC,
    liveliness_lease_duration: str = _UNLIMITED,
    avoid_ros_namespace_conventions: bool = False,
) -> str:
    """Entry for a profile, with its policies as rmw numbers them."""
    return (
        f"- history: {history}\n"
        f"  depth: {depth}\n"
        f"  reliability: {reliability}\n"
        f"  durability: {durability}\n"
        f"  deadline: {deadline}\n"
        f"  lifespan: {lifespan}\n"
        f"  liveliness: {liveliness}\n"
        f"  liveliness_lease_duration: {liveliness_lease_duration}\n"
        f"  avoid_ros_namespace_conventions: {str(avoid_ros_namespace_conventions).lower()}"
    )


def metadata_text(
    files: Mapping[str, FileContent],
    channels: Sequence[StoredChannel],
    *,
    storage: str = "mcap",
    custom_data: Mapping[str, str] | None = None,
) -> str:
    """The metadata of a bag with ``files`` by name, in their order, and all its ``channels``."""
    text = information(files, channels, storage=storage, custom_data=custom_data)
    return f"rosbag2_bagfile_information:\n{textwrap.indent(text, '  ')}\n"


def information(
    files: Mapping[str, FileContent],
    channels: Sequence[StoredChannel],
    *,
    storage: str,
    custom_data: Mapping[str, str] | None,
) -> str:
    """The same as a storage file holds it: without its name."""
    filled = {name: content for name, content in files.items() if content.message_count}
    first_ns = min((content.first_ns for content in filled.values()), default=0)
    last_ns = max((content.last_ns for content in filled.values()), default=0)
    of_channels = [line for channel in channels for line in _channel(channel, files.values())]
    of_files = [
        line
        for name, content in files.items()
        for line in (
            f"  - path: {_quoted(name)}",
            *_span("    ", content.first_ns, content.last_ns, content.message_count),
        )
    ]
    notes = [f"  {_quoted(key)}: {_quoted(text)}" for key, text in (custom_data or {}).items()]
    lines = [
        "version: 8",
        f"storage_identifier: {storage}",
        *_listed("relative_file_paths", [f"  - {_quoted(name)}" for name in files]),
        *_span("", first_ns, last_ns, sum(content.message_count for content in files.values())),
        *_listed("topics_with_message_count", of_channels),
        'compression_format: ""',
        'compression_mode: ""',
        *_listed("files", of_files),
        *(["custom_data:", *notes] if notes else ["custom_data: null"]),
        "ros_distro: smarttestudo",
    ]
    return "\n".join(lines)


def _span(indent: str, first_ns: int, last_ns: int, messages: int) -> list[str]:
    return [
        f"{indent}duration:",
        f"{indent}  nanoseconds: {last_ns - first_ns}",
        f"{indent}starting_time:",
        f"{indent}  nanoseconds_since_epoch: {first_ns}",
        f"{indent}message_count: {messages}",
    ]


def _channel(channel: StoredChannel, files: Iterable[FileContent]) -> list[str]:
    key = channel.topic, channel.schema
    messages = sum(content.of_types.get(key, 0) for content in files)
    return [
        "  - topic_metadata:",
        f"      name: {_quoted(channel.topic)}",
        f"      type: {_quoted(channel.type_name)}",
        f"      serialization_format: {_quoted(channel.serialization_format)}",
        f"      offered_qos_profiles: {_quoted(channel.qos_text)}",
        f"      type_description_hash: {_quoted(channel.digest)}",
        f"    message_count: {messages}",
    ]


def _listed(name: str, lines: list[str]) -> list[str]:
    return [f"{name}:", *lines] if lines else [f"{name}: []"]


def _quoted(text: str) -> str:
    """A JSON string, which is a YAML one."""
    return json.dumps(text)

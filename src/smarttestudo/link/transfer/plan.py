# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents of a robot: the list of them, and the files of each with the order of their bytes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.incident import RemoteIncident
from smarttestudo.link.protocol.wire import FrameType, Kind
from smarttestudo.link.transfer.messages import MOST_BYTES, VERSION_BYTES
from smarttestudo.link.transfer.order import Level

MAX_FILES = 1_000
MAX_PLAN_BYTES = 1_000_000
MAX_LISTED = 1_000
MAX_LIST_BYTES = 800_000
FILES = "/files"
"""After the name of an incident, whose own bytes are its plan: those of its files."""
_MAX_TEXT = 1_000
_MAX_LEVELS = 64
_SHA256_BYTES = 32
_INCIDENT_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,99}\Z")
_FILE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,149}\Z")


class PlannedFile(NamedTuple):
    """A file of an incident."""

    name: str
    size_bytes: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferPlan:
    """The files of an incident, and what is known of the ``order_bytes`` as which they travel.

    ``version`` changes with the files and with the order.
    """

    version: bytes
    files: tuple[PlannedFile, ...]
    levels: tuple[Level, ...]
    order_bytes: int

    @property
    def size_bytes(self) -> int:
        """Size of all files together."""
        return sum(file.size_bytes for file in self.files)


def is_incident_name(name: str) -> bool:
    """Whether it can be the name of an incident's folder."""
    return _INCIDENT_NAME.match(name) is not None


def no_incident(name: str) -> LinkError:
    """Why nothing is fetched of an incident ``name``."""
    return LinkError(f"there is no incident {name!r:.80}", remedy="'testudo incidents list' names them")


def is_incident_file_name(name: str) -> bool:
    """Whether it can be the name of a file in an incident's folder."""
    return _FILE_NAME.match(name) is not None


def _check_list(incidents: Sequence[RemoteIncident]) -> None:
    for incident in incidents:
        texts = (incident.label, incident.rule, *incident.missing)
        is_short = all(len(text) <= _MAX_TEXT for text in texts)
        if not is_incident_name(incident.name) or incident.moments < 1 or not is_short:
            raise ValueError("no incident")


def _check_plan(plan: TransferPlan) -> None:
    """Refuse names that lead out of a folder, or are there twice wherever capitals do not count."""
    names = {file.name.lower() for file in plan.files}
    if len(plan.version) != VERSION_BYTES or len(plan.files) > MAX_FILES or len(names) != len(plan.files):
        raise ValueError("files that are none or too many")
    for file in plan.files:
        if not is_incident_file_name(file.name) or not 0 <= file.size_bytes <= MOST_BYTES:
            raise ValueError("no file")
        if len(bytes.fromhex(file.sha256)) != _SHA256_BYTES:
            raise ValueError("no digest of a file")
    if len(plan.levels) > _MAX_LEVELS or not 0 < plan.order_bytes <= MOST_BYTES:
        raise ValueError("no order")


_LISTS: FrameType[tuple[RemoteIncident, ...]] = FrameType(
    Kind.INCIDENT_LIST, tuple[RemoteIncident, ...], _check_list
)
PLANS: FrameType[TransferPlan] = FrameType(
    Kind.INCIDENT_PLAN, TransferPlan, _check_plan, most_bytes=MAX_PLAN_BYTES
)


def list_to_bytes(incidents: Sequence[RemoteIncident]) -> bytes:
    """The newest of the incidents, as many as may travel at once."""
    newest: list[RemoteIncident] = []
    size_bytes = 0
    for incident in reversed(incidents[-MAX_LISTED:]):
        short = replace(incident, label=incident.label[:_MAX_TEXT], rule=incident.rule[:_MAX_TEXT])
        size_bytes += len(_LISTS.to_bytes((short,)))
        if size_bytes > MAX_LIST_BYTES:
            break
        newest.append(short)
    return _LISTS.to_bytes(tuple(reversed(newest)))


def list_from_bytes(data: bytes, robot: str) -> list[RemoteIncident]:
    """The incidents of ``list_to_bytes``. Raises ``LinkError``."""
    return [replace(incident, robot=robot) for incident in _LISTS.from_bytes(data)]

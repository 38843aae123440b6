# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions about the incidents of a robot and their answers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError
from smarttestudo.incidents.transfer_order import Level, RangePart

MAX_ASK_BYTES = 16_000
"""How many bytes of an order are asked for at once."""
MAX_FILES = 1_000
TOKEN_BYTES = 16

_INCIDENT_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,99}\Z")
_FILE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,149}\Z")


@dataclass(frozen=True, slots=True, kw_only=True)
class AskList:
    """A question for the list of incidents."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AskPlan:
    """A question for the files of an incident."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AskBytes:
    """``size_bytes`` of the order of an incident from ``cursor`` on, or fewer.

    ``asker`` is a random number that tells who asks; it has got ``got_bytes`` of what was sent to it so far.
    To ask for no bytes is to say only that.
    ``token`` is that of the incident's plan.
    """

    name: str
    token: bytes
    asker: int
    got_bytes: int
    cursor: int
    size_bytes: int


TransferQuestion = AskList | AskPlan | AskBytes


class PlannedFile(NamedTuple):
    """A file of an incident."""

    name: str
    size_bytes: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferPlan:
    """The files of an incident, and what is known of the order of their bytes.

    ``token`` changes with the files and with the order.
    """

    token: bytes
    files: tuple[PlannedFile, ...]
    levels: tuple[Level, ...]

    @property
    def size_bytes(self) -> int:
        """All of them together."""
        return sum(one.size_bytes for one in self.files)


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferPiece:
    """Some bytes of an order, from where they were asked for.

    ``body`` has those of ``parts`` that are no copies, one after the other. The robot's end advises to ask
    for ``advised_bytes`` at once; so many other asks ``waiting`` of this asker were there when it answered.
    """

    parts: tuple[RangePart, ...]
    body: bytes
    advised_bytes: int
    waiting: int

    @property
    def covered_bytes(self) -> int:
        """How many bytes of the order these are."""
        return sum(part.size_bytes for part in self.parts)


def is_incident_name(name: str) -> bool:
    """Whether it can be the name of an incident's folder."""
    return _INCIDENT_NAME.match(name) is not None


def no_incident(name: str) -> LinkError:
    """Why nothing is fetched of an incident ``name``."""
    return LinkError(f"there is no incident {name!r:.80}", remedy="'testudo incidents list' names them")


def is_incident_file_name(name: str) -> bool:
    """Whether it can be the name of a file in an incident's folder."""
    return _FILE_NAME.match(name) is not None

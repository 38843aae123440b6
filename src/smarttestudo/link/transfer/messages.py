# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions about a robot's incidents and their answers, and how they travel."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.incident import RemoteIncident
from smarttestudo.link.protocol.wire import FrameType, Kind, malformed
from smarttestudo.link.transfer.order import Level, RangePart

MAX_ASK_BYTES = 16_000
"""How many bytes of an order are asked for at once."""
MAX_FILES = 1_000
TOKEN_BYTES = 16
MAX_LISTED = 1_000
MAX_LIST_BYTES = 800_000
MAX_FILE_BYTES = 2**62
MAX_PIECE_BYTES = 200_000
"""The size of a piece with the places of its parts."""
_MAX_TEXT = 1_000
_MAX_LEVELS = 64
_SHA256_BYTES = 32

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
        """Size of all files together."""
        return sum(file.size_bytes for file in self.files)


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


def _check_question(question: TransferQuestion) -> None:
    if isinstance(question, AskList):
        return
    if not is_incident_name(question.name):
        raise ValueError("no name of an incident")
    if isinstance(question, AskBytes):
        numbers = (question.got_bytes, question.cursor, question.asker)
        if not 0 <= question.size_bytes <= MAX_ASK_BYTES or min(numbers) < 0:
            raise ValueError("no range of bytes")


def _check_list(incidents: Sequence[RemoteIncident]) -> None:
    for incident in incidents:
        if (
            not is_incident_name(incident.name)
            or incident.moments < 1
            or any(len(text) > _MAX_TEXT for text in _texts(incident))
        ):
            raise ValueError("no incident")


def _check_plan(plan: TransferPlan) -> None:
    """Refuse names that lead out of a folder, or are there twice wherever capitals do not count."""
    names = {file.name.lower() for file in plan.files}
    if len(plan.token) != TOKEN_BYTES or len(plan.files) > MAX_FILES or len(names) != len(plan.files):
        raise ValueError("files that are none or too many")
    for file in plan.files:
        if not is_incident_file_name(file.name) or not 0 <= file.size_bytes <= MAX_FILE_BYTES:
            raise ValueError("no file")
        if len(bytes.fromhex(file.sha256)) != _SHA256_BYTES:
            raise ValueError("no digest of a file")
    if len(plan.levels) > _MAX_LEVELS:
        raise ValueError("too many levels")


def _check_piece(piece: TransferPiece) -> None:
    for part in piece.parts:
        _check_part(part)
    own_bytes = sum(part.size_bytes for part in piece.parts if part.whole.copy_of is None)
    if len(piece.body) != own_bytes or not piece.covered_bytes > 0:
        raise ValueError("other bytes than it says")
    if piece.advised_bytes <= 0 or piece.waiting < 0:
        raise ValueError("no advice")


def _check_part(part: RangePart) -> None:
    whole = part.whole
    numbers = (*whole[:3], *(whole.copy_of or ()), part.skipped_bytes, part.size_bytes)
    if min(numbers) < 0 or max(numbers) > MAX_FILE_BYTES or not part.size_bytes:
        raise ValueError("a range that is none")
    if part.skipped_bytes + part.size_bytes > whole.size_bytes:
        raise ValueError("a part that is not in its range")


QUESTIONS: FrameType[TransferQuestion] = FrameType(
    Kind.INCIDENT_QUESTION, AskList | AskPlan | AskBytes, _check_question, most_bytes=1_000
)
LISTS: FrameType[tuple[RemoteIncident, ...]] = FrameType(
    Kind.INCIDENT_LIST, tuple[RemoteIncident, ...], _check_list
)
PLANS: FrameType[TransferPlan] = FrameType(Kind.INCIDENT_PLAN, TransferPlan, _check_plan)
PIECES: FrameType[TransferPiece] = FrameType(
    Kind.INCIDENT_PIECE, TransferPiece, _check_piece, most_bytes=MAX_PIECE_BYTES
)


def list_to_bytes(incidents: Sequence[RemoteIncident]) -> bytes:
    """The newest of the incidents, as many as may travel at once."""
    newest: list[RemoteIncident] = []
    size_bytes = 0
    for incident in reversed(incidents[-MAX_LISTED:]):
        short = replace(incident, label=incident.label[:_MAX_TEXT], rule=incident.rule[:_MAX_TEXT])
        size_bytes += len(LISTS.to_bytes((short,)))
        if size_bytes > MAX_LIST_BYTES:
            break
        newest.append(short)
    return LISTS.to_bytes(tuple(reversed(newest)))


def list_from_bytes(data: bytes, robot: str) -> list[RemoteIncident]:
    """The incidents of ``list_to_bytes``. Raises ``LinkError``."""
    return [replace(incident, robot=robot) for incident in LISTS.from_bytes(data)]


def piece_from_bytes(data: bytes, most_bytes: int) -> TransferPiece:
    """A piece of at most ``most_bytes`` of an order. Raises ``LinkError`` for anything else."""
    piece = PIECES.from_bytes(data)
    if piece.covered_bytes > most_bytes:
        raise malformed("a piece that is larger than what was asked for")
    return piece


def _texts(incident: RemoteIncident) -> Iterable[str]:
    return (incident.label, incident.rule, *incident.missing)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is asked and answered about the incidents of a robot, as bytes."""

from __future__ import annotations

import json
import math
import re
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.remote_incidents import RemoteIncident
from smarttestudo.incidents.transfer_order import ByteRange, Level, RangePart

MAX_ASK_BYTES = 16_000
"""How many bytes of an order are asked for at once."""
MAX_LISTED = 1_000
MAX_FILES = 1_000
MAX_LIST_BYTES = 800_000
MAX_PARTS = 4_096
MAX_FILE_BYTES = 2**62
TOKEN_BYTES = 16

_VERSION = 1
_LIST, _PLAN, _ASK = 1, 2, 3
_MAX_TEXT = 1_000
_MAX_LEVELS = 64
_INCIDENT_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,99}\Z")
_FILE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,149}\Z")
# version, kind, asker, got bytes, cursor, size, token
_ASK_HEAD = struct.Struct(f"<BBQQQI{TOKEN_BYTES}s")
# version, flags, covered bytes, advised bytes, asks that wait, parts, bytes of the body
_PIECE_HEAD = struct.Struct("<BBIIHHI")
_COMPRESSED = 1
_UNREADABLE = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RecursionError)


@dataclass(frozen=True, slots=True, kw_only=True)
class AskList:
    """What incidents there are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AskPlan:
    """What the files of an incident are."""

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


Compress = Callable[[bytes], bytes | None]
"""What travels in the place of some bytes; ``None`` where that would not pay."""
Decompress = Callable[[bytes, int], bytes]
"""Makes the bytes of what travelled compressed, at most so many. Raises ``LinkError``."""


def question_to_bytes(question: TransferQuestion) -> bytes:
    """A question as it travels."""
    match question:
        case AskList():
            return bytes((_VERSION, _LIST))
        case AskPlan(name=name):
            return bytes((_VERSION, _PLAN)) + name.encode()
        case AskBytes():
            head = (question.asker, question.got_bytes, question.cursor, question.size_bytes, question.token)
            return _ASK_HEAD.pack(_VERSION, _ASK, *head) + question.name.encode()


def question_from_bytes(data: bytes) -> TransferQuestion:
    """What ``question_to_bytes`` made ``data`` of. Raises ``LinkError`` for anything else."""
    version, kind = (data[0], data[1]) if len(data) > 1 else (0, 0)
    if version == _VERSION and kind == _LIST and len(data) == len((version, kind)):
        return AskList()
    if version == _VERSION and kind == _PLAN:
        return AskPlan(name=_incident_name(data[2:]))
    if version == _VERSION and kind == _ASK and len(data) > _ASK_HEAD.size:
        _, _, asker, got_bytes, cursor, size_bytes, token = _ASK_HEAD.unpack_from(data)
        if size_bytes <= MAX_ASK_BYTES:
            return AskBytes(
                name=_incident_name(data[_ASK_HEAD.size :]),
                token=token,
                asker=asker,
                got_bytes=got_bytes,
                cursor=cursor,
                size_bytes=size_bytes,
            )
    raise LinkError(
        "the question is not understood", remedy="use the same version of SmartTestudo at both ends"
    )


def list_to_bytes(incidents: Sequence[RemoteIncident]) -> bytes:
    """The newest of the incidents, as many as may travel at once."""
    lines: list[bytes] = []
    size_bytes = 0
    for one in incidents[-MAX_LISTED:][::-1]:
        record = {
            "name": one.name,
            "label": one.label[:_MAX_TEXT],
            "rule": one.rule[:_MAX_TEXT],
            "triggered_ns": one.triggered_ns,
            "from_ns": one.from_ns,
            "to_ns": one.to_ns,
            "messages": one.messages,
            "size_bytes": one.size_bytes,
            "read": one.is_read,
            "missing": one.missing,
        }
        line = json_text(record, compact=True).encode("utf-8", "replace")
        size_bytes += len(line) + 1
        if size_bytes > MAX_LIST_BYTES:
            break
        lines.append(line)
    return b"\n".join(reversed(lines))


def list_from_bytes(data: bytes, robot: str) -> list[RemoteIncident]:
    """What ``list_to_bytes`` made ``data`` of. Raises ``LinkError`` for anything else."""
    try:
        lines = data.split(b"\n") if data else []
        if len(lines) > MAX_LISTED:
            raise ValueError("too many")
        return [_listed(json.loads(line), robot) for line in lines]
    except _UNREADABLE as error:
        raise LinkError("the list of incidents is not understood", place=robot) from error


def plan_to_bytes(plan: TransferPlan) -> bytes:
    """A plan as it travels."""
    record = {
        "token": plan.token.hex(),
        "files": [list(one) for one in plan.files],
        "levels": [[one.end, None if math.isinf(one.rate_hz) else one.rate_hz] for one in plan.levels],
    }
    return json_text(record, compact=True).encode()


def plan_from_bytes(data: bytes) -> TransferPlan:
    """What ``plan_to_bytes`` made ``data`` of. Raises ``LinkError`` for anything else.

    No name in it leads out of a folder, and none is there twice, wherever capitals do not count, too.
    """
    try:
        record = json.loads(data)
        token = bytes.fromhex(record["token"])
        files = tuple(_file(*one) for one in record["files"])
        levels = tuple(_level(*one) for one in record["levels"][:_MAX_LEVELS])
        names = {one.name.lower() for one in files}
        if len(token) != TOKEN_BYTES or len(files) > MAX_FILES or len(names) != len(files):
            raise ValueError("no plan")
    except _UNREADABLE as error:
        raise LinkError("the files of the incident are not understood") from error
    return TransferPlan(token=token, files=files, levels=levels)


def piece_to_bytes(piece: TransferPiece, compress: Compress = lambda _: None) -> bytes:
    """A piece as it travels."""
    compressed = compress(piece.body)
    body = piece.body if compressed is None else compressed
    head = _PIECE_HEAD.pack(
        _VERSION,
        _COMPRESSED * (compressed is not None),
        piece.covered_bytes,
        piece.advised_bytes,
        min(piece.waiting, 2**16 - 1),
        len(piece.parts),
        len(piece.body),
    )
    return b"".join((head, *map(_part_to_bytes, piece.parts), body))


def piece_from_bytes(data: bytes, most_bytes: int, decompress: Decompress) -> TransferPiece:
    """What ``piece_to_bytes`` made ``data`` of, at most ``most_bytes``. Raises ``LinkError`` for the rest."""
    try:
        version, flags, covered, advised, waiting, count, body_bytes = _PIECE_HEAD.unpack_from(data)
        if version != _VERSION or flags > _COMPRESSED or count > MAX_PARTS or body_bytes > most_bytes:
            raise ValueError("no piece")
        place, parts = _PIECE_HEAD.size, []
        for _ in range(count):
            part, place = _part_from_bytes(data, place)
            parts.append(part)
    except (struct.error, *_UNREADABLE) as error:
        raise LinkError("a piece of an incident is not understood") from error
    body = data[place:]
    if flags & _COMPRESSED:
        body = decompress(body, most_bytes)
    own_bytes = sum(part.size_bytes for part in parts if part.whole.copy_of is None)
    all_bytes = sum(part.size_bytes for part in parts)
    if not len(body) == body_bytes == own_bytes or not 0 < all_bytes == covered <= most_bytes:
        raise LinkError("a piece of an incident does not hold what it says")
    return TransferPiece(
        parts=tuple(parts),
        body=body,
        advised_bytes=min(max(advised, 1), MAX_ASK_BYTES),
        waiting=waiting,
    )


def is_incident_name(name: str) -> bool:
    """Whether it can be the name of an incident's folder."""
    return _INCIDENT_NAME.match(name) is not None


def is_incident_file_name(name: str) -> bool:
    """Whether it can be the name of a file in an incident's folder."""
    return _FILE_NAME.match(name) is not None


def _part_to_bytes(part: RangePart) -> bytes:
    whole = part.whole
    is_copy = whole.copy_of is not None
    numbers = [whole.file * 2 + is_copy, whole.offset, whole.size_bytes, part.skipped_bytes, part.size_bytes]
    if whole.copy_of is not None:
        numbers += whole.copy_of
    return b"".join(map(_varint, numbers))


def _part_from_bytes(data: bytes, place: int) -> tuple[RangePart, int]:
    (file, offset, size, skipped, part_size), place = _varints(data, place, 5)
    copy_of = None
    if file % 2:
        (source, source_offset), place = _varints(data, place, 2)
        copy_of = source, source_offset
    if not 0 < skipped + part_size <= size or not part_size:
        raise ValueError("a part that is not in its range")
    return RangePart(ByteRange(file // 2, offset, size, copy_of), skipped, part_size), place


def _varint(number: int) -> bytes:
    """Seven bits a byte, the lowest first, as in LEB128."""
    data = bytearray()
    while number > 0x7F:
        data.append(number & 0x7F | 0x80)
        number >>= 7
    data.append(number)
    return bytes(data)


def _varints(data: bytes, place: int, count: int) -> tuple[list[int], int]:
    numbers = []
    for _ in range(count):
        number, shift = 0, 0
        while True:
            byte = data[place]
            place += 1
            number |= (byte & 0x7F) << shift
            shift += 7
            if byte <= 0x7F:
                break
            if shift > 63:
                raise ValueError("a number that is too large")
        if number > MAX_FILE_BYTES:
            raise ValueError("a number that is too large")
        numbers.append(number)
    return numbers, place


def _incident_name(data: bytes) -> str:
    name = data[: 4 * _MAX_TEXT].decode("ascii", "replace")
    if len(data) > len(name) or not is_incident_name(name):
        raise LinkError(f"there is no incident {name!r:.80}")
    return name


def _listed(record: Mapping[str, object], robot: str) -> RemoteIncident:
    name = _text(record["name"])
    if not is_incident_name(name):
        raise ValueError("no name")
    missing = record["missing"]
    if not isinstance(missing, list):
        raise TypeError(missing)
    return RemoteIncident(
        robot=robot,
        name=name,
        label=_text(record["label"]),
        rule=_text(record["rule"]),
        triggered_ns=_whole(record["triggered_ns"]),
        from_ns=_whole(record["from_ns"]),
        to_ns=_whole(record["to_ns"]),
        messages=_whole(record["messages"]),
        size_bytes=_whole(record["size_bytes"]),
        is_read=record["read"] is True,
        missing=tuple(_text(one) for one in missing),
    )


def _file(name: object, size_bytes: object, sha256: object) -> PlannedFile:
    size, digest = _whole(size_bytes), _text(sha256)
    if not isinstance(name, str) or not is_incident_file_name(name):
        raise ValueError("no name of a file")
    if not 0 <= size <= MAX_FILE_BYTES or len(bytes.fromhex(digest)) != 32:
        raise ValueError("no size or digest of a file")
    return PlannedFile(name, size, digest)


def _level(end: object, rate_hz: object) -> Level:
    return Level(_whole(end), math.inf if rate_hz is None else _number(rate_hz))


def _number(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise TypeError(value)
    return float(value)


def _whole(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or abs(value) >= 2**63:
        raise TypeError(value)
    return value


def _text(value: object) -> str:
    if not isinstance(value, str) or len(value) > _MAX_TEXT:
        raise TypeError(value)
    return "".join(character if character.isprintable() else "?" for character in value)

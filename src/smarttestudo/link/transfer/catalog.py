# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents of a robot as its end of a link offers them: what there is, and their bytes in order."""

from __future__ import annotations

import hashlib
import os
import stat
import struct
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags import magic
from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_HEADER,
    CHUNK_START,
    FRAME,
    MESSAGE_HEADER,
    Op,
    RecordPlace,
    read_channel,
    record_places,
)
from smarttestudo.domain.errors import LinkError, RecordingError
from smarttestudo.domain.incident import RemoteIncident
from smarttestudo.files.input_file import sha256_of_files
from smarttestudo.incidents.store import READ_NAME, IncidentStore
from smarttestudo.link.transfer.messages import VERSION_BYTES, Content, WholeContent
from smarttestudo.link.transfer.order import ByteRange, MessageRange, TransferOrder
from smarttestudo.link.transfer.plan import (
    FILES,
    MAX_FILES,
    PLANS,
    PlannedFile,
    TransferPlan,
    is_incident_name,
    list_to_bytes,
    no_incident,
)

MAX_OPEN = 4
"""How many incidents may be fetched at once without their files being looked through again and again."""
_ORDER_VERSION = b"2"
_MAX_CHANNEL_BYTES = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentContent:
    """The bytes of an incident's files, in the order in which they travel."""

    plan: TransferPlan
    order: TransferOrder
    paths: tuple[Path, ...]
    is_urgent: bool = False

    @property
    def version(self) -> bytes:
        return self.plan.version

    @property
    def size_bytes(self) -> int:
        return self.order.size_bytes

    def read(self, offset: int, size_bytes: int) -> bytes:
        data = bytearray()
        with _errors_at(self.paths[0].parent.name if self.paths else ""), ExitStack() as stack:
            opened: dict[int, BinaryIO] = {}
            for stretch in self.order.stretches(offset, size_bytes):
                if isinstance(stretch, bytes):
                    data += stretch
                    continue
                file, start, size = stretch
                if file not in opened:
                    opened[file] = stack.enter_context(self.paths[file].open("rb"))
                found = os.pread(opened[file].fileno(), size, start)
                if len(found) != size:
                    raise LinkError("a file of the incident became shorter", place=self.paths[file].name)
                data += found
        return bytes(data)


class IncidentCatalog:
    """The incidents in ``folder``, for one thread."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._contents: dict[str, IncidentContent] = {}

    def open(self, name: str) -> Content:
        """The list of incidents under no name, the plan of one under its name, and its files' bytes.

        What was looked through lately is not looked through again. Raises ``LinkError``.
        """
        if not name:
            return _in_memory(list_to_bytes(self._list()))
        incident = name.removesuffix(FILES)
        content = self._content(incident)
        return content if incident != name else _in_memory(PLANS.to_bytes(content.plan))

    def _list(self) -> Sequence[RemoteIncident]:
        """The incidents whose records can be read, oldest first."""
        if not self._folder.is_dir():
            return []
        found = IncidentStore(self._folder).incidents()
        return [incident.listed() for incident in found if not isinstance(incident, RecordingError)]

    def _content(self, name: str) -> IncidentContent:
        known = self._contents.pop(name, None)
        if known is None or not all(path.exists() for path in known.paths):
            known = _content_of(self._folder, name)
            while len(self._contents) >= MAX_OPEN:
                del self._contents[next(iter(self._contents))]
        self._contents[name] = known
        return known


def _in_memory(data: bytes) -> WholeContent:
    return WholeContent(version=hashlib.sha256(data).digest()[:VERSION_BYTES], data=data)


def _content_of(folder: Path, name: str) -> IncidentContent:
    path = folder / name
    if not is_incident_name(name) or path.is_symlink() or not path.is_dir():
        raise no_incident(name)
    with _errors_at(name):
        files = [
            one for one in sorted(path.iterdir()) if one.name != READ_NAME and not one.name.startswith(".")
        ]
        files = [file for file in files if stat.S_ISREG(file.lstat().st_mode)]
        if not any(file.name == RECORD_NAME for file in files):
            raise LinkError(f"the incident has no {RECORD_NAME}: there is nothing to fetch", place=name)
        if len(files) > MAX_FILES:
            raise LinkError(f"{len(files)} files are too many for an incident", place=name)
        ranges = [file_ranges(one, number) for number, one in enumerate(files)]
        planned = tuple(PlannedFile(file.name, file.stat().st_size, sha256_of_files(file)) for file in files)
    order = TransferOrder(
        [one for each in ranges for one in each.head],
        [message for each in ranges for message in each.messages],
        [one for each in ranges for one in each.tail],
    )
    digest = hashlib.sha256(_ORDER_VERSION + repr(planned).encode()).digest()
    plan = TransferPlan(
        version=digest[:VERSION_BYTES], files=planned, levels=order.levels, order_bytes=order.size_bytes
    )
    if order.files_bytes != plan.size_bytes:
        raise LinkError("the files of the incident change while they are looked through", place=name)
    return IncidentContent(plan=plan, order=order, paths=tuple(files))


@contextmanager
def _errors_at(name: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        cause = f"the incident cannot be read: {error.strerror or error}"
        raise LinkError(cause, place=name, remedy="it may have been deleted to make room") from error


@dataclass(slots=True, kw_only=True)
class FileRanges:
    """All bytes of one file: the ``head`` makes it readable, the ``tail`` only faster to read."""

    head: list[ByteRange] = field(default_factory=list)
    messages: list[MessageRange] = field(default_factory=list)
    tail: list[ByteRange] = field(default_factory=list)


def file_ranges(path: Path, file: int) -> FileRanges:
    """The ranges of the file with that number; one of another origin is one range. Raises ``OSError``."""
    size_bytes = path.stat().st_size
    whole = FileRanges(head=[ByteRange(file, 0, size_bytes)])
    if path.suffix != ".mcap":
        return whole
    with path.open("rb") as opened:
        try:
            return _Index(opened, file, size_bytes).read()
        except (struct.error, ValueError):
            return FileRanges(tail=whole.head)


class _Index:
    """Walks over the records of one file; ``ValueError`` and ``struct.error`` where they do not fit."""

    def __init__(self, opened: BinaryIO, file: int, size_bytes: int) -> None:
        self._opened = opened
        self._file = file
        self._size_bytes = size_bytes
        self._topics: dict[int, str] = {}
        self._ranges = FileRanges()

    def read(self) -> FileRanges:
        if self._at(0, len(magic.MCAP)) != magic.MCAP:
            raise ValueError("not an mcap file")
        self._add(self._ranges.head, 0, len(magic.MCAP))
        at, end = len(magic.MCAP), self._size_bytes - len(magic.MCAP)
        chunk_end = at
        for place in record_places(self._opened, at, end, CHUNK_HEADER.size, enters_chunks=True):
            op, start, at, head = place
            if at > (chunk_end if start < chunk_end else end):
                raise ValueError("a record reaches beyond its chunk or the file")
            if start < chunk_end:
                self._note_message(place)
            elif op == Op.CHUNK:
                chunk_end, at = at, start + CHUNK_START.size
                *_, records_bytes, _, compression_bytes, stored_bytes = CHUNK_HEADER.unpack(head)
                if compression_bytes or not records_bytes == stored_bytes == chunk_end - at:
                    raise ValueError("a compressed chunk")
                self._add(self._ranges.head, start, CHUNK_START.size)
            else:
                self._add(self._ranges.head if op == Op.HEADER else self._ranges.tail, start, at - start)
        if at != end or self._at(end, len(magic.MCAP)) != magic.MCAP:
            raise ValueError("without an end")
        self._add(self._ranges.tail, end, len(magic.MCAP))
        return self._ranges

    def _note_message(self, place: RecordPlace) -> None:
        """Note a message, or what else is in a chunk."""
        op, start, end, head = place
        if op == Op.MESSAGE:
            number, _, stamp_ns, _ = MESSAGE_HEADER.unpack_from(head)
            topic = self._topics.get(number, "")
            self._ranges.messages.append(MessageRange(self._file, start, end - start, topic, stamp_ns))
            return
        if op == Op.CHUNK:
            raise ValueError("a chunk in a chunk")
        if op == Op.CHANNEL and end - start <= _MAX_CHANNEL_BYTES:
            content = start + FRAME.size
            number, channel = read_channel(self._at(content, end - content), {})
            self._topics[number] = channel.topic
        self._add(self._ranges.head, start, end - start)

    def _add(self, ranges: list[ByteRange], place: int, size_bytes: int) -> None:
        """Add a range; one that follows on the last joins it, unless it may be the same as elsewhere."""
        last = ranges[-1] if ranges else None
        if last is not None and last.offset + last.size_bytes == place and ranges is self._ranges.tail:
            ranges[-1] = ByteRange(self._file, last.offset, last.size_bytes + size_bytes)
        else:
            ranges.append(ByteRange(self._file, place, size_bytes))

    def _at(self, place: int, size_bytes: int) -> bytes:
        self._opened.seek(place)
        return self._opened.read(size_bytes)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses over a link, as JSON objects: each compressed by the one before, or alone for who asks."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Mapping

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.texts import in_utf_8
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.wire import HEAD_BYTES, Kind, Reader, frame, kind_of, malformed, varint

MAX_STATUS_BYTES = 1_000_000
"""How large the JSON of a status may be."""
_MAX_DEPTH = 16
_MAX_WAITING = 64
"""Changes that are kept for a full status which is under way; as many old ones are no sign of a loss."""
_MEASURED_AFTER_NS = NS_PER_S * 9 // 10
"""Measurements are sent once a second: a status may come a little early."""
_NUMBERS = frozenset({int, float})

Path = tuple[str | int, ...]
Record = Mapping[str, object]
IsMeasured = Callable[[Path], bool]
"""Whether what is at a path is worth a number a second at most."""
Compress = Callable[[bytes, bytes], bytes]
"""Makes the bytes small, given others that they are like."""
Decompress = Callable[[bytes, int, bytes], bytes]
"""Makes what was compressed by those others, of at most so many bytes. Raises ``LinkError``."""


class StatusSender:
    """One status after the other as it travels, and all of the last one with its ``number``."""

    def __init__(self, is_measured: IsMeasured, compress: Compress) -> None:
        self._is_measured = is_measured
        self._compress = compress
        self.number = 0
        self._record: object = None
        self._text = b""
        self._measured_ns: int | None = None

    def next(self, record: Record, now_ns: int) -> bytes:
        """The frame of ``record``, of which others received the one before."""
        if self._measured_ns is None or now_ns >= self._measured_ns + _MEASURED_AFTER_NS:
            self._measured_ns, self._record = now_ns, record
        else:
            self._record = self._held(self._record, record, ())
        text = in_utf_8(json_text(self._record, ascii_only=False, compact=True))
        before, self._text = self._text, text.encode()
        self.number += 1
        return frame(Kind.STATUS_CHANGES, varint(self.number) + self._compress(self._text, before))

    def full(self) -> bytes:
        """All of the last status, compressed. Raises ``LinkError`` before the first."""
        if not self.number:
            raise LinkError("there is no status yet", remedy="try again")
        return self._compress(self._text, b"")

    def _held(self, before: object, now: object, path: Path) -> object:
        """``now`` with what is measured as it was ``before``."""
        if isinstance(now, dict) and isinstance(before, dict):
            return {name: self._held(before.get(name), one, (*path, name)) for name, one in now.items()}
        if isinstance(now, list) and isinstance(before, list):
            old = [*before, *[None] * len(now)]
            return [self._held(old[place], one, (*path, place)) for place, one in enumerate(now)]
        is_kept = type(before) in _NUMBERS and type(now) in _NUMBERS and self._is_measured(path)
        return before if is_kept else now


class StatusReceiver:
    """Puts statuses together again; while ``needs_full``, a full one is to be asked for."""

    def __init__(self, decompress: Decompress) -> None:
        self.needs_full = True
        self._decompress = decompress
        self._number = 0
        self._text = b""
        self._waiting: dict[int, bytes] = {}

    def receive(self, data: bytes) -> Record | None:
        """The status that is whole with these changes, if one is. Raises ``LinkError`` for anything else."""
        kind, reader = kind_of(data), Reader(data, HEAD_BYTES)
        if kind != Kind.STATUS_CHANGES:
            raise malformed("no status")
        number, body = reader.varint(), reader.rest()
        # The first of all is a change of nothing.
        if number == self._number + 1 and (number == 1 or not self.needs_full):
            return self._apply(number, body)
        if self.needs_full or not 0 <= self._number - number < _MAX_WAITING:
            self.needs_full = True
            while len(self._waiting) >= _MAX_WAITING:
                del self._waiting[next(iter(self._waiting))]
            self._waiting[number] = body
        return None

    def receive_full(self, number: int, body: bytes) -> Record | None:
        """The status with this number, of which all was asked for, or one after it. Raises ``LinkError``."""
        if not self.needs_full and number <= self._number:
            return None
        record = self._read(number, body, b"")
        waiting, self._waiting = self._waiting, {}
        with contextlib.suppress(LinkError):
            while self._number + 1 in waiting:
                record = self._apply(self._number + 1, waiting[self._number + 1])
        return record

    def _apply(self, number: int, body: bytes) -> Record:
        try:
            return self._read(number, body, self._text)
        except LinkError:
            self.needs_full = True
            raise

    def _read(self, number: int, body: bytes, before: bytes) -> Record:
        text = self._decompress(body, MAX_STATUS_BYTES, before)
        try:
            record = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise malformed("a status that is not readable") from error
        if not isinstance(record, dict) or _is_deeper(record, _MAX_DEPTH):
            raise malformed("a status that is no object of a usual size")
        self._number, self._text, self.needs_full = number, text, False
        return record


def _is_deeper(value: object, most: int) -> bool:
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return most < 0 or any(_is_deeper(part, most - 1) for part in parts)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses over a link, as JSON objects: a full one first, then what changed since the one before."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Mapping
from typing import Any

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.leaf_changes import Leaf, changes_to_bytes, with_changes
from smarttestudo.link.protocol.wire import HEAD_BYTES, Kind, Reader, frame, kind_of, malformed, varint

MAX_STATUS_BYTES = 1_000_000
"""How large the JSON of a status may be."""
_MAX_LEAVES = 50_000
_MAX_DEPTH = 16
_MAX_WAITING = 64
"""Changes that are kept for a full status which is under way; as many old ones are no sign of a loss."""
_MEASURED_AFTER_NS = NS_PER_S * 9 // 10
"""What is measured is sent once a second: a status may come a little early."""
_NUMBERS = frozenset({int, float})
_SCALARS = _NUMBERS | {type(None), bool, str}
_PARTED = frozenset({dict, list})

Path = tuple[str | int, ...]
Record = Mapping[str, object]
IsMeasured = Callable[[Path], bool]
"""Whether what is at a path is worth a number a second at most."""


class StatusSender:
    """What travels of one status after the other. ``full`` may be asked for between two of them."""

    def __init__(self, is_measured: IsMeasured) -> None:
        self._is_measured = is_measured
        self._number = 0
        self._leaves: dict[Path, Leaf] = {}
        self._measured_ns: int | None = None

    def next(self, record: Record, now_ns: int) -> bytes:
        """What travels of ``record``, which others have received all of but for what is measured."""
        leaves = _leaves(record)
        is_like_before = [*leaves] == [*self._leaves]
        is_due = self._measured_ns is None or now_ns >= self._measured_ns + _MEASURED_AFTER_NS
        if is_due or not is_like_before:
            self._measured_ns = now_ns
        else:
            leaves = {path: self._held(path, leaf) for path, leaf in leaves.items()}
        before, self._leaves = self._leaves, leaves
        self._number += 1
        if is_like_before:
            changes = changes_to_bytes([*before.values()], [*leaves.values()])
            return frame(Kind.STATUS_CHANGES, varint(self._number) + changes)
        return self.full()

    def full(self) -> bytes:
        """All of the last status, for whoever has none yet. Raises ``LinkError`` before the first."""
        if not self._number:
            raise LinkError("there is no status yet", remedy="try again")
        text = json_text(_record(self._leaves), ascii_only=False, compact=True).encode()
        return frame(Kind.STATUS, varint(self._number) + text)

    def _held(self, path: Path, leaf: Leaf) -> Leaf:
        before = self._leaves[path]
        is_kept = type(before) in _NUMBERS and type(leaf) in _NUMBERS and self._is_measured(path)
        return before if is_kept else leaf


class StatusReceiver:
    """Puts statuses together again; while ``needs_full``, a full one is to be asked for."""

    def __init__(self) -> None:
        self.needs_full = True
        self._number = 0
        self._leaves: dict[Path, Leaf] = {}
        self._waiting: dict[int, bytes] = {}

    def receive(self, data: bytes) -> Record | None:
        """The status that is whole with ``data``, if one is. Raises ``LinkError`` for anything else."""
        kind, reader = kind_of(data), Reader(data, HEAD_BYTES)
        if kind not in (Kind.STATUS, Kind.STATUS_CHANGES):
            raise malformed("no status")
        number, body = reader.varint(), reader.rest()
        if kind == Kind.STATUS:
            return self._receive_full(number, body)
        if self.needs_full:
            self._keep(number, body)
            return None
        if number == self._number + 1:
            self._apply(number, body)
            return _record(self._leaves)
        if not 0 <= self._number - number < _MAX_WAITING:
            self.needs_full = True
            self._keep(number, body)
        return None

    def _keep(self, number: int, changes: bytes) -> None:
        while len(self._waiting) >= _MAX_WAITING:
            del self._waiting[next(iter(self._waiting))]
        self._waiting[number] = changes

    def _receive_full(self, number: int, data: bytes) -> Record | None:
        if not self.needs_full and number <= self._number:
            return None
        try:
            record = json.loads(data)
            leaves = _leaves(record)
        except (ValueError, RecursionError) as error:
            raise LinkError("a status is not readable") from error
        if not isinstance(record, dict) or len(leaves) > _MAX_LEAVES or len(data) > MAX_STATUS_BYTES:
            raise LinkError("a status is no object of a usual size")
        self._number, self._leaves, self.needs_full = number, leaves, False
        waiting, self._waiting = self._waiting, {}
        with contextlib.suppress(LinkError):
            while not self.needs_full and self._number + 1 in waiting:
                self._apply(self._number + 1, waiting[self._number + 1])
        return _record(self._leaves)

    def _apply(self, number: int, changes: bytes) -> None:
        try:
            leaves = with_changes([*self._leaves.values()], changes)
        except LinkError:
            self.needs_full = True
            raise
        self._leaves = dict(zip(self._leaves, leaves, strict=True))
        self._number = number


def _leaves(value: object) -> dict[Path, Leaf]:
    """What a JSON value consists of, in its order; an empty object or array is a leaf."""
    leaves: dict[Path, Leaf] = {}
    _collect(value, (), leaves)
    return leaves


def _collect(value: Any, path: Path, leaves: dict[Path, Leaf]) -> None:
    kind = type(value)
    if kind in _SCALARS or (kind in _PARTED and not value):
        leaves[path] = value
    elif kind not in _PARTED or len(path) == _MAX_DEPTH:
        raise ValueError(f"{kind.__name__} is nothing of JSON, or nested too deeply")
    else:
        for step, entry in value.items() if kind is dict else enumerate(value):
            _collect(entry, (*path, step), leaves)


def _record(leaves: Mapping[Path, Leaf]) -> Record:
    root: dict[str | int, object] = {}
    for path, leaf in leaves.items():
        place = root
        for step in path[:-1]:
            place = place.setdefault(step, {})  # type: ignore[assignment]  # leaves are at ends of paths only
        if path:
            place[path[-1]] = leaf
    whole = _with_arrays(root)
    return whole if isinstance(whole, dict) else {}


def _with_arrays(value: object) -> object:
    """``value`` with arrays where the steps are numbers."""
    if not isinstance(value, dict):
        return value
    entries = {step: _with_arrays(entry) for step, entry in value.items()}
    return [*entries.values()] if entries and all(isinstance(step, int) for step in entries) else entries

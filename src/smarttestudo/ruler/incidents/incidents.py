# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents in the project: what rules recorded, on a robot or from a recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from msgspec import Struct

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.incident import IncidentRecord, RemoteIncident
from smarttestudo.files.zip_stream import zip_pieces
from smarttestudo.incidents.store import IncidentStore, StoredIncident
from smarttestudo.language.properties import property_spec
from smarttestudo.ruler.files.project_folder import FileKind, MissingFileError, ProjectFolder

MAX_INCIDENTS = 500


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedIncident:
    """A folder with an incident, by its ``name`` in the project.

    ``problem`` is why it cannot be read, and ``incident`` null then.
    """

    name: str
    size_bytes: int
    problem: str
    incident: RemoteIncident | None


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentsAnswer:
    """``GET /api/incidents``: the newest first; ``has_more`` is whether older ones are left out."""

    incidents: tuple[ListedIncident, ...]
    has_more: bool


class OneIncidentRequest(Struct, frozen=True, kw_only=True):
    """An incident by its name in the project."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentAnswer:
    """``POST /api/incident``: its record, and the units of the values in that, where they are known.

    ``rule_file`` is the project's file of the name that the robot had the rule in, null where it has none,
    and ``is_same_text`` whether that holds the same text as then.
    """

    name: str
    size_bytes: int
    record: IncidentRecord
    units: Mapping[str, str]
    rule_file: str | None
    is_same_text: bool


class KnownIncidents:
    """The incidents of ``folder``; nothing outside it is read or deleted."""

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder

    def incidents(self) -> IncidentsAnswer:
        """All incidents; one that cannot be read costs only itself."""
        names, has_more = self._folder.folders_with(RECORD_NAME)
        # Their names begin with the time.
        names.sort(key=lambda name: PurePosixPath(name).name, reverse=True)
        return IncidentsAnswer(
            incidents=tuple(self._listed(names[:MAX_INCIDENTS])),
            has_more=has_more or len(names) > MAX_INCIDENTS,
        )

    def incident(self, request: OneIncidentRequest) -> IncidentAnswer:
        """One incident."""
        store, last = self._store(request.name)
        return self._answer(request.name, store.incident(last))

    def mark_read(self, request: OneIncidentRequest) -> None:
        """Somebody who may delete it has read an incident."""
        store, last = self._store(request.name)
        store.mark_read(last)

    def delete(self, request: OneIncidentRequest) -> IncidentsAnswer:
        """Delete one; what is left. Raises ``RecordingError`` where its folder holds something else, too."""
        store, last = self._store(request.name)
        store.delete(last)
        return self.incidents()

    def bag(self, name: str) -> Path:
        """The folder of an incident, which is a bag."""
        store, last = self._store(name)
        store.incident(last)
        return self._folder.bag(name)

    def zipped(self, name: str) -> tuple[str, Iterator[bytes]]:
        """A name without blanks and slashes, and the pieces of a .zip with all files of an incident."""
        store, last = self._store(name)
        return last, zip_pieces(store.files(last), last)

    def _listed(self, names: list[str]) -> Iterator[ListedIncident]:
        for name in names:
            size_bytes = 0
            try:
                store, last = self._store(name)
                size_bytes = store.size_bytes(last)
                stored = store.incident(last)
            except TestudoError as error:
                problem = told_of_listed(error)
                yield ListedIncident(name=name, size_bytes=size_bytes, problem=problem, incident=None)
            else:
                listed = stored.listed()
                yield ListedIncident(name=name, size_bytes=size_bytes, problem="", incident=listed)

    def _store(self, name: str) -> tuple[IncidentStore, str]:
        path = self._folder.path(name)
        # A link is a record that cannot be read, not a folder without one.
        if not (path / RECORD_NAME).is_symlink() and not (path / RECORD_NAME).exists():
            raise MissingFileError("there is no such incident in the project", place=name)
        return IncidentStore(path.parent), path.name

    def _answer(self, name: str, stored: StoredIncident) -> IncidentAnswer:
        record = stored.record
        rule_file = self._rule_file(record.path)
        return IncidentAnswer(
            name=name,
            size_bytes=stored.size_bytes,
            record=record,
            units=dict(_units(record)),
            rule_file=rule_file,
            is_same_text=rule_file is not None and self._sha256(rule_file) == record.rules_sha256,
        )

    def _rule_file(self, path: str) -> str | None:
        """The rule file of the project that ends most like ``path``; ``None`` without one of that name."""
        parts = PurePosixPath(path).parts[::-1]
        files, _ = self._folder.files()
        alike = {
            one.name: _common(parts, PurePosixPath(one.name).parts[::-1])
            for one in files
            if one.kind is FileKind.RULES
        }
        best = max(alike, key=lambda name: alike[name], default=None)
        return best if best is not None and alike[best] else None

    def _sha256(self, name: str) -> str | None:
        try:
            return self._folder.read(name).sha256
        except TestudoError:
            # Who opens it is told what is wrong with it.
            return None


def _common(one: tuple[str, ...], other: tuple[str, ...]) -> int:
    """How many parts are the same, from the first on."""
    differing = (at for at, (a, b) in enumerate(zip(one, other, strict=False)) if a != b)
    return next(differing, min(len(one), len(other)))


def told_of_listed(error: TestudoError) -> str:
    """Cause and remedy; the list says already of what."""
    return "; ".join(filter(None, (error.cause, error.remedy)))


def _units(record: IncidentRecord) -> Iterator[tuple[str, str]]:
    for signal in record.values:
        topic, _, name = signal.partition(" ")
        type_name = record.topics[topic].type_name if topic in record.topics else None
        if (spec := property_spec(type_name, name)) is not None:
            yield signal, spec.unit

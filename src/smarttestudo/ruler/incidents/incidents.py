# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents in the project: what rules recorded, on a robot or from a recording."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath

from msgspec import Struct

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.incident_record import RECORD_NAME, read_record
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.robot_path import PathReader, notice_of_unknown, places_in
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.incident import IncidentRecord, RemoteIncident
from smarttestudo.domain.names import is_source
from smarttestudo.domain.recording import Channel, RecordingReader
from smarttestudo.domain.units import NS_PER_S, counted
from smarttestudo.files.zip_stream import zip_pieces
from smarttestudo.incidents.store import IncidentStore, StoredIncident
from smarttestudo.language.properties import property_spec
from smarttestudo.pacing.coded_video import IMAGE_TYPES, is_coded_video
from smarttestudo.ruler.files.project_folder import FileKind, MissingFileError, ProjectFolder
from smarttestudo.ruler.files.recordings import READING
from smarttestudo.ruler.job import Download, Permission, Report, job

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
    """Incidents, the newest first; ``has_more`` is whether older ones are left out."""

    incidents: tuple[ListedIncident, ...]
    has_more: bool


class OneIncidentRequest(Struct, frozen=True, kw_only=True):
    """An incident by its name in the project."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentAnswer:
    """The record of an incident, and the units of the values in that, where they are known.

    ``rule_file`` is the project's file of the name that the robot had the rule in, null where it has none,
    and ``is_same_text`` whether that holds the same text as then.
    """

    name: str
    size_bytes: int
    record: IncidentRecord
    units: Mapping[str, str]
    rule_file: str | None
    is_same_text: bool


@job("GET /api/incidents")
def incidents(folder: ProjectFolder) -> IncidentsAnswer:
    """All incidents; one that cannot be read costs only itself."""
    names, has_more = folder.folders_with(RECORD_NAME)
    # Their names begin with the time.
    names.sort(key=lambda name: PurePosixPath(name).name, reverse=True)
    return IncidentsAnswer(
        incidents=tuple(_listed(folder, names[:MAX_INCIDENTS])),
        has_more=has_more or len(names) > MAX_INCIDENTS,
    )


@job("POST /api/incident", reads=True)
def incident(request: OneIncidentRequest, folder: ProjectFolder, permission: Permission) -> IncidentAnswer:
    """One incident, which somebody who may delete it has read now."""
    store, last = _store(folder, request.name)
    answer = _answer(folder, request.name, store.incident(last))
    if permission is Permission.CHANGE:
        store.mark_read(last)
    return answer


@job("POST /api/incident/delete")
def delete(request: OneIncidentRequest, folder: ProjectFolder) -> IncidentsAnswer:
    """Delete one; what is left. Raises ``RecordingError`` where its folder holds something else, too."""
    store, last = _store(folder, request.name)
    store.delete(last)
    return incidents(folder)


@job("GET /api/incident/zip")
def zipped(name: str, folder: ProjectFolder) -> Download:
    """All files of an incident."""
    store, last = _store(folder, name)
    return Download(name=last, pieces=zip_pieces(store.files(last), last))


def _listed(folder: ProjectFolder, names: list[str]) -> Iterator[ListedIncident]:
    for name in names:
        size_bytes = 0
        try:
            store, last = _store(folder, name)
            size_bytes = store.size_bytes(last)
            stored = store.incident(last)
        except TestudoError as error:
            problem = told_of_listed(error)
            yield ListedIncident(name=name, size_bytes=size_bytes, problem=problem, incident=None)
        else:
            yield ListedIncident(name=name, size_bytes=size_bytes, problem="", incident=stored.listed())


def stored_incident(folder: ProjectFolder, name: str) -> StoredIncident:
    """The incident. Raises ``TestudoError`` where it is none, or cannot be read."""
    store, last = _store(folder, name)
    return store.incident(last)


def _store(folder: ProjectFolder, name: str) -> tuple[IncidentStore, str]:
    """The store of an incident by its name in the project, and its name there.

    Raises ``MissingFileError`` where there is none.
    """
    path = folder.path(name)
    # A link is a record that cannot be read, not a folder without one.
    if not (path / RECORD_NAME).is_symlink() and not (path / RECORD_NAME).exists():
        raise MissingFileError("there is no such incident in the project", place=name)
    return IncidentStore(path.parent), path.name


def _answer(folder: ProjectFolder, name: str, stored: StoredIncident) -> IncidentAnswer:
    record = stored.record
    rule_file = _rule_file(folder, record.path)
    return IncidentAnswer(
        name=name,
        size_bytes=stored.size_bytes,
        record=record,
        units=dict(_units(record)),
        rule_file=rule_file,
        is_same_text=rule_file is not None and _sha256(folder, rule_file) == record.rules_sha256,
    )


def _rule_file(folder: ProjectFolder, path: str) -> str | None:
    """The rule file of the project that ends most like ``path``; ``None`` without one of that name."""
    parts = PurePosixPath(path).parts[::-1]
    files, _ = folder.files()
    alike = {
        one.name: _common(parts, PurePosixPath(one.name).parts[::-1])
        for one in files
        if one.kind is FileKind.RULES
    }
    best = max(alike, key=lambda name: alike[name], default=None)
    return best if best is not None and alike[best] else None


def _sha256(folder: ProjectFolder, name: str) -> str | None:
    try:
        return folder.read(name).sha256
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
        if is_source(topic):
            type_name = topic
        if (spec := property_spec(type_name, name)) is not None:
            yield signal, spec.unit


MAX_FRAMES = 300
MAX_POINTS = 1000
_HEAD_BYTES = 16_384


class IncidentCourseRequest(Struct, frozen=True, kw_only=True):
    """An incident by its name in the project; ``run`` names the job in ``Progress`` of ``/ws``."""

    name: str
    run: str = ""


class CameraFrames(Struct, frozen=True, kw_only=True):
    """The frames of a camera's topic, at most 300: when each arrived, and its number in the incident."""

    topic: str
    times_s: tuple[float, ...]
    numbers: tuple[int, ...]


class IncidentCourse(Struct, frozen=True, kw_only=True):
    """Content of an incident over time, in seconds since the window's start; the trigger is at ``trigger_s``.

    ``path`` is ``[seconds, x, y]`` in metres where a topic says where the robot was. ``notices`` say what
    could not be read.
    """

    duration_s: float
    trigger_s: float
    cameras: tuple[CameraFrames, ...]
    path: tuple[tuple[float, float, float], ...]
    notices: tuple[str, ...]


@job("POST /api/incident/course", reads=True, limit=READING)
def incident_course(request: IncidentCourseRequest, project: ProjectFolder, report: Report) -> IncidentCourse:
    """Read the messages of an incident; ``RecordingError`` where record or recording cannot be read."""
    stored_incident(project, request.name)
    folder = project.bag(request.name)
    record = read_record(folder)
    with open_recording(folder) as recording:
        reading = _Reading(record, recording)
        expected = max(1, sum(one.messages for one in record.topics.values()))
        for done, (channel, stamp_ns, (size_bytes, head)) in enumerate(recording.heads(_HEAD_BYTES)):
            reading.on_message(channel, stamp_ns, head if size_bytes == len(head) else None)
            report(min(done / expected, 1.0))
        notices = (*map(project.shown, recording.notices()), *reading.notices())
    return IncidentCourse(
        duration_s=(record.to_ns - record.from_ns) / NS_PER_S,
        trigger_s=(record.triggered_ns - record.from_ns) / NS_PER_S,
        cameras=tuple(reading.cameras()),
        path=reading.path,
        notices=notices,
    )


class _Reading:
    """Lists the frames of an incident, and follows the robot."""

    def __init__(self, record: IncidentRecord, recording: RecordingReader) -> None:
        self._record = record
        self._frames: dict[str, list[float | None]] = {
            channel.topic: []
            for channel in recording.channels
            # Coded video is listed, though it is not shown.
            if channel.type_name in IMAGE_TYPES or is_coded_video(channel.type_name)
        }
        self._outside = 0
        self._unknown: Counter[str] = Counter()
        self._places: PathReader | None = places_in(
            recording.channels, RosbagDecoder(), record.from_ns, by_transforms=False
        )

    @property
    def path(self) -> tuple[tuple[float, float, float], ...]:
        """Where the robot was in the window."""
        points = [] if self._places is None else list(self._places.path)
        step = -(-len(points) // MAX_POINTS) or 1
        known = ((point.t_s, point.x_m, point.y_m) for point in points[::step])
        return tuple(point for point in known if all(map(math.isfinite, point)))

    def cameras(self) -> Iterator[CameraFrames]:
        """The frames within the window, of many every second, third and so on."""
        for topic, times_s in sorted(self._frames.items()):
            known = [(time_s, number) for number, time_s in enumerate(times_s) if time_s is not None]
            some = known[:: -(-len(known) // MAX_FRAMES) or 1]
            yield CameraFrames(
                topic=topic,
                times_s=tuple(time_s for time_s, _ in some),
                numbers=tuple(number for _, number in some),
            )

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes | None) -> None:
        """The next message; of a large one without its payload."""
        is_within = self._record.from_ns <= stamp_ns <= self._record.to_ns
        if channel.topic in self._frames:
            time_s = (stamp_ns - self._record.from_ns) / NS_PER_S if is_within else None
            self._frames[channel.topic].append(time_s)
        if not is_within:
            self._outside += 1
        elif self._places is not None and payload is not None:
            try:
                self._places.on_message(channel, stamp_ns, payload)
            except RecordingError as error:
                self._unknown[error.cause] += 1

    def notices(self) -> Iterator[str]:
        """Notices of what is left out."""
        if self._outside:
            outside = counted(self._outside, "message")
            yield f"the clock jumped: not shown, because outside the window: {outside}"
        yield from notice_of_unknown(self._unknown)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents in the project: what rules recorded, on a robot or from a recording."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from msgspec import Struct

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.incident_record import RECORD_NAME, read_record
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.robot_path import PathReader, notice_of_unknown, places_in
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.incident import IncidentRecord, Missing, MissingReason, RemoteIncident
from smarttestudo.domain.names import is_source
from smarttestudo.domain.recording import Channel, RecordingReader
from smarttestudo.domain.units import NS_PER_S, counted
from smarttestudo.files.zip_stream import zip_pieces
from smarttestudo.incidents.store import IncidentStore, StoredIncident
from smarttestudo.language.properties import property_spec
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


def _store(folder: ProjectFolder, name: str) -> tuple[IncidentStore, str]:
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


MAX_BINS = 300
MAX_POINTS = 1000
_FEW_BINS = 5
_NARROWEST_BIN_NS = NS_PER_S // 5
# The rate in less than half a bin says nothing.
_LEAST_SHARE = 0.5
_HEAD_BYTES = 16_384
# Nothing of such a time is there, so that its rate is not 0, but unknown.
_UNHEARD = frozenset(
    {
        MissingReason.MEMORY,
        MissingReason.LATE,
        MissingReason.UNPUBLISHED,
        MissingReason.ENDED,
        MissingReason.KILLED,
    }
)


class IncidentCourseRequest(Struct, frozen=True, kw_only=True):
    """An incident by its name in the project; ``run`` names the job in ``Progress`` of ``/ws``."""

    name: str
    run: str = ""


class TopicRates(Struct, frozen=True, kw_only=True):
    """Messages a second of a topic, bin by bin; null where less than half of one is known."""

    topic: str
    hz_bins: tuple[float | None, ...]


class IncidentCourse(Struct, frozen=True, kw_only=True):
    """Content of an incident over time, in seconds since the window's start; the trigger is at ``trigger_s``.

    Bins are ``bin_s`` long, the first begins at ``first_bin_s``, 0 or less, and one begins at the trigger.
    ``path`` is ``[seconds, x, y]`` in metres where a topic says where the robot was. ``notices`` say what
    could not be read.
    """

    duration_s: float
    trigger_s: float
    bin_s: float
    first_bin_s: float
    topics: tuple[TopicRates, ...]
    path: tuple[tuple[float, float, float], ...]
    notices: tuple[str, ...]


@job("POST /api/incident/course", reads=True, limit=READING)
def incident_course(request: IncidentCourseRequest, project: ProjectFolder, report: Report) -> IncidentCourse:
    """Read the messages of an incident; ``RecordingError`` where record or recording cannot be read."""
    store, last = _store(project, request.name)
    store.incident(last)
    folder = project.bag(request.name)
    record = read_record(folder)
    bins = _WindowBins(record)
    with open_recording(folder) as recording:
        reading = _Reading(record, bins, recording)
        expected = max(1, sum(one.messages for one in record.topics.values()))
        for done, (channel, stamp_ns, (size_bytes, head)) in enumerate(recording.heads(_HEAD_BYTES)):
            reading.on_message(channel, stamp_ns, head if size_bytes == len(head) else None)
            report(min(done / expected, 1.0))
        notices = (*map(project.shown, recording.notices()), *reading.notices())
    unheard: dict[str, list[Missing]] = {}
    for one in record.missing:
        if one.reason in _UNHEARD:
            unheard.setdefault(one.topic, []).append(one)
    return IncidentCourse(
        duration_s=(record.to_ns - record.from_ns) / NS_PER_S,
        trigger_s=(record.triggered_ns - record.from_ns) / NS_PER_S,
        bin_s=bins.width_ns / NS_PER_S,
        first_bin_s=(bins.first_ns - record.from_ns) / NS_PER_S,
        topics=tuple(
            TopicRates(topic=topic, hz_bins=bins.rates_hz(counts, unheard.get(topic, ())))
            for topic, counts in reading.messages.items()
        ),
        path=reading.path,
        notices=notices,
    )


class _WindowBins:
    """Equal stretches of an incident's window, one of which begins at the trigger."""

    def __init__(self, record: IncidentRecord) -> None:
        self._from_ns, self._to_ns = record.from_ns, record.to_ns
        before_ns, after_ns = record.triggered_ns - record.from_ns, record.to_ns - record.triggered_ns
        window_ns = before_ns + after_ns
        usual_ns = min(max(window_ns // _FEW_BINS, _NARROWEST_BIN_NS), NS_PER_S)
        self.width_ns = max(usual_ns, -(-window_ns // (MAX_BINS - 2)))
        earlier = -(-before_ns // self.width_ns)
        self.first_ns = record.triggered_ns - earlier * self.width_ns
        self.count = max(earlier + -(-after_ns // self.width_ns), 1)

    def at(self, stamp_ns: int) -> int | None:
        """Which one holds ``stamp_ns``, the last one also the window's end; ``None`` outside the window."""
        if not self._from_ns <= stamp_ns <= self._to_ns:
            return None
        return min((stamp_ns - self.first_ns) // self.width_ns, self.count - 1)

    def rates_hz(self, counts: list[int], unknown: Sequence[Missing]) -> tuple[float | None, ...]:
        """Messages a second of the time that is known of each."""
        rates: list[float | None] = []
        for bin_, count in enumerate(counts):
            start_ns = self.first_ns + bin_ * self.width_ns
            from_ns, to_ns = max(start_ns, self._from_ns), min(start_ns + self.width_ns, self._to_ns)
            gaps_ns = (min(to_ns, gap.to_ns) - max(from_ns, gap.from_ns) for gap in unknown)
            known_ns = to_ns - from_ns - sum(gap_ns for gap_ns in gaps_ns if gap_ns > 0)
            is_half = known_ns >= _LEAST_SHARE * self.width_ns
            rates.append(count * NS_PER_S / known_ns if is_half else None)
        return tuple(rates)


class _Reading:
    """Counts the messages of an incident, and follows the robot."""

    def __init__(self, record: IncidentRecord, bins: _WindowBins, recording: RecordingReader) -> None:
        self._record = record
        self._bins = bins
        topics = sorted({*record.topics, *(channel.topic for channel in recording.channels)})
        self.messages = {topic: [0] * bins.count for topic in topics}
        self._latched = {one.topic for one in record.latched}
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

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes | None) -> None:
        """The next message; of a large one without its payload."""
        bin_ = self._bins.at(stamp_ns)
        if bin_ is None:
            self._outside += 1
            return
        # What came before the window has the stamp of its start, and is no message of that second.
        if stamp_ns > self._record.from_ns or channel.topic not in self._latched:
            self.messages[channel.topic][bin_] += 1
        if self._places is None or payload is None:
            return
        try:
            self._places.on_message(channel, stamp_ns, payload)
        except RecordingError as error:
            self._unknown[error.cause] += 1

    def notices(self) -> Iterator[str]:
        """Notices of what is left out of the charts and of the path."""
        if self._outside:
            outside = counted(self._outside, "message")
            yield f"the clock jumped: not in the charts, because outside the window: {outside}"
        yield from notice_of_unknown(self._unknown)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records of incidents, as JSON, too, and the incidents that robots hold."""

from __future__ import annotations

import json
import re
import sys
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta, timezone
from enum import Enum
from pathlib import Path
from typing import Annotated, Protocol

from smarttestudo.domain.errors import LinkError, RecordingError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.metric import Metered, MetricKind
from smarttestudo.domain.record import AtMost, JsonEntry, derived, from_json, to_json
from smarttestudo.domain.signal import Value
from smarttestudo.domain.units import LAST_STAMP_NS, NS_PER_MS, utc_time

DEFAULT_INCIDENT_MEMORY_MB = 256
"""How much of the past is kept in memory for recordings, unless told otherwise."""

DEFAULT_INCIDENT_RING_MAX_GB = 5
"""How much disk what does not fit into memory may take, unless told otherwise."""

INCIDENT_VERSION = 1
MAX_FURTHER_MOMENTS = 999
_MAX_FURTHER_VALUES = 5_000
"""How many values of further moments a record lists: it stays below the size that is read."""
_MAX_NAME_CHARACTERS = 60
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9_-]+")
_FOLDER_NAME = re.compile(r"(\d+T\d{9}Z|-?\d+ns)-[A-Za-z0-9_-]+\Z", re.ASCII)
_Whole = Annotated[int, AtMost(LAST_STAMP_NS)]
_Finite = Annotated[float, AtMost(sys.float_info.max)]
_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


class MissingReason(Enum):
    """Why messages of a window are not in the incident."""

    MEMORY = "memory"
    """They were given up when memory, and the ring on disk if there is one, had no room for them."""

    LATE = "late"
    """The topic was not yet heard, or the recording not yet begun."""

    UNPUBLISHED = "unpublished"
    """Nobody publishes the topic."""

    ENDED = "ended"
    """The run or the recording ended before the window did."""

    LOST = "lost"
    """The middleware lost them: machine or network were too slow, or their sender lacked shared memory."""

    DISK = "disk"
    """They arrived faster than the disk could take them, or while it was full."""

    KILLED = "killed"
    """The run was killed; what there is was completed by the next one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Missing:
    """Messages of ``topic`` that are not there, between two stamps; ``messages`` is ``None`` if unknown."""

    topic: str
    reason: MissingReason
    messages: _Whole | None
    from_ns: _Whole
    to_ns: _Whole


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentTopic:
    """Content of an incident for one topic."""

    type_name: Annotated[str, JsonEntry(name="type")]
    messages: _Whole
    size_bytes: Annotated[_Whole, JsonEntry(name="bytes")]


@dataclass(frozen=True, slots=True, kw_only=True)
class LatchedSample:
    """A message from before the window that still counted in it; ``stamp_ns`` is when it arrived.

    In the incident it has the stamp of the window's start.
    """

    topic: str
    stamp_ns: _Whole


@dataclass(frozen=True, slots=True, kw_only=True)
class FurtherMoment:
    """A moment after the first at which the rule began to hold, and what its condition read."""

    triggered_ns: _Whole
    values: Annotated[Mapping[str, _Finite | str | None], JsonEntry(has_infinite=True)]

    @property
    @derived()
    def time(self) -> str:
        """That moment in UTC."""
        return utc_time(self.triggered_ns)


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentRecord:
    """Which rule recorded what, when, and what is missing.

    ``rule`` is the label of the block, in line ``line`` of the file ``path``; ``values`` are what its
    condition read. Stamps are the clock's, ``rules_sha256`` is that of the texts of all rules.
    It began to hold at so many ``moments`` of the incident; of a great many, not all are in
    ``further_moments``.
    """

    name: str
    rule: str
    path: Annotated[str, JsonEntry(name="file")]
    line: _Whole
    triggered_ns: _Whole
    from_ns: _Whole
    to_ns: _Whole
    values: Annotated[Mapping[str, _Finite | str | None], JsonEntry(has_infinite=True)]
    rules_sha256: str
    topics: Mapping[str, IncidentTopic]
    latched: tuple[LatchedSample, ...] = ()
    missing: tuple[Missing, ...] = ()
    moments: Annotated[_Whole, JsonEntry(omits_default=True)] = 1
    further_moments: Annotated[tuple[FurtherMoment, ...], JsonEntry(omits_default=True)] = ()

    def extended(self, triggered_ns: int, values: Mapping[str, Value | None], to_ns: int) -> IncidentRecord:
        """The record of an incident with one moment more, whose window is open until ``to_ns``."""
        further = self.further_moments
        listed = sum(map(_size, (*(moment.values for moment in further), values)))
        if len(further) < MAX_FURTHER_MOMENTS and listed <= _MAX_FURTHER_VALUES:
            further = (*further, FurtherMoment(triggered_ns=triggered_ns, values=values))
        return replace(self, to_ns=to_ns, moments=self.moments + 1, further_moments=further)


_CHARACTERS_OF_VALUE = 32


def _size(values: Mapping[str, Value | None]) -> int:
    """How many values they count as; a long text is as many as it takes the place of."""
    texts = sum(len(value) for value in values.values() if isinstance(value, str))
    return len(values) + texts // _CHARACTERS_OF_VALUE


def incident_folder_name(name: str, stamp_ns: int) -> str:
    """When it happened and what it is called, as the name of a folder: ``20260102T030405678Z-near_miss``.

    Whatever ``name`` is, the result holds letters, digits, ``_`` and ``-`` only and has at most 80 of them.
    """
    plain = (
        unicodedata.normalize("NFKD", name[: 10 * _MAX_NAME_CHARACTERS]).encode("ascii", "ignore").decode()
    )
    slug = _NOT_IN_NAMES.sub("_", plain).strip("_-")[:_MAX_NAME_CHARACTERS]
    milliseconds = stamp_ns // NS_PER_MS
    try:
        time = f"{_EPOCH + timedelta(milliseconds=milliseconds):%Y%m%dT%H%M%S}{milliseconds % 1000:03}Z"
    except OverflowError:
        time = f"{stamp_ns}ns"
    return f"{time}-{slug or 'incident'}"


def is_incident_folder_name(name: str) -> bool:
    return _FOLDER_NAME.match(name) is not None


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentState:
    """Cost of recording on a running robot, and its results so far.

    ``held_bytes`` of at most ``memory_bytes`` are kept of ``topics`` topics for what may happen, and
    ``ring_bytes`` of at most ``ring_max_bytes`` on disk, which is ``None`` if memory is all there is.
    Incidents are ``open`` now, were ``recorded`` whole, or ``failed`` since the start; ``problem`` says why
    the last one could not be written, until the next one can. Of their messages, ``dropped`` arrived faster
    than the disk took them, and so many are ``missing`` in those that ended, whatever the reason. At so many
    ``further_moments`` a rule began to hold again and extended its incident.
    """

    held_bytes: Annotated[
        int, Metered("incident_memory", "bytes", "Memory that is held for what may happen.")
    ]
    memory_bytes: int
    topics: int
    open: Annotated[int, Metered("open", "incidents", "Incidents that are being recorded.")] = 0
    recorded: Annotated[
        int, Metered("recorded", "incidents", "Incidents that were recorded whole.", MetricKind.COUNTER)
    ] = 0
    failed: Annotated[
        int,
        Metered("failed", "incidents", "Incidents that were not recorded, or end early.", MetricKind.COUNTER),
    ] = 0
    problem: str | None = None
    ring_bytes: Annotated[
        int, Metered("incident_ring", "bytes", "Disk that is held for what may happen.")
    ] = 0
    ring_max_bytes: int | None = None
    dropped: Annotated[
        int,
        JsonEntry(is_lenient=True, omits_default=True),
        Metered(
            "incident_dropped",
            "messages",
            "Messages for incidents that came faster than the disk took them.",
            MetricKind.COUNTER,
        ),
    ] = 0
    missing: Annotated[
        int,
        JsonEntry(is_lenient=True, omits_default=True),
        Metered(
            "incident_missing",
            "messages",
            "Messages that are missing in the incidents that ended, as far as they were counted.",
            MetricKind.COUNTER,
        ),
    ] = 0
    further_moments: Annotated[
        int,
        JsonEntry(is_lenient=True, omits_default=True),
        Metered(
            "extended",
            "incidents",
            "How often a rule began to hold again and extended its incident.",
            MetricKind.COUNTER,
        ),
    ] = 0


MAX_RECORD_BYTES = 4_000_000


def incident_to_json(incident: IncidentRecord) -> dict[str, object]:
    """The object in ``incident.json``; times that end in ``_ns`` count from 1970."""
    return {"version": INCIDENT_VERSION, "time": utc_time(incident.triggered_ns), **to_json(incident)}


def incident_text(incident: IncidentRecord) -> str:
    return f"{json_text(incident_to_json(incident), indent=2)}\n"


def read_incident(text: bytes, place: str) -> IncidentRecord:
    """The record that ``incident.json`` at ``place`` holds.

    Raises ``RecordingError`` for a text that is cut, edited or of another version.
    """
    try:
        found = json.loads(text)
        if isinstance(found, dict) and (version := found.get("version")) != INCIDENT_VERSION:
            raise RecordingError(
                f"version {str(version)[:20]} of an incident is not known",
                place=place,
                remedy="read it with the SmartTestudo that wrote it",
            )
        return _checked(from_json(IncidentRecord, found))
    except (ValueError, RecursionError) as error:
        raise RecordingError(
            "does not hold the record of an incident", place=place, remedy="was it cut or edited?"
        ) from error


def _checked(incident: IncidentRecord) -> IncidentRecord:
    if not incident.from_ns <= incident.triggered_ns <= incident.to_ns:
        raise ValueError(incident.triggered_ns)
    if incident.moments <= len(incident.further_moments):
        raise ValueError(incident.moments)
    return incident


OUTAGE_NAME = "outage"
OUTAGE_RULE = "(link)"
"""What stands in the place of a rule's name where the link's outage was the reason."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RemoteIncident:
    """An incident on a robot, as its list says; ``name`` is that of its folder.

    ``label`` is the name in the ``Record``, ``rule`` that of the block. Stamps are the robot's clock.
    It began to hold at so many ``moments``, the first at ``triggered_ns``. ``missing`` are the reasons
    (``MissingReason``) for which messages of the window are not there.
    """

    robot: str
    name: str
    label: str
    rule: str
    triggered_ns: int
    from_ns: int
    to_ns: int
    messages: int
    size_bytes: int
    is_read: bool = False
    missing: tuple[str, ...] = ()
    moments: int = 1

    @property
    def is_outage(self) -> bool:
        """Whether it holds what could not be sent during an outage."""
        return (self.label, self.rule) == (OUTAGE_NAME, OUTAGE_RULE)


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchProgress:
    """How far a fetch is: ``got_bytes`` of ``total_bytes``, those of earlier attempts included.

    ``level_hz`` is the grid of the skeleton that is whole for all topics of small messages: 1, 2, 4 … Hz;
    ``None`` before the first, infinite once all of their messages are there, so that large ones remain.
    ``rate_bytes_per_s`` is that of the last seconds; ``waits_for`` says why nothing comes, where that is so.
    """

    got_bytes: int
    total_bytes: int
    rate_bytes_per_s: float = 0.0
    level_hz: float | None = None
    waits_for: str | None = None


class SilentRobotError(LinkError):
    """A robot is connected and does not answer: it has no incidents to offer, or is still starting."""


OnProgress = Callable[[FetchProgress], None]
"""Takes the progress, a few times a second, on the thread that fetches."""


class RemoteIncidents(Protocol):
    """Robots by their names on the link; calls wait, and may come from any thread."""

    def robots(self, within_s: float) -> Sequence[str]:
        """The robots that are there now, sorted; waits so long until all that were there before are known."""

    @property
    def problem(self) -> str | None:
        """Why no robot can be heard now; ``None`` where one could be."""

    def list(self, robot: str) -> Sequence[RemoteIncident]:
        """The incidents of a robot, oldest first. Raises ``TestudoError``, as ``SilentRobotError``."""

    def fetch(
        self, robot: str, name: str, folder: Path, on_progress: OnProgress, cancelled: Callable[[], bool]
    ) -> Path | None:
        """Have the incident ``name`` below ``folder``, byte for byte as the robot has it; where it then is.

        Until it is whole it is ``folder/.NAME.partial``, with which another call goes on. ``None`` if
        ``cancelled``, which is asked often, said so first. A robot that leaves is waited for.
        Raises ``TestudoError``.
        """

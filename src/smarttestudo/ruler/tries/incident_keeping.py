# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One of the incidents that a try shows, as a folder of the project."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Literal

from msgspec import Struct

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import Missing
from smarttestudo.domain.profile import Profile
from smarttestudo.files.whole_file import OutputFileError, not_written
from smarttestudo.incidents.folders import IncidentFolders
from smarttestudo.incidents.sink import Incident, IncidentSink, Past
from smarttestudo.incidents.topic_ring import SourceMessage
from smarttestudo.loop.step import Trigger
from smarttestudo.replays.incidents import IncidentRequest
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.tries.try_rules import TryRequest, compiled_for
from smarttestudo.ruler.tries.watches import WritesNothing
from smarttestudo.rules.rule_sets import sha256_of_rules

INCIDENTS_FOLDER = "incidents"


class KeepRequest(TryRequest, frozen=True, kw_only=True):
    """``POST /api/try/keep`` → ``KeepsAnswer``: the ``number``-th incident of that try.

    ``run`` tells it from others that are being kept; ``title`` is what the page calls it.
    """

    number: int
    title: str = ""


class KeepOrder(KeepRequest, frozen=True, kw_only=True):
    """``bag`` is a path; the incident is made in the empty folder ``workshop`` of the project ``project``."""

    project: str
    workshop: str


class KeptIncident(Struct, frozen=True, kw_only=True):
    """Name of a kept incident in the project."""

    name: str


class KeepState(Struct, frozen=True, kw_only=True):
    """How far the keeping of an incident is, ``share`` 0 … 1.

    ``kept`` is what the project calls it once done, ``problem`` why it failed, else empty.
    """

    run: str
    title: str
    bag: str
    state: Literal["running", "done", "failed"] = "running"
    share: float = 0.0
    kept: str | None = None
    problem: str = ""


class KeepsAnswer(Struct, frozen=True, kw_only=True):
    """``GET /api/try/keeps``, and what starting and ending one answers: the oldest first."""

    keeps: tuple[KeepState, ...]


class KeepEndRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/try/keep/cancel`` → ``KeepsAnswer``: ends that one, or forgets it where it has ended."""

    run: str


def keep_incident(order: KeepOrder, report: Callable[[float], None]) -> KeptIncident:
    """Replay the bag once more, and write the incident into ``incidents`` of the project.

    Raises:
        RefusedTextError: the rules have errors.
        RecordingError: the bag cannot be read, or gives no such incident.
        OutputFileError: it cannot be written.
    """
    project = ProjectFolder(Path(order.project))
    target = project.path(INCIDENTS_FOLDER)
    try:
        written = _cut(order, Path(order.bag), report)
        kept = _moved(written, target)
    except OutputFileError as error:
        raise OutputFileError(error.cause, place=INCIDENTS_FOLDER, remedy=error.remedy) from error
    return KeptIncident(name=f"{INCIDENTS_FOLDER}/{kept.name}")


def _cut(order: KeepOrder, bag: Path, report: Callable[[float], None]) -> Path:
    written: list[Path] = []

    def opened(channels: Mapping[str, StoredChannel]) -> IncidentSink:
        folders = IncidentFolders(Path(order.workshop), channels, ended=lambda path, _: written.append(path))
        return _OnlyOne(folders, order.number)

    with open_recording(bag) as recording:
        replay(
            ReplayRequest(
                recording=recording,
                rule_set=compiled_for(order, recording),
                output=Path(),
                profile=order.profile() or Profile(),
                report=report,
                writer=WritesNothing(),
                incidents=IncidentRequest(into=opened, rules_sha256=sha256_of_rules(order.text)),
            )
        )
    if not written:
        raise RecordingError("the recording gives no such incident", remedy="run the rules on it again")
    return written[0]


def _moved(written: Path, target: Path) -> Path:
    """The folder below ``target``, under its own name or one with a number; one that is there stays."""
    try:
        target.mkdir(exist_ok=True)
        kept, number = target / written.name, 1
        while kept.exists():
            if _has_same_record(kept, written):
                return kept
            number += 1
            kept = target / f"{written.name}-{number}"
        return written.rename(kept)
    except OSError as error:
        raise not_written(target, "an incident", error) from error


def _has_same_record(one: Path, other: Path) -> bool:
    """Whether two folders hold the same incident: the same inputs give the same bytes."""
    try:
        return (one / RECORD_NAME).read_bytes() == (other / RECORD_NAME).read_bytes()
    except OSError:
        return False


class _OnlyOne:
    """An ``IncidentSink`` that hands on the ``number``-th incident to ``sink``, 0 first."""

    def __init__(self, sink: IncidentSink, number: int) -> None:
        self._sink = sink
        self._left = number
        self._chosen: Incident | None = None

    def begin(self, incident: Incident, past: Past) -> None:
        if self._left == 0:
            self._chosen = incident
            self._sink.begin(incident, past)
        self._left -= 1

    def extend(self, incident: Incident, trigger: Trigger, to_ns: int, past: Past) -> None:
        if incident is self._chosen:
            self._sink.extend(incident, trigger, to_ns, past)

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        if self._chosen in incidents:
            self._sink.write(message, [one for one in incidents if one is self._chosen])

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        if incident is self._chosen:
            self._sink.end(incident, missing)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that tries showed, kept in the project."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, Literal

import msgspec
from msgspec import Struct, structs

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError, TestudoError, UsageError
from smarttestudo.domain.incident import Missing
from smarttestudo.domain.profile import Profile
from smarttestudo.files.removal import temporary_folder
from smarttestudo.files.whole_file import OutputFileError, not_written
from smarttestudo.incidents.folders import IncidentFolders
from smarttestudo.incidents.sink import Incident, IncidentSink, Past
from smarttestudo.incidents.topic_ring import SourceMessage
from smarttestudo.loop.step import Trigger
from smarttestudo.replays.incidents import IncidentRequest
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.recordings import READING
from smarttestudo.ruler.job import Job, Report, job
from smarttestudo.ruler.rules.document import require_usable
from smarttestudo.ruler.tries.try_rules import TryRequest, compiled_for
from smarttestudo.rules.rule_sets import sha256_of_rules

MAX_KEEPS = 20
_MAX_NAME = 200
RunJob = Callable[[Job[..., Any], Struct, Report], Awaitable[bytes]]
"""Does a job in a process of its own, and gives the answer as JSON."""
INCIDENTS_FOLDER = "incidents"


class KeepRequest(TryRequest, frozen=True, kw_only=True):
    """The ``number``-th incident of a try.

    ``run`` tells it from others that are being kept; ``title`` is what the page calls it.
    """

    number: int
    title: str = ""


class KeepOrder(KeepRequest, frozen=True, kw_only=True):
    """The incident is made in the empty folder ``workshop``, a path."""

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
    """Incidents that are being kept, the oldest first."""

    keeps: tuple[KeepState, ...]


class KeepEndRequest(Struct, frozen=True, kw_only=True):
    """The one to end, or to forget where it has ended."""

    run: str


@job(limit=READING)
def keep_incident(order: KeepOrder, folder: ProjectFolder, report: Report) -> KeptIncident:
    """Replay the bag once more, and write the incident into ``incidents`` of the project.

    Raises:
        RefusedTextError: the rules have errors.
        RecordingError: the bag cannot be read, or gives no such incident.
        OutputFileError: it cannot be written.
    """
    target = folder.path(INCIDENTS_FOLDER)
    try:
        written = _cut(order, folder.bag(order.bag), report)
        kept = _moved(written, target)
    except OutputFileError as error:
        raise OutputFileError(error.cause, place=INCIDENTS_FOLDER, remedy=error.remedy) from error
    return KeptIncident(name=f"{INCIDENTS_FOLDER}/{kept.name}")


def _cut(order: KeepOrder, bag: Path, report: Report) -> Path:
    written: list[Path] = []

    def opened(channels: Mapping[str, StoredChannel]) -> IncidentSink:
        folders = IncidentFolders(Path(order.workshop), channels, ended=lambda path, _: written.append(path))
        return _OnlyOne(folders, order.number)

    with open_recording(bag) as recording:
        replay(
            ReplayRequest(
                recording=recording,
                rule_set=compiled_for(order, recording),
                output=None,
                profile=order.profile() or Profile(),
                report=report,
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


class Keeps:
    """Writes incidents that tries showed into ``folder``, one after the other; ``run`` does a job."""

    def __init__(self, folder: ProjectFolder, run: RunJob) -> None:
        self._folder = folder
        self._run = run
        self._states: dict[str, KeepState] = {}
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def answer(self) -> KeepsAnswer:
        """All that were asked for and not ended since."""
        return KeepsAnswer(keeps=tuple(self._states.values()))

    async def start(self, asked: KeepRequest) -> KeepsAnswer:
        """Begin to keep one, once for each ``run``.

        Raises:
            UsageError: its name is empty or too long.
            ForbiddenPathError, MissingFileError: the project has no such bag.
            RefusedTextError: the rules have errors.
            TestudoError: too many are being kept.
        """
        if not 0 < len(asked.run) <= _MAX_NAME or len(asked.title) > _MAX_NAME:
            raise UsageError(f"give a name of 1 to {_MAX_NAME} letters", place="run")
        await asyncio.to_thread(self._folder.bag, asked.bag)
        await asyncio.to_thread(require_usable, asked)
        if asked.run not in self._tasks:
            if len(self._tasks) >= MAX_KEEPS:
                remedy = "wait for one of them, or cancel it"
                raise TestudoError(f"{MAX_KEEPS} incidents are being kept", remedy=remedy)
            self._forget_old(asked.run)
            self._states[asked.run] = KeepState(run=asked.run, title=asked.title, bag=asked.bag)
            task = self._tasks[asked.run] = asyncio.create_task(self._kept(asked))
            task.add_done_callback(lambda _: self._ended(asked.run))
        return self.answer()

    async def end(self, asked: KeepEndRequest) -> KeepsAnswer:
        """End one, of which no part stays, or forget one that has ended."""
        task = self._tasks.get(asked.run)
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        self._states.pop(asked.run, None)
        return self.answer()

    async def close(self) -> None:
        """End all of them."""
        tasks = tuple(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _kept(self, asked: KeepRequest) -> None:
        try:
            name = await self._written(asked)
        except TestudoError as error:
            words = ". ".join(filter(None, (error.cause, error.remedy)))
            self._change(asked.run, state="failed", problem=words)
        else:
            self._change(asked.run, state="done", share=1.0, kept=name)

    async def _written(self, asked: KeepRequest) -> str:
        with _workshop(self._folder.root) as workshop:
            order = KeepOrder(**structs.asdict(asked), workshop=str(workshop))
            report = partial(self._note, asked.run)
            written = await self._run(keep_incident, order, report)
        return msgspec.json.decode(written, type=KeptIncident).name

    def _ended(self, run: str) -> None:
        del self._tasks[run]
        if self._states[run].state == "running":
            del self._states[run]

    def _forget_old(self, run: str) -> None:
        ended = [name for name, each in self._states.items() if each.state != "running"]
        for name in (*ended[:-MAX_KEEPS], run):
            self._states.pop(name, None)

    def _note(self, run: str, share: float) -> None:
        self._change(run, share=share)

    def _change(self, run: str, **changed: object) -> None:
        self._states[run] = structs.replace(self._states[run], **changed)


@contextmanager
def _workshop(project: Path) -> Iterator[Path]:
    """Where an incident is written. Raises ``OutputFileError`` where nothing can be."""
    with ExitStack() as opened:
        try:
            workshop = opened.enter_context(temporary_folder(project, prefix=".keeping-"))
        except OSError as error:
            raise not_written(Path(INCIDENTS_FOLDER), "an incident", error) from error
        yield workshop


@job("GET /api/try/keeps")
async def keeps(keeps: Keeps) -> KeepsAnswer:
    """All that were asked for and not ended since."""
    return keeps.answer()


@job("POST /api/try/keep")
async def keep(request: KeepRequest, keeps: Keeps) -> KeepsAnswer:
    """Begin to keep one, which goes on though the page is closed."""
    return await keeps.start(request)


@job("POST /api/try/keep/cancel")
async def cancel(request: KeepEndRequest, keeps: Keeps) -> KeepsAnswer:
    return await keeps.end(request)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots' incidents over Zenoh: offered at one end, listed and fetched at the other."""

from __future__ import annotations

import queue
import secrets
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import NamedTuple

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.incident import FetchProgress, OnProgress, RemoteIncident, SilentRobotError
from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.background import ANSWERED_WITHIN_NS
from smarttestudo.link.protocol.keys import MAX_ROBOTS, Boot
from smarttestudo.link.protocol.messages import MAX_QUESTION_BYTES
from smarttestudo.link.transfer.catalog import IncidentCatalog
from smarttestudo.link.transfer.fetching import Fetching, RangeAsk
from smarttestudo.link.transfer.messages import (
    MAX_PIECE_BYTES,
    PIECES,
    PLANS,
    QUESTIONS,
    AskBytes,
    AskList,
    AskPlan,
    TransferPiece,
    TransferPlan,
    TransferQuestion,
    is_incident_name,
    list_from_bytes,
    list_to_bytes,
    no_incident,
    piece_from_bytes,
)
from smarttestudo.link.transfer.partial_incident import PartialIncident, incident_there
from smarttestudo.link.zenoh.compression import Compressor, unpacked
from smarttestudo.link.zenoh.queries import Query, QueryClient, QueryServer, Reply


class WaitingAsk(NamedTuple):
    """A question for bytes and what answers it."""

    ask: AskBytes
    query: Query


class IncidentServer:
    """Answers questions about what ``catalog`` has on ``key``.

    Lists and plans are made by tasks for ``later``, which says whether it does them. Questions for bytes,
    some of which only say what has arrived, are given to ``enqueue``; ``answer`` answers one when the link
    has nothing better to do.
    """

    def __init__(
        self,
        server: QueryServer,
        key: str,
        catalog: IncidentCatalog,
        *,
        later: Callable[[Callable[[], None]], bool],
        enqueue: Callable[[WaitingAsk], None],
    ) -> None:
        self._catalog = catalog
        self._later = later
        self._enqueue = enqueue
        self._compressor = Compressor()
        server.serve(key, self._handle)

    def answer(self, waiting: WaitingAsk, most_bytes: int, others: int) -> int:
        """Answer with at most so many bytes of the order, while ``others`` wait; how many travel."""
        ask, query = waiting
        index = self._catalog.known(ask.name, ask.token)
        if index is None:
            query.drop()
            return 0
        try:
            parts, body = index.read(ask.cursor, min(ask.size_bytes, most_bytes))
        except LinkError as error:
            query.refuse(error)
            return 0
        if not parts:
            query.drop()
            return 0
        piece = TransferPiece(parts=parts, body=body, advised_bytes=most_bytes, waiting=others)
        data = self._compressor.packed(PIECES.to_bytes(piece))
        return len(data) if query.reply(data, express=True) else 0

    def _handle(self, query: Query) -> None:
        question = QUESTIONS.from_bytes(query.data)
        is_known = isinstance(question, AskBytes) and self._catalog.known(question.name, question.token)
        if isinstance(question, AskBytes) and (is_known or not question.size_bytes):
            self._enqueue(WaitingAsk(question, query))
        elif not self._later(partial(query.answer, partial(self._looked_up, question))):
            query.drop()

    def _looked_up(self, question: TransferQuestion) -> bytes | None:
        """The answer of the disk; ``None`` where an incident was forgotten: its bytes are asked for again."""
        if isinstance(question, AskList):
            return list_to_bytes(self._catalog.list())
        plan = self._catalog.index(question.name).plan
        if isinstance(question, AskPlan):
            return PLANS.to_bytes(plan)
        if plan.token != question.token:
            raise LinkError("the incident changed on the robot", place=question.name, remedy="fetch it again")
        return None


_POLL_S = 0.1
_SAVE_S = 0.5
_SAY_S = 0.25
_RATE_SAYS = 12
"""The rate is that of so many times ``_SAY_S``."""
_AGAIN_AFTER_S = 0.05
_AGAIN_WITHIN_S = 3.0
"""A robot that is asked much answers some questions with silence, as does one without incidents."""
_BACK_WITHIN_POLLS = 100
"""For how many times ``_AGAIN_AFTER_S`` a robot is waited for that its link lost, maybe for a moment."""
_KNOWN_WITHIN_S = 5.0
_DIGITS = "#"
_Answered = tuple[RangeAsk, Reply]


class LinkIncidents:
    """``RemoteIncidents`` of the robots that ``client`` reaches at ``place``; any thread may call."""

    def __init__(self, client: QueryClient, place: str) -> None:
        self._place = place
        self._client = client
        self._lock = threading.Lock()
        self._present: dict[Boot, None] = {}
        self._seen: set[str] = set()
        self._all_known = threading.Event()
        self._client.begin(self._on_presence, self._all_known.set)

    def robots(self, within_s: float) -> Sequence[str]:
        self._all_known.wait(within_s)
        with self._lock:
            return sorted({boot.robot for boot in self._present})

    @property
    def problem(self) -> str | None:
        return self._client.problem

    def list(self, robot: str) -> Sequence[RemoteIncident]:
        data = self._answer(robot, AskList(), lambda: False)
        assert data is not None
        return list_from_bytes(data, robot)

    def fetch(
        self, robot: str, name: str, folder: Path, on_progress: OnProgress, cancelled: Callable[[], bool]
    ) -> Path | None:
        """Have an incident below ``folder``; one that is there already is not fetched again."""
        if not is_incident_name(name):
            # A robot would only say that the question is malformed.
            raise no_incident(name)
        data = self._answer(robot, AskPlan(name=name), cancelled)
        if data is None:
            return None
        plan = PLANS.from_bytes(data)
        if not any(file.name == RECORD_NAME for file in plan.files):
            raise LinkError(
                f"{robot} has no {RECORD_NAME} of it, so there is nothing to fetch",
                place=name,
                remedy="look at its folder on the robot",
            )
        there = incident_there(folder, name, [file.name for file in plan.files])
        if there is not None:
            on_progress(FetchProgress(got_bytes=plan.size_bytes, total_bytes=plan.size_bytes))
            return there
        with PartialIncident(folder, name, plan) as partial_incident:
            fetch = _Fetch(self, robot, name, plan, partial_incident)
            return partial_incident.finish() if fetch.run(on_progress, cancelled) else None

    def close(self) -> None:
        self._client.close()

    def boot(self, robot: str) -> Boot | None:
        """The run of a robot's end that is there, the newest where there are several."""
        name, _, digits = robot.partition(_DIGITS)
        with self._lock:
            found = [boot for boot in self._present if boot.robot == name and boot.number.startswith(digits)]
        return found[-1] if found else None

    def get(
        self, boot: Boot, question: TransferQuestion, answered: Callable[[Reply], None], timeout_s: float
    ) -> None:
        """Have ``answered`` called once with what came of a question, by any thread."""
        self._client.get(boot.incidents_key, QUESTIONS.to_bytes(question), answered, timeout_s)

    def _answer(self, robot: str, question: TransferQuestion, cancelled: Callable[[], bool]) -> bytes | None:
        """The answer of a robot, ``None`` if ``cancelled`` before. Raises ``LinkError``."""
        self._all_known.wait(_KNOWN_WITHIN_S)
        for boot in self._tries(robot):
            replies: queue.SimpleQueue[Reply] = queue.SimpleQueue()
            self.get(boot, question, replies.put, ANSWER_WITHIN_S)
            reply = _waited(replies, cancelled)
            if cancelled():
                return None
            if isinstance(reply, LinkError):
                raise reply
            if reply is not None:
                return unpacked(reply, MAX_QUESTION_BYTES)
        kind, cause = LinkError, self._client.problem
        if cause is None and self.boot(robot) is None:
            cause = f"there is no robot {robot!r:.80}"
        elif cause is None:
            kind, cause = SilentRobotError, f"{robot} does not answer this"
        raise kind(
            cause,
            place=self._place,
            remedy="start 'testudo run --link --incidents' on the robot, and see 'testudo top --connect'",
        )

    def _tries(self, robot: str) -> Iterator[Boot]:
        """The run of a robot's end to ask, again and again for a while."""
        boot = self.boot(robot) or self._back(robot)
        end_s = time.monotonic() + _AGAIN_WITHIN_S
        while boot is not None:
            yield boot
            time.sleep(_AGAIN_AFTER_S)
            boot = self.boot(robot)
            if boot is None:
                boot = self._back(robot)
                end_s = time.monotonic() + _AGAIN_WITHIN_S
            elif time.monotonic() >= end_s:
                return

    def _back(self, robot: str) -> Boot | None:
        """The run of a robot's end that was there and is again soon."""
        with self._lock:
            was_there = robot.partition(_DIGITS)[0] in self._seen
        for _ in range(_BACK_WITHIN_POLLS if was_there else 0):
            time.sleep(_AGAIN_AFTER_S)
            if (boot := self.boot(robot)) is not None:
                return boot
        return None

    def _on_presence(self, boot: Boot, is_present: bool) -> None:  # noqa: FBT001 - what a client calls
        with self._lock:
            self._present.pop(boot, None)
            if is_present and len(self._present) < MAX_ROBOTS:
                self._present[boot] = None
                if len(self._seen) < MAX_ROBOTS:
                    self._seen.add(boot.robot)


def _waited(replies: queue.SimpleQueue[Reply], cancelled: Callable[[], bool]) -> Reply:
    end_s = time.monotonic() + 2 * ANSWER_WITHIN_S
    while not cancelled() and time.monotonic() < end_s:
        with suppress(queue.Empty):
            return replies.get(timeout=_POLL_S)
    return None


class _Fetch:
    """One fetch, on the thread that calls ``run``."""

    def __init__(
        self, links: LinkIncidents, robot: str, name: str, plan: TransferPlan, there: PartialIncident
    ) -> None:
        self._links = links
        self._robot = robot
        self._name = name
        self._plan = plan
        self._there = there
        self._asker = secrets.randbits(64)
        self._fetching = Fetching(plan.size_bytes, there.cursor)
        self._answers: queue.SimpleQueue[_Answered] = queue.SimpleQueue()
        self._saved_s = self._said_s = 0.0
        self._history: deque[tuple[float, int]] = deque(maxlen=_RATE_SAYS)

    def run(self, on_progress: OnProgress, cancelled: Callable[[], bool]) -> bool:
        """Whether all is there; if not, it was ``cancelled``. Raises ``TestudoError``."""
        try:
            while not self._fetching.is_complete:
                if cancelled():
                    return False
                self._ask()
                self._receive()
                self._say(on_progress)
        finally:
            self._there.save()
        on_progress(self._progress())
        return True

    def _ask(self) -> None:
        boot = self._links.boot(self._robot)
        if boot is None:
            return
        for ask in self._fetching.asks(time.monotonic_ns()):
            question = self._question(ask.start, ask.size_bytes)
            self._links.get(boot, question, partial(self._answered, ask), ANSWERED_WITHIN_NS / NS_PER_S)
        if self._fetching.unsaid():
            self._links.get(boot, self._question(0, 0), lambda _: None, ANSWER_WITHIN_S)

    def _question(self, cursor: int, size_bytes: int) -> AskBytes:
        return AskBytes(
            name=self._name,
            token=self._plan.token,
            asker=self._asker,
            got_bytes=self._fetching.got_bytes,
            cursor=cursor,
            size_bytes=size_bytes,
        )

    def _answered(self, ask: RangeAsk, reply: Reply) -> None:
        self._answers.put((ask, reply))

    def _receive(self) -> None:
        with suppress(queue.Empty):
            ask, reply = self._answers.get(timeout=_POLL_S)
            while True:
                self._handle(ask, reply)
                ask, reply = self._answers.get_nowait()
        for piece in self._fetching.pieces():
            self._there.write(piece)
        if time.monotonic() - self._saved_s > _SAVE_S:
            self._saved_s = time.monotonic()
            self._there.save()

    def _handle(self, ask: RangeAsk, reply: Reply) -> None:
        if isinstance(reply, LinkError):
            raise reply
        piece: TransferPiece | None = None
        if reply is not None:
            piece = piece_from_bytes(unpacked(reply, MAX_PIECE_BYTES), ask.size_bytes)
        self._fetching.answered(ask, piece, len(reply or b""), time.monotonic_ns())

    def _say(self, on_progress: OnProgress) -> None:
        now_s = time.monotonic()
        if now_s - self._said_s >= _SAY_S:
            self._said_s = now_s
            self._history.append((now_s, self._fetching.cursor))
            on_progress(self._progress())

    def _progress(self) -> FetchProgress:
        cursor = self._fetching.cursor
        reached = [level.rate_hz for level in self._plan.levels if level.end <= cursor]
        history = self._history or [(0.0, cursor)]
        (first_s, first), (last_s, last) = history[0], history[-1]
        waits_for = None
        if self._links.boot(self._robot) is None:
            waits_for = "the robot, which is not there"
        elif self._fetching.is_unanswered:
            waits_for = "a part of the link that topics leave unused"
        return FetchProgress(
            got_bytes=cursor,
            total_bytes=self._plan.size_bytes,
            rate_bytes_per_s=(last - first) / (last_s - first_s) if last_s > first_s else 0.0,
            level_hz=reached[-1] if reached else None,
            waits_for=waits_for if cursor < self._plan.size_bytes else None,
        )

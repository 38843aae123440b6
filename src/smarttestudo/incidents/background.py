# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Writes incidents while the loop goes on."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from queue import SimpleQueue

from smarttestudo.domain.errors import testudo_error
from smarttestudo.domain.incident import Missing
from smarttestudo.incidents.folders import Failed
from smarttestudo.incidents.missing import LostMessages
from smarttestudo.incidents.ring_files import RingFiles
from smarttestudo.incidents.sink import Incident, IncidentSink, Past, Store
from smarttestudo.incidents.topic_ring import SourceMessage
from smarttestudo.loop.step import Trigger


class BackgroundSink:
    """An ``IncidentSink`` that hands what it is told to ``sink``, in order, on a thread of its own.

    Messages that come faster than they are written wait, at most ``max_waiting_bytes`` of them; further ones
    are missing in their incidents, which say so. What memory gave up goes to ``ring``. ``failed`` is told
    what ``sink`` raises; writing goes on.
    """

    def __init__(
        self, sink: IncidentSink, max_waiting_bytes: int, *, failed: Failed, ring: RingFiles | None = None
    ) -> None:
        self._sink = sink
        self._ring = ring
        self._max_waiting_bytes = max_waiting_bytes
        self._thread = TaskThread(
            "incidents", lambda error: failed("that is being written", testudo_error(error))
        )
        # One thread writes each of these, so that neither needs a lock.
        self._given_bytes = 0
        self._done_bytes = 0
        self._left_out: dict[Incident, LostMessages] = {}
        self.dropped = 0
        """Messages that arrived faster than they were written, for an incident or for the ring on disk."""

    def begin(self, incident: Incident, past: Past) -> None:
        """Begin the incident on the thread."""
        self._left_out[incident] = LostMessages()
        self._thread.give(partial(self._sink.begin, incident, past))

    def extend(self, incident: Incident, trigger: Trigger, to_ns: int, past: Past) -> None:
        """Extend the incident on the thread."""
        self._thread.give(partial(self._sink.extend, incident, trigger, to_ns, past))

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        """Write the message on the thread, unless too much waits already."""
        if self._given_bytes - self._done_bytes > self._max_waiting_bytes:
            self.dropped += 1
            for incident in incidents:
                self._left_out[incident].add(message.topic, message.stamp_ns)
            return
        self._given_bytes += message.held_bytes
        self._thread.give(partial(self._write, message, incidents))

    @property
    def store(self) -> Store | None:
        """Store for messages that memory gives up, if there is a ring; those that wait too long are lost."""
        return None if self._ring is None else partial(self._have_stored, self._ring)

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        """End the incident on the thread."""
        left_out = self._left_out.pop(incident)
        self._thread.give(partial(self._sink.end, incident, (*missing, *left_out.missing())))

    def running(self) -> AbstractContextManager[None]:
        """Write during the block, and what is left after it."""
        return self._thread.running()

    def _write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        self._done_bytes += message.held_bytes
        self._sink.write(message, incidents)

    def _have_stored(self, ring: RingFiles, message: SourceMessage, until_ns: int, now_ns: int) -> None:
        if self._given_bytes - self._done_bytes > self._max_waiting_bytes:
            self.dropped += 1
            return
        self._given_bytes += message.held_bytes
        self._thread.give(partial(self._store, ring, message, until_ns, now_ns))

    def _store(self, ring: RingFiles, message: SourceMessage, until_ns: int, now_ns: int) -> None:
        self._done_bytes += message.held_bytes
        ring.store(message, until_ns, now_ns)


class TaskThread:
    """Does what it is given, in order, on a thread named ``name``.

    ``failed`` is told what a task raises; the next is done all the same.
    """

    def __init__(self, name: str, failed: Callable[[Exception], None]) -> None:
        self._name = name
        self._failed = failed
        self._tasks: SimpleQueue[Callable[[], None] | None] = SimpleQueue()

    def give(self, task: Callable[[], None]) -> None:
        """Do ``task`` after those that were given before."""
        self._tasks.put(task)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Work during the block, and on what is left after it."""
        thread = threading.Thread(target=self._run, name=self._name, daemon=True)
        thread.start()
        try:
            yield
        finally:
            self._tasks.put(None)
            thread.join()

    def _run(self) -> None:
        while (task := self._tasks.get()) is not None:
            self._do(task)
            # What it holds is free while the thread waits for the next.
            del task

    def _do(self, task: Callable[[], None]) -> None:
        try:
            task()
        except Exception as error:  # noqa: BLE001 - whatever a task fails of, the thread goes on
            self._failed(error)

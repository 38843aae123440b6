# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recording of incidents that rules order in a live run."""

from __future__ import annotations

import fcntl
import os
from collections import defaultdict
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.metadata_text import offered_qos
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.incident import IncidentRecord, IncidentState
from smarttestudo.domain.robot import Payload, Qos, Robot, Subscription
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.units import BYTES_PER_GB, BYTES_PER_MB, NS_PER_S, grouped
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, OutputFileError, not_written
from smarttestudo.incidents.background import BackgroundSink
from smarttestudo.incidents.folder import complete_incidents
from smarttestudo.incidents.folders import IncidentFolders
from smarttestudo.incidents.missing import missing_text
from smarttestudo.incidents.part_kinds import (
    INCIDENT_MEMORY,
    INCIDENT_RING,
    INCIDENT_RING_MAX,
    INCIDENTS,
    INCIDENTS_MAX,
)
from smarttestudo.incidents.recorder import MAX_OPEN_INCIDENTS, IncidentRecorder
from smarttestudo.incidents.ring_files import RingFiles
from smarttestudo.incidents.store import make_room
from smarttestudo.loop.step import Trigger
from smarttestudo.robot.gone_publishers import GonePublishers
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import Part, PartContext
from smarttestudo.robot.source import LiveSource

WAITING_SHARE = 0.25
"""How much of the memory may wait for the disk beside what the ring holds."""
_SAY_AFTER_NS = 10 * NS_PER_S


class LiveIncidents(Part):
    """Keeps the topics that rules record, and writes the incidents below ``folder``.

    Raises ``OutputFileError`` where the folder cannot be made, or another run records into it.
    """

    receives_topics_only = True

    def __init__(self, context: PartContext, folder: Path) -> None:
        robot, settings = context.robot, context.settings
        self._robot = robot
        self._settings = settings
        self._memory_bytes = round(settings[INCIDENT_MEMORY] * BYTES_PER_MB)
        self._static_topic = context.resolve("/tf_static")
        self._channels = SourceChannels(robot)
        self._recorder: IncidentRecorder | None = None
        self._ring: RingFiles | None = None
        self._ring_max_bytes = round(settings[INCIDENT_RING_MAX] * BYTES_PER_GB)
        self._locks = [FolderLock(folder, "--incidents")]
        # Of each topic: what it arrived over, how much that had lost, and the stamp of its last message.
        self._taken: dict[str, tuple[Subscription, int, int]] = {}
        self._gone: defaultdict[str, GonePublishers] = defaultdict(GonePublishers)
        self._recorded_topics: frozenset[str] = frozenset()
        self._refused = 0
        self._dropped = 0
        self._silent_until_ns = 0
        # The thread that writes changes these.
        self._recorded = self._lost = self._missing = 0
        self._early: set[str] = set()
        self._problem: str | None = None
        if (ring := settings[INCIDENT_RING]) is not None:
            self._ring = self._opened_ring(ring)
        for found in complete_incidents(folder):
            robot.log.warning(f"incident {found}")
        delete_for_room(robot, settings)
        if context.link is not None:
            context.link.offer_incidents(folder)
        folders = IncidentFolders(
            folder,
            self._channels.by_topic,
            of_message=self._channels.of,
            ring=self._ring,
            failed=self._failed,
            ended=self._ended,
        )
        self._background = BackgroundSink(
            folders, round(WAITING_SHARE * self._memory_bytes), failed=self._failed, ring=self._ring
        )

    @contextmanager
    def running(self) -> Iterator[None]:
        """Write during the block; at its end, windows that are open end, too."""
        try:
            with self._background.running():
                try:
                    yield
                finally:
                    if self._recorder is not None:
                        self._recorder.finish(self._robot.now_ns())
        finally:
            if self._ring is not None:
                self._ring.close()
            for lock in self._locks:
                lock.release()

    def follow(self, rules: LiveRules, now_ns: int) -> None:
        """Keep what these rules record from now on."""
        rule_set = rules.rule_set
        if self._recorder is None:
            self._recorder = IncidentRecorder(
                rule_set,
                self._background,
                self._memory_bytes,
                now_ns,
                rules_sha256=rules.rules_hash,
                store=self._background.store,
            )
        else:
            self._recorder.change_rules(rule_set, rules.rules_hash)
        self._recorded_topics = rule_set.recorded
        if self._recorded_topics:
            self._recorded_topics |= {self._static_topic}
        self.topics = self._recorded_topics | self._recorder.open_topics

    def on_trigger(self, trigger: Trigger) -> None:
        """Begin an incident, or extend that of the block."""
        if self._recorder is not None:
            self._recorder.begin(trigger)

    def on_source(self, topic: str, source: LiveSource, now_ns: int) -> None:
        """Note the topic's type, and from when on it is received."""
        if self._recorder is None:
            return
        gone = partial(
            self._gone[topic].among,
            known=source.gids,
            now_ns=self._robot.steady_ns(),
            is_somebody_there=source.publishers > 0,
        )
        self._recorder.on_subscribed(topic, now_ns, transient_local=source.qos.transient_local, gone=gone)
        self._channels.on_source(topic, source, self._recorder.next_number)

    def on_message(
        self,
        topic: str,
        payload: Payload,
        publisher: Hashable,
        now_ns: int,
        subscription: Subscription | None,
    ) -> None:
        """Keep the message, and what its subscription lost before it."""
        recorder = self._recorder
        if recorder is None or not recorder.keeps(topic):
            return
        if subscription is not None:
            dropped, known = subscription.dropped, self._taken.get(topic)
            if known is not None and known[0] is subscription and known[1] < dropped:
                recorder.lose(topic, dropped - known[1], min(known[2], now_ns), now_ns)
            self._taken[topic] = subscription, dropped, now_ns
        recorder.on_message(topic, now_ns, payload[:], publisher)

    @property
    def wake_ns(self) -> int | None:
        """When, on the clock, the next window is over."""
        return None if self._recorder is None else self._recorder.next_wake_ns

    def on_clock_jump(self, ahead_ns: int) -> None:
        """Keep the length of windows."""
        if self._recorder is not None:
            self._recorder.time.leave_out(ahead_ns)

    def on_wake(self, now_ns: int) -> None:
        """End the windows that are over."""
        if self._recorder is None:
            return
        self._recorder.advance(now_ns)
        self.topics = self._recorded_topics | (self.topics & self._recorder.open_topics)
        self._say_dropped()
        if self._recorder.refused > self._refused:
            self._refused = self._recorder.refused
            self._robot.log.warning(
                f"incidents not recorded because {MAX_OPEN_INCIDENTS} were open: {self._refused} so far"
            )

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        """``status`` with what recording costs now, if anything is recorded."""
        recorder, ring = self._recorder, self._ring
        if recorder is None:
            return status
        state = IncidentState(
            held_bytes=recorder.held_bytes,
            memory_bytes=self._memory_bytes,
            topics=recorder.topics,
            open=recorder.open_incidents,
            recorded=self._recorded,
            failed=self._lost + recorder.refused,
            problem=self._problem or (None if ring is None or ring.problem is None else str(ring.problem)),
            ring_bytes=0 if ring is None else ring.size_bytes,
            ring_max_bytes=None if ring is None else self._ring_max_bytes,
            dropped=self._background.dropped,
            missing=self._missing,
            further_moments=recorder.further_moments,
        )
        return replace(status, incidents=state)

    def _say_dropped(self) -> None:
        """Warn of what arrived faster than the disk took it, at most every ``_SAY_AFTER_NS``."""
        dropped, now_ns = self._background.dropped, self._robot.steady_ns()
        if dropped > self._dropped and now_ns >= self._silent_until_ns:
            self._robot.log.warning(
                f"incidents: {grouped(dropped - self._dropped)} messages came faster than the disk takes them"
            )
            self._dropped, self._silent_until_ns = dropped, now_ns + _SAY_AFTER_NS

    def _opened_ring(self, folder: Path) -> RingFiles:
        self._locks.append(FolderLock(folder, "--incident-ring"))
        return RingFiles(
            folder,
            self._ring_max_bytes,
            failed=lambda error: self._robot.log.warning(f"incidents lack what came before: {error}"),
        )

    def _ended(self, path: Path, record: IncidentRecord) -> None:
        name = path.name.removeprefix(".").removesuffix(PARTIAL_SUFFIX)
        self._missing += sum(missing.messages or 0 for missing in record.missing)
        words = [missing_text(record.missing)]
        if name != path.name:
            words.append("the next run completes it" if path.exists() else "nothing of it was written")
        if text := "; ".join(filter(None, words)):
            self._robot.log.warning(f"incident {name}: {text}")
        else:
            self._robot.log.info(f"incident {name}")
        if name in self._early:
            self._early.remove(name)
        else:
            self._recorded += 1
            self._problem = None
        if name == path.name:
            delete_for_room(self._robot, self._settings, newest=name)

    def _failed(self, name: str, error: TestudoError) -> None:
        self._lost += 1
        self._early.add(name)
        self._problem = str(error)
        self._robot.log.warning(f"incident {name}: ends early: {error}")


def delete_for_room(robot: Robot, settings: Settings, newest: str | None = None) -> None:
    """Delete old incidents where all would take more disk than they may; ``robot`` logs what was deleted.

    The incident called ``newest`` was just recorded, and stays.
    """
    folder, max_gb = settings[INCIDENTS], settings[INCIDENTS_MAX]
    if folder is None or max_gb is None or not folder.is_dir():
        return
    try:
        for deletion in make_room(folder, round(max_gb * BYTES_PER_GB), newest):
            if deletion.problem is not None:
                robot.log.warning(
                    f"incident {deletion.name}: stays, though room is needed: {deletion.problem}"
                )
                continue
            read = "read" if deletion.was_read else "not read by anyone"
            robot.log.warning(f"incident {deletion.name}: deleted to make room, {read}")
    except TestudoError as error:
        robot.log.warning(str(error))


LOCK_NAME = ".lock"


class FolderLock:
    """``folder``, which is made where there is none, until ``release`` or the end of the process.

    ``option`` is what names it.

    Raises ``OutputFileError`` where it cannot be made, or another run has it: completing what a killed run
    left would cut the files of one that lives.
    """

    def __init__(self, folder: Path, option: str) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(folder / LOCK_NAME, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise not_written(folder, f"the folder of {option}", error) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            os.close(self._file)
            remedy = f"name another folder with {option}"
            raise OutputFileError("another run records here", place=str(folder), remedy=remedy) from error
        except OSError:
            # A disk that knows no locks.
            return

    def release(self) -> None:
        """Give the folder to other runs."""
        os.close(self._file)


_MOST_CHANGES = 100


class SourceChannels:
    """The channels in ``by_topic``, with the type and QoS of the last source that was subscribed to.

    Types before that are kept for their messages.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._sources: dict[str, tuple[str, Qos]] = {}
        # Another thread reads these: what is in them is replaced, not changed.
        self._since: dict[str, tuple[tuple[int, StoredChannel], ...]] = {}
        self.by_topic: dict[str, StoredChannel] = {}

    def on_source(self, topic: str, source: LiveSource, number: int) -> None:
        """Messages of ``source`` are received from ``number`` on, if they were not before."""
        seen = source.type_name, source.qos
        if self._sources.get(topic) != seen:
            self._sources[topic] = seen
            channel = StoredChannel(
                topic=topic,
                type_name=source.type_name,
                definition=self._robot.definition(source.type_name),
                qos_text=offered_qos(source.qos),
            )
            before = self._since.get(topic, ())
            if before and before[-1][1].type_name == channel.type_name:
                # Not all readers bear two channels of one topic and type.
                number, before = before[-1][0], before[:-1]
            self._since[topic] = (*before[-_MOST_CHANGES:], (number, channel))
            self.by_topic[topic] = channel

    def of(self, topic: str, number: int) -> StoredChannel | None:
        """The channel as it was when the message of that number arrived."""
        since = self._since.get(topic, ())
        found = (channel for first, channel in reversed(since) if first <= number)
        return next(found, since[0][1] if since else None)

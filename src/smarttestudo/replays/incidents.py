# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents that rules would have recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.writer import stored_channels
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import BYTES_PER_MB, counted
from smarttestudo.files.outputs import require_new
from smarttestudo.incidents.folders import IncidentFolders
from smarttestudo.incidents.latched import holds_static_frames
from smarttestudo.incidents.recorder import MAX_OPEN_INCIDENTS, IncidentRecorder
from smarttestudo.incidents.sink import IncidentSink
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.step import Trigger

OpenSink: TypeAlias = Callable[[Mapping[str, StoredChannel]], IncidentSink]
"""Makes what takes incidents of these topics, by name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentRequest:
    """Where incidents go, a new folder or what takes them, and how much memory a robot would have.

    ``rules_sha256`` is that of the rules.
    """

    into: Path | OpenSink
    rules_sha256: str
    memory_mb: float = DEFAULT_INCIDENT_MEMORY_MB


class IncidentCutter:
    """Cuts the windows that a live run with the same rules and messages would have cut."""

    def __init__(
        self, request: IncidentRequest, rule_set: RuleSet, sources: Mapping[str, Channel], start_ns: int
    ) -> None:
        self.written: list[Path] = []
        self._folders: IncidentFolders | None = None
        recorded = {topic: channel for topic, channel in sources.items() if _is_recorded(rule_set, channel)}
        sink = self._sink(request.into, stored_channels(recorded))
        memory_bytes = round(request.memory_mb * BYTES_PER_MB)
        self._recorder = IncidentRecorder(
            rule_set, sink, memory_bytes, start_ns, rules_sha256=request.rules_sha256
        )
        for topic, channel in sources.items():
            self._recorder.on_subscribed(topic, start_ns, transient_local=channel.transient_local)

    def _sink(self, into: Path | OpenSink, channels: Mapping[str, StoredChannel]) -> IncidentSink:
        if not isinstance(into, Path):
            return into(channels)
        require_new(into)
        self._folders = IncidentFolders(into, channels, ended=lambda path, _: self.written.append(path))
        return self._folders

    def abort(self) -> None:
        """Leave nothing of incidents that have not ended; another's sink is left to that."""
        if self._folders is not None:
            self._folders.abort()

    def begin(self, triggers: Iterable[Trigger]) -> None:
        """Begin an incident for each block that begins to record, or extend that of the block."""
        for trigger in triggers:
            self._recorder.begin(trigger)

    def keeps(self, topic: str) -> bool:
        """Whether messages of ``topic`` may go into an incident."""
        return self._recorder.keeps(topic)

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """A message of the recording, before the loop is given it."""
        if self.keeps(channel.topic):
            self._recorder.on_message(channel.topic, stamp_ns, payload)

    def finish(self, now_ns: int) -> None:
        """The recording ended."""
        self._recorder.finish(now_ns)

    def notices(self) -> Iterator[str]:
        """Notice of incidents that were not recorded."""
        if self._recorder.refused:
            refused = counted(self._recorder.refused, "incident")
            yield f"not recorded, because {MAX_OPEN_INCIDENTS} windows were open: {refused}"


def _is_recorded(rule_set: RuleSet, channel: Channel) -> bool:
    topic = channel.topic
    return topic in rule_set.recorded or channel.transient_local or holds_static_frames(topic)


@contextmanager
def incident_cutter(
    request: IncidentRequest | None, rule_set: RuleSet, sources: Mapping[str, Channel], start_ns: int
) -> Iterator[IncidentCutter | None]:
    """Cutter of incidents, if they are asked for; incidents that are open go if the block fails."""
    if request is None:
        yield None
        return
    cutter = IncidentCutter(request, rule_set, sources, start_ns)
    try:
        yield cutter
    except BaseException:
        cutter.abort()
        raise

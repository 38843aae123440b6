# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The streams that robots of one name have of one topic, and which of them count."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from smarttestudo.domain.link import StreamInfo
from smarttestudo.link.zenoh.arrivals import StreamSaid


class StreamKey(NamedTuple):
    """A stream as a run of a robot's end numbers it."""

    boot: str
    number: int


class CountedStream(NamedTuple):
    """The stream that counts as that of a publisher."""

    key: StreamKey
    info: StreamInfo

    def is_of_another_kind(self, before: CountedStream) -> bool:
        """Whether it is of another run than the one ``before``, and not alike."""
        return self.key.boot != before.key.boot and _kind(self.info) != _kind(before.info)

    def said_by(self, robot: str, *, has_it: bool = True) -> StreamSaid:
        """That ``robot`` has it, or has it no more."""
        boot, number = self.key
        return StreamSaid(robot=robot, boot=boot, number=number, info=self.info if has_it else None)


class _Kind(NamedTuple):
    """Properties that streams of one topic must have in common."""

    type_name: str
    is_reliable: bool
    is_latched: bool
    definition: str


class TopicStreams:
    """The streams of one topic; ``owner`` is the run that the topic belongs to.

    Of the runs that have it, that is the one of the lowest of ``ranks``, which came first: a second robot of
    the name takes a topic from nobody, and the first one has it again after an outage. What others have of it
    counts where the owner has a stream of the same type, QoS and definition.
    """

    def __init__(self, ranks: Mapping[str, int]) -> None:
        self.owner: str | None = None
        self._ranks = ranks
        self._of_boots: dict[str, dict[int, StreamInfo]] = {}
        self._of_publishers: dict[int, dict[StreamKey, StreamInfo]] = {}
        self._kinds: Counter[_Kind] = Counter()

    def follow(self, key: StreamKey, info: StreamInfo | None) -> Iterable[int]:
        """A run has a stream, or has it no more; the publishers of which other streams may count now."""
        before = self._forget(key)
        if info is not None:
            self._of_boots.setdefault(key.boot, {})[key.number] = info
            self._of_publishers.setdefault(info.publisher, {})[key] = info
        touched = {one.publisher for one in (before, info) if one is not None}
        owner = min(self._of_boots, key=self._rank, default=None)
        if owner != self.owner:
            self.owner = owner
            self._kinds = Counter(map(_kind, self._of_boots.get(owner or "", {}).values()))
            return {*touched, *self._of_publishers}
        if key.boot != self.owner:
            return touched
        has_changed = self._count(before, -1) | self._count(info, 1)
        return {*touched, *self._of_publishers} if has_changed and len(self._of_boots) > 1 else touched

    def counted(self, publisher: int) -> CountedStream | None:
        """The stream that counts as that of a publisher: the owner's last one before all others."""
        known = self._of_publishers.get(publisher, {})
        counting = [CountedStream(key, info) for key, info in known.items() if self.counts(key.boot, info)]
        of_owner = [one for one in counting if one.key.boot == self.owner]
        return of_owner[-1] if of_owner else next(iter(counting), None)

    def counts(self, boot: str, info: StreamInfo) -> bool:
        """Whether a stream of a run counts."""
        return self.owner is None or boot == self.owner or _kind(info) in self._kinds

    def refused(self) -> str | None:
        """Difference to the owner of the first stream that does not count, if there is one."""
        if len(self._of_boots) < 2:
            return None
        streams = ((boot, info) for boot, known in self._of_boots.items() for info in known.values())
        return next((self._difference(info) for boot, info in streams if not self.counts(boot, info)), None)

    def _difference(self, info: StreamInfo) -> str:
        of_owner = list(self._of_boots.get(self.owner or "", {}).values())
        alike = [one for one in of_owner if one.type_name == info.type_name]
        if not alike:
            return f"as {info.type_name}, not {' or '.join(sorted({one.type_name for one in of_owner}))}"
        has_qos = any(_kind(one)[1:3] == _kind(info)[1:3] for one in alike)
        return "with another definition" if has_qos else "with another QoS"

    def _rank(self, boot: str) -> int:
        return self._ranks.get(boot, 0)

    def _forget(self, key: StreamKey) -> StreamInfo | None:
        streams = self._of_boots.get(key.boot, {})
        info = streams.pop(key.number, None)
        if not streams:
            self._of_boots.pop(key.boot, None)
        if info is not None:
            known = self._of_publishers[info.publisher]
            del known[key]
            if not known:
                del self._of_publishers[info.publisher]
        return info

    def _count(self, info: StreamInfo | None, change: int) -> bool:
        """Count one of the owner's streams; whether there is a kind more, or one less."""
        if info is None:
            return False
        kind = _kind(info)
        had = kind in self._kinds
        self._kinds[kind] += change
        if self._kinds[kind] <= 0:
            del self._kinds[kind]
        return had is not (kind in self._kinds)


def _kind(info: StreamInfo) -> _Kind:
    return _Kind(info.type_name, info.qos.reliable, info.qos.transient_local, info.definition)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of one topic of a recording."""

from __future__ import annotations

from dataclasses import dataclass

from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.visualizer.trace import TraceAccumulator

_BITS_PER_BYTE = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingSpan:
    """From the first to the last message of a recording, over all topics."""

    start_ns: int
    end_ns: int

    @property
    def duration_s(self) -> float:
        """Seconds from the first message to the last."""
        return (self.end_ns - self.start_ns) / NS_PER_S

    def seconds_to(self, stamp_ns: int) -> float:
        """Seconds from the recording's start to ``stamp_ns``."""
        return (stamp_ns - self.start_ns) / NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicStatistics:
    """What a topic carried in a recording.

    ``start_s`` and ``end_s`` are the topic's first and last message, in seconds since the recording's start.
    ``mean_hz`` is (n − 1) / (last − first). ``binned_hz`` is the mean count of the epoch-aligned 1 s bins
    from first to last, edges included; 0 without a message. ``kb_per_s`` counts over the recording's whole
    duration. ``declared`` says that the bytes are sizes that the recording declares, not those it holds.
    A number that the messages do not determine is ``None``.
    """

    messages: int
    size_bytes: int
    start_s: float | None
    end_s: float | None
    mean_hz: float | None
    binned_hz: float
    kb_per_s: float | None
    declared: bool = False

    @property
    def kbit_per_s(self) -> float | None:
        """``kb_per_s`` in kilobits of 1000 bits."""
        return None if self.kb_per_s is None else self.kb_per_s * _BITS_PER_BYTE

    def to_json(self) -> dict[str, object]:
        """The topic's entry in ``--json``."""
        return {
            "messages": self.messages,
            "bytes": self.size_bytes,
            "start_s": self.start_s,
            "end_s": self.end_s,
            "mean_hz": self.mean_hz,
            "binned_hz": self.binned_hz,
            "kb_per_s": self.kb_per_s,
            "declared": self.declared,
        }


def topic_statistics(
    trace: TraceAccumulator, span: RecordingSpan, *, declared: bool = False
) -> TopicStatistics:
    """The numbers of ``trace``, one topic of the recording that lasted over ``span``."""
    messages, size_bytes = trace.messages, trace.size_bytes
    first_ns, last_ns = trace.first_ns, trace.last_ns
    return TopicStatistics(
        messages=messages,
        size_bytes=size_bytes,
        start_s=None if first_ns is None else span.seconds_to(first_ns),
        end_s=None if last_ns is None else span.seconds_to(last_ns),
        mean_hz=_mean_hz(messages, first_ns, last_ns),
        binned_hz=_binned_hz(messages, first_ns, last_ns),
        kb_per_s=size_bytes / BYTES_PER_KB / span.duration_s if span.duration_s > 0 else None,
        declared=declared,
    )


def _mean_hz(messages: int, first_ns: int | None, last_ns: int | None) -> float | None:
    if first_ns is None or last_ns is None or first_ns == last_ns:
        return None
    return (messages - 1) * NS_PER_S / (last_ns - first_ns)


def _binned_hz(messages: int, first_ns: int | None, last_ns: int | None) -> float:
    if first_ns is None or last_ns is None:
        return 0.0
    return messages / (last_ns // NS_PER_S - first_ns // NS_PER_S + 1)

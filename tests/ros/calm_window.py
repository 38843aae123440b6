# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The stretch of a live run in which the machine kept up, so that what was received tells of the runtime.

A busy machine stops processes for a moment. What was due meanwhile comes late and in a burst; a pacer makes
up for it, so the mean rate stays exact, unless only the stall or only the burst falls into what is looked at.
So its edges must lie in calm, and no stall between them may be longer than a pacer makes up for.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

LATE_S = 0.05
PROMPT_S = 0.02
# A pacer makes up for 0.25 s.
LONGEST_STALL_S = 0.2
CALM_S = 1.0


class Arrival(NamedTuple):
    """A message that came to the operator, in seconds of the monotonic clock."""

    at_s: float
    value: Any
    due_s: float

    @property
    def late_s(self) -> float:
        return self.at_s - self.due_s


class Stretch(NamedTuple):
    start_s: float
    end_s: float


class Stall(NamedTuple):
    """From ``start_s`` to ``end_s`` messages were overdue for ``late_s`` altogether."""

    start_s: float
    end_s: float
    late_s: float


def calm_window(received: Mapping[str, Sequence[Arrival]], span_s: float) -> dict[str, list[Arrival]] | None:
    """Of each topic the messages of ``span_s`` or more, from a prompt one to a prompt one."""
    run = Stretch(
        max(arrivals[0].at_s for arrivals in received.values()),
        min(arrivals[-1].at_s for arrivals in received.values()),
    )
    everything = [arrival for arrivals in received.values() for arrival in arrivals]
    for start_s, end_s in windows(run, stalls(everything)):
        window = {name: prompt_edges(arrivals, start_s, end_s) for name, arrivals in received.items()}
        if all(arrivals and arrivals[-1].at_s - arrivals[0].at_s >= span_s for arrivals in window.values()):
            return window
    return None


def stalls(arrivals: Iterable[Arrival]) -> list[Stall]:
    """When messages were overdue; what is less than ``CALM_S`` apart is one stall."""
    found: list[Stall] = []
    for due_s, at_s in sorted((one.due_s, one.at_s) for one in arrivals if one.late_s > LATE_S):
        if found and due_s <= found[-1].end_s + CALM_S:
            start_s, end_s, late_s = found.pop()
            late_s += max(at_s - max(due_s, end_s), 0.0)
            found.append(Stall(start_s, max(end_s, at_s), late_s))
        else:
            found.append(Stall(due_s, at_s, at_s - due_s))
    return found


def windows(run: Stretch, stalled: Iterable[Stall]) -> Iterator[Stretch]:
    """What lies between stalls that are too long, with its edges in calm."""
    start_s, end_s = run.start_s + CALM_S, run.end_s
    for stall in stalled:
        if stall.start_s <= start_s:
            start_s = max(start_s, stall.end_s + CALM_S)
        elif stall.late_s > LONGEST_STALL_S:
            yield Stretch(start_s, stall.start_s)
            start_s = stall.end_s + CALM_S
        elif stall.end_s > run.end_s - CALM_S:
            end_s = stall.start_s
    yield Stretch(start_s, end_s)


def prompt_edges(arrivals: Iterable[Arrival], start_s: float, end_s: float) -> list[Arrival]:
    """The arrivals from ``start_s`` to ``end_s``, without those at the edges that did not come promptly."""
    inside = [one for one in arrivals if start_s <= one.at_s <= end_s]
    prompt = [index for index, one in enumerate(inside) if one.late_s <= PROMPT_S]
    return inside[prompt[0] : prompt[-1] + 1] if prompt else []

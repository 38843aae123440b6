# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams of a topic, as they go to another pacer and come back."""

from __future__ import annotations

from smarttestudo.domain.compiled_relay import PacedStream
from smarttestudo.pacing.grid import Pace
from smarttestudo.pacing.sample import Sample
from smarttestudo.pacing.stream import PublisherStream


def stream_state(publisher: bytes, stream: PublisherStream) -> PacedStream:
    """All that another pacer needs to go on with the messages of ``publisher``."""
    return PacedStream(
        publisher=publisher,
        due_ns=stream.grid.due_ns,
        phase_ns=stream.grid.phase_ns,
        is_phase_falling=stream.grid.is_phase_falling,
        last_ns=stream.source.last_ns,
        lag_ns=stream.source.lag_ns,
        step_ns=stream.source.step_ns,
        gaps=stream.source.gaps,
        held=None if stream.held is None else stream.held.payload,
        held_ns=stream.held_ns,
    )


def stream_of(state: PacedStream, pace: Pace, now_ns: int) -> PublisherStream:
    """The stream that goes on from ``state``, which followed ``pace``."""
    stream = PublisherStream(pace, now_ns)
    grid = stream.grid
    grid.due_ns, grid.phase_ns, grid.is_phase_falling = state.due_ns, state.phase_ns, state.is_phase_falling
    stream.source.restore(state.last_ns, state.gaps)
    stream.source.lag_ns, stream.source.step_ns = state.lag_ns, state.step_ns
    stream.held_ns = state.held_ns
    if state.held is not None:
        stream.held = Sample(state.held, len(state.held), state.publisher)
    return stream

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams of a topic, as they go to another pacer and come back."""

from __future__ import annotations

from smarttestudo.domain.compiled_relay import PacedStream
from smarttestudo.pacing.grid import Pace
from smarttestudo.pacing.sample import Sample
from smarttestudo.pacing.stream import VolatileStream


def stream_state(publisher: bytes, stream: VolatileStream) -> PacedStream:
    """All that another pacer needs to go on with the messages of ``publisher``."""
    return PacedStream(
        publisher=publisher,
        due_ns=stream.grid.due_ns,
        arrivals_ns=stream.source.arrivals_ns,
        held=None if stream.held is None else stream.held.payload,
        held_ns=stream.held_ns,
    )


def stream_of(state: PacedStream, pace: Pace, now_ns: int) -> VolatileStream:
    """The stream that goes on from ``state``, which followed ``pace``."""
    stream = VolatileStream(pace, now_ns)
    stream.grid.due_ns = state.due_ns
    for arrival_ns in state.arrivals_ns:
        stream.source.record(arrival_ns)
    stream.held_ns = state.held_ns
    if state.held is not None:
        stream.held = Sample(state.held, len(state.held), state.publisher)
    return stream

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics as they go to a compiled relay and come back: with their streams and counts."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.domain.compiled_relay import FlowCounts, PacedStream, RelayCounts, RelayState
from smarttestudo.domain.rate_meter import Flow
from smarttestudo.loop.relay import Relay, Relayed
from smarttestudo.loop.relays import Relays
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.pacing.sample import Sample
from smarttestudo.pacing.stream import PublisherStream
from smarttestudo.pacing.topic_pacer import TopicPacer


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


def hand_over(relays: Relays, topic: str, now_ns: int) -> RelayState:
    """Have ``topic``, of which some messages may be skipped, paced elsewhere: what is known of it."""
    relay = relays.relay(topic)
    assert relay is not None
    assert isinstance(relay.pacer, TopicPacer)
    streams = relay.pacer.hand_over()
    relays.arm(relay)
    pace, statistics = Pace.at(relay.target_hz), relay.statistics
    return RelayState(
        now_ns=now_ns,
        period_ns=pace.period_ns,
        streams=[stream_state(publisher, stream) for publisher, stream in streams.items()],
        counts=RelayCounts(arrived=_counts(statistics.arrived), relayed=_counts(statistics.relayed)),
    )


def take_back(relays: Relays, topic: str, state: RelayState) -> Sequence[Relayed]:
    """Pace ``topic`` again, if it is still relayed, from what became of it; what passes."""
    relay = relays.relay(topic)
    if relay is None:
        return ()
    count(relay, state.counts)
    if not isinstance(relay.pacer, TopicPacer):
        return ()
    pace, now_ns = Pace(state.period_ns), state.now_ns
    streams = {stream.publisher: stream_of(stream, pace, now_ns) for stream in state.streams}
    relayed = relay.relayed(relay.pacer.take_back(streams, now_ns), now_ns)
    relays.arm(relay)
    return relayed


def count(relay: Relay, counts: RelayCounts) -> None:
    """Have the statistics of ``relay`` say what was counted elsewhere."""
    count_flow(relay.statistics.arrived, counts.arrived)
    count_flow(relay.statistics.relayed, counts.relayed)


def unrelayed(arrived: Flow, now_ns: int) -> RelayState:
    """All that is known of a topic that is not relayed, but received: nothing of it passes."""
    return RelayState(
        now_ns=now_ns,
        period_ns=NEVER_NS,
        streams=(),
        counts=RelayCounts(arrived=_counts(arrived), relayed=_counts(Flow())),
    )


def count_flow(flow: Flow, counts: FlowCounts) -> None:
    """Have ``flow`` say what was counted elsewhere."""
    flow.messages, flow.size_bytes = counts.messages, counts.size_bytes
    flow.span_ns, flow.last_ns = counts.span_ns, counts.last_ns


def _counts(flow: Flow) -> FlowCounts:
    return FlowCounts(flow.messages, flow.size_bytes, flow.span_ns, flow.last_ns)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Each message arrives or is missed, whatever a link loses and however late chunks and reports are."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from link.protocol.stepped_wire import MS, TOPICS, Wire

MAP = "/map"
sizes = st.integers(0, 300) | st.integers(0, 20_000)
# What is passed on in one step may be all that is under way.
many = st.integers(1, 5) | st.just(10**6)
steps = st.one_of(
    st.tuples(st.just("put"), st.sampled_from((*TOPICS, MAP)), sizes),
    st.tuples(st.just("pass"), st.integers(0, 60) | st.integers(0, 4_000), st.none()),
    st.tuples(st.just("send"), many, st.none()),
    st.tuples(st.just("arrive"), many, st.none()),
    st.tuples(st.just("report"), st.booleans(), st.none()),
    st.tuples(st.just("hear"), many, st.none()),
    st.tuples(st.just("lose"), many, st.none()),
    st.tuples(st.just("disconnect"), st.none(), st.none()),
)


class LossyWire(Wire):
    """A link whose connection may be cut at any time, so that chunks under way are lost."""

    def act(self, step: str, first: str | int | bool, second: int | None) -> None:
        match step:
            case "pass":
                self.now_ns += int(first) * MS
            case "lose":
                for _ in range(min(int(first), len(self.chunks))):
                    self.chunks.popleft()
            case "disconnect":
                self.sender.disconnect()
            case _:
                super().act(step, first, second)

    def settle(self) -> None:
        """Go on until it is known of each message what became of it."""
        for _ in range(60):
            self.turn()
            self.now_ns += 600 * MS


@given(st.lists(steps, max_size=80))
def test_each_message_arrived_or_was_missed_and_none_was_both(order: list[tuple[str, int, int]]) -> None:
    wire = LossyWire(MAP)
    wire.turn()
    for step in order:
        wire.act(*step)
    wire.settle()
    missed = [(one.origin.topic, one.payload) for one in wire.sender.take_missed(wire.now_ns)]
    assert len(missed) == len({*missed})
    for topic in (*TOPICS, MAP):
        arrived, lost = wire.arrived[topic], {payload for of, payload in missed if of == topic}
        assert len(arrived) == len({*arrived})
        assert {*arrived} & lost == set()
        counts = wire.counts(topic)
        assert len({*wire.offered[topic]} - {*arrived} - lost) <= counts.replaced + counts.overflowed
    # These are never given up: what overflows is counted.
    assert len(wire.arrived["/full"]) + wire.counts("/full").overflowed == len(wire.offered["/full"])
    assert wire.arrived["/full"] == [one for one in wire.offered["/full"] if one in wire.arrived["/full"]]

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator's end that predicts shows, and when it does not predict."""

from __future__ import annotations

import math
from collections.abc import Mapping

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.simulated_link import MS, Link, S
from reckoning.ros_messages import ODOMETRY, TRANSFORMS, odometry, planar, transforms
from smarttestudo.cdr import FrameReader, PoseReader
from smarttestudo.reckoning.motion import Twist, Vector3
from use_cases.receive.predicted_link import PredictedLink

PERIOD_NS = 80 * MS
TYPES = {"/odom": ODOMETRY, "/tf": TRANSFORMS}
EPSILON = 1e-9


def rules(topic: str, bound_m: float) -> str:
    return f"begin SetFrequency {topic} Full KeepWithin {topic} position {bound_m} end"


def place(number: int) -> tuple[float, float]:
    """Where the robot is with its message of that number, and how fast: it hurries, waits and goes back."""
    at_s = number * PERIOD_NS / S
    return math.sin(at_s) + 0.2 * math.sin(5 * at_s), math.cos(at_s) + math.cos(5 * at_s)


def write_odometry(number: int, now_ns: int) -> bytes:
    x, speed = place(number)
    return odometry(now_ns, planar(x, 0, 0), Twist(Vector3(speed, 0, 0), Vector3(0, 0, 0)))


def read_odometry(payload: bytes) -> Mapping[str, float]:
    read = PoseReader(2, has_twist=True).read(payload)
    assert read is not None
    return {"": read[1][0]}


def write_frames(number: int, now_ns: int) -> bytes:
    """Two broadcasters' worth of frames: sometimes one, sometimes the other, sometimes both."""
    x, _ = place(number)
    frames = {"base": planar(x, 0, 0), "arm": planar(-2 * x, 1, 0)}
    names = (["base"], ["arm"], ["base", "arm"], ["base"])[number % 4]
    return transforms(now_ns, {name: frames[name] for name in names})


def read_frames(payload: bytes) -> Mapping[str, float]:
    return {one.child_frame: one.numbers[0] for one in FrameReader().transforms(payload)}


def linked(topic: str, link: Link, bound_m: float) -> PredictedLink:
    write, read = (write_odometry, read_odometry) if topic == "/odom" else (write_frames, read_frames)
    return PredictedLink(topic, TYPES[topic], link, rules(topic, bound_m), write=write, read=read)


events = st.lists(
    st.tuples(
        st.floats(0.5, 7),
        st.one_of(
            st.sampled_from([0.02, 0.05, 0.3]),
            st.sampled_from(["joins", "looks on", "leaves", "pause"]),
        ),
    ),
    max_size=5,
)


@st.composite
def links(draw: st.DrawFn) -> Link:
    """Fast enough for the topic, with up to one outage."""
    steps = [(0.0, 200_000.0)]
    if draw(st.booleans()):
        begin_s = draw(st.integers(8, 40)) / 8
        steps += [(begin_s, 0.0), (begin_s + draw(st.integers(1, 20)) / 8, 200_000.0)]
    return Link(steps, draw(st.floats(0.001, 0.2)))


def happen(run: PredictedLink, what: float | str) -> None:
    if isinstance(what, float):
        run.reload(rules(run.topic, what))
    elif what in {"joins", "looks on"}:
        run.join(predicts=what == "joins")
    elif what == "leaves" and len(run.operators) > 1:
        run.operators[0].hears = False
        run.operators = run.operators[1:]


@settings(max_examples=40)
@given(st.sampled_from(["/odom", "/tf"]), links(), events)
def test_after_every_message_of_the_source_what_an_operator_shows_is_within_the_bound(
    topic: str, link: Link, happened: list[tuple[float, float | str]]
) -> None:
    run = linked(topic, link, 0.05)
    run.join()
    pauses_ns = [int(at_s * S) for at_s, what in happened if what == "pause"]
    for number in range(8 * S // PERIOD_NS):
        at_ns = number * PERIOD_NS
        if not any(begin_ns <= at_ns < begin_ns + S for begin_ns in pauses_ns):
            run.at(at_ns, run.publish)
    for at_s, what in happened:
        run.at(int(at_s * S), lambda what=what: happen(run, what))  # type: ignore[misc]
    run.run(12 * S)
    # Nobody is left behind: what was relayed last came to all, and was judged.
    assert all(operator.newest == run.relayed for operator in run.operators)
    assert {operator.number for operator, sent, _ in run.judged if sent.at_ns > 7 * S} >= {
        operator.number for operator in run.operators
    }
    for _, sent, error in run.judged:
        assert error <= sent.bound + EPSILON


@pytest.mark.parametrize("topic", ["/odom", "/tf"])
def test_dead_reckoning_takes_fewer_messages_than_hold(topic: str) -> None:
    passed = {}
    for predicts in (True, False):
        run = linked(topic, Link([(0.0, 200_000.0)]), 0.05)
        operator = run.join(predicts=predicts)
        for number in range(200):
            run.at(S + number * PERIOD_NS, run.publish)
        run.run(12 * S)
        passed[predicts] = run.passed
        assert operator.is_told is predicts
    assert passed[True] < passed[False]


def test_an_operator_who_only_looks_on_has_all_shown_as_it_is_until_it_leaves() -> None:
    run = linked("/odom", Link([(0.0, 200_000.0)]), 0.05)
    predicting = run.join()
    for number in range(20 * S // PERIOD_NS):
        run.at(number * PERIOD_NS, run.publish)
    run.run(5 * S)
    assert predicting.is_told
    looking = run.join(predicts=False)
    run.run(10 * S)
    assert not predicting.is_told
    assert run.loop.relays.pictures == {}
    looking.hears = False
    run.run(15 * S)
    assert predicting.is_told
    predicting.hears = False
    run.run(20 * S)
    assert run.loop.relays.pictures == {}

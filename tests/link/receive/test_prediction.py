# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator's end that predicts shows, and when it does not predict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from link.protocol.simulated_link import MS, Link, S
from link.receive.predicted_link import PredictedLink
from link.receive.test_reception import Notes
from pacing.reckoning.ros_messages import ODOMETRY, STORE, TRANSFORMS, odometry, planar, transforms
from smarttestudo.cli.receive import reception_lines
from smarttestudo.domain.link import Prediction, ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.chunks import Acknowledgement
from smarttestudo.link.protocol.messages import REPORTS, Report
from smarttestudo.link.receive.prediction import Predictor
from smarttestudo.link.receive.reception import Reception
from smarttestudo.link.zenoh.arrivals import RobotPresence, StreamSaid
from smarttestudo.pacing.cdr import FrameReader, PoseReader
from smarttestudo.pacing.reckoning.motion import Twist, Vector3

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
            st.sampled_from([0.02, 0.05, 0.3]), st.sampled_from(["joins", "looks on", "leaves", "pause"])
        ),
    ),
    max_size=5,
)


@cache
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
# Who joins hears of a new bound before the robot's end hears of who joined.
@example(
    "/tf", Link([(0.0, 200_000.0), (1.0, 0.0), (1.125, 200_000.0)], 0.125), [(1.0, 0.3), (1.25, "joins")]
)
@example("/odom", Link([(0.0, 200_000.0)], 0.015625), [(1.0, 0.3), (1.0, "joins"), (7.0, "leaves")])
def test_after_every_message_of_the_source_what_an_operator_shows_is_within_the_bound(
    topic: str, link: Link, happened: list[tuple[float, float | str]]
) -> None:
    run = linked(topic, link, 0.05)
    run.join()
    pauses_ns = [int(at_s * S) for at_s, what in happened if what == "pause"]
    for number in range(12 * S // PERIOD_NS):
        at_ns = number * PERIOD_NS
        if not any(begin_ns <= at_ns < begin_ns + S for begin_ns in pauses_ns):
            run.at(at_ns, run.publish)
    for at_s, what in happened:
        run.at(int(at_s * S), lambda what=what: happen(run, what))  # type: ignore[misc]
    run.run(15 * S)
    # Nobody is left behind: what was relayed last came to all, and was judged. It takes three seconds until
    # an operator that left without a word is given up, and another one is served.
    assert all(operator.newest == run.robot.relayed for operator in run.operators)
    assert {operator.number for operator, sent, _ in run.judged if sent.at_ns > 11 * S} >= {
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
        passed[predicts] = run.robot.passed
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
    assert run.robot.estimate is None
    looking.hears = False
    run.run(15 * S)
    assert predicting.is_told
    predicting.hears = False
    run.run(20 * S)
    assert run.robot.estimate is None


TOLD = StreamInfo(
    topic="/odom",
    type_name=ODOMETRY,
    qos=Qos(reliable=True, transient_local=False),
    prediction=Prediction(within={"position": 0.05}, heartbeat_hz=0.5),
)
PLAIN = replace(TOLD, prediction=None)
ONWARD = Twist(Vector3(0.5, 0, 0), Vector3(0, 0, 0))


def arrived(stamp_ns: int, x: float = 1.0, age_ns: int = 100 * MS) -> ReceivedMessage:
    payload = odometry(stamp_ns, planar(x, 0, 0), ONWARD)
    return ReceivedMessage(robot="ada", stream=TOLD, payload=payload, offered_ns=0, age_ns=age_ns)


def predicting(stream: StreamInfo = TOLD, source_hz: float | None = 20.0) -> Predictor:
    predictor = Predictor(frozenset({"/odom"}), lambda _robot, _topic: source_hz, lambda _warning: None)
    predictor.handle(StreamSaid(robot="ada", boot="", number=1, info=stream), 0)
    return predictor


def test_a_predicted_message_is_where_the_robot_is_now_with_the_bound_as_covariance() -> None:
    predictor = predicting()
    predictor.handle(arrived(7 * S), 90 * S)
    assert list(predictor.predicted(90 * S)) == []
    (message,) = predictor.predicted(91 * S)
    # A second since it arrived, and 100 ms that it was under way.
    expected: Any = STORE.deserialize_cdr(odometry(8 * S + 100 * MS, planar(1.55, 0, 0), ONWARD), ODOMETRY)
    found: Any = STORE.deserialize_cdr(message.payload, ODOMETRY)
    assert (found.header, found.child_frame_id, message.is_predicted) == (
        expected.header,
        expected.child_frame_id,
        True,
    )
    assert found.pose.pose == expected.pose.pose
    variances = [0.05**2] * 3 + [math.pi**2] * 3
    assert list(found.pose.covariance) == pytest.approx(list(np.diag(variances).flat))


@pytest.mark.parametrize("told_hz", [math.nan, 1e-310, -5.0, 0.0, 0.009, -math.inf, None])
def test_without_a_usable_rate_of_the_source_predicted_messages_come_ten_times_a_second(
    told_hz: float | None,
) -> None:
    predictor = predicting(source_hz=told_hz)
    predictor.handle(arrived(7 * S), 0)
    due_ns = [number * MS for number in range(1000) if list(predictor.predicted(number * MS))]
    assert due_ns == [number * 100 * MS for number in range(1, 10)]


def test_a_bound_whose_square_no_double_holds_is_an_infinite_covariance() -> None:
    prediction = Prediction(within={"position": 1e200, "orientation": 1e300}, heartbeat_hz=0.5)
    predictor = predicting(replace(TOLD, prediction=prediction))
    predictor.handle(arrived(7 * S), 90 * S)
    (message,) = predictor.predicted(91 * S)
    found: Any = STORE.deserialize_cdr(message.payload, ODOMETRY)
    assert np.isposinf(np.diag(found.pose.covariance.reshape(6, 6))).all()


def test_predicted_messages_come_at_the_rate_of_the_source_after_each_that_arrived() -> None:
    predictor = predicting()
    predictor.handle(arrived(7 * S), 0)
    due_ns = [number * MS for number in range(1000) if list(predictor.predicted(number * MS))]
    assert due_ns == [number * 50 * MS for number in range(1, 20)]


def test_nothing_is_predicted_where_the_robot_does_not_reckon_has_left_or_is_silent() -> None:
    for predictor in (predicting(PLAIN), predicting(replace(TOLD, topic="/other"))):
        predictor.handle(arrived(7 * S), 0)
        assert list(predictor.predicted(S)) == []
    predictor = predicting()
    predictor.handle(arrived(7 * S), 0)
    predictor.handle(RobotPresence(robot="ada", boot="", is_present=False), 0)
    assert list(predictor.predicted(S)) == []
    predictor.handle(RobotPresence(robot="ada", boot="", is_present=True), S)
    predictor.handle(arrived(7 * S), S)
    # A heartbeat comes each two seconds.
    assert list(predictor.predicted(4 * S))
    assert list(predictor.predicted(6 * S)) == []


def test_earlier_runs_of_a_robots_end_are_forgotten() -> None:
    predictor = predicting()
    for number in range(100):
        boot = str(number)
        predictor.handle(RobotPresence(robot="ada", boot=boot, is_present=True), 0)
        predictor.handle(StreamSaid(robot="ada", boot=boot, number=1, info=TOLD), 0)
        predictor.handle(replace(arrived(7 * S), boot=boot), 0)
        predictor.handle(RobotPresence(robot="ada", boot=boot, is_present=False), 0)
    predictor.handle(RobotPresence(robot="ada", boot="last", is_present=True), 0)
    assert [boot for _, boot, _ in predictor._streams] == [""]
    assert predictor._absent == set()


def test_a_heartbeat_that_hardly_ever_comes_is_waited_for() -> None:
    prediction = Prediction(within={"position": 0.05}, heartbeat_hz=5e-324)
    predictor = predicting(replace(TOLD, prediction=prediction))
    predictor.handle(arrived(7 * S), 0)
    assert list(predictor.predicted(3_600 * S))


def test_a_stamp_or_a_twist_beyond_all_numbers_is_not_predicted_and_stops_nothing() -> None:
    for stamp_ns, speed in ((2**31 * S - 1, 0.5), (7 * S, 1e150), (7 * S, math.inf)):
        predictor = predicting()
        whirl = Twist(Vector3(speed, 0, 0), Vector3(0, 0, speed))
        payload = odometry(stamp_ns, planar(1, 0, 0), whirl)
        predictor.handle(replace(arrived(7 * S), payload=payload), 0)
        for message in predictor.predicted(S):
            pose = PoseReader(2, has_twist=True).read(message.payload)
            assert pose is not None
            assert math.isnan(pose[1][0])


def test_a_message_without_a_stamp_does_not_say_when_the_robot_is_there() -> None:
    predictor = predicting()
    predictor.handle(arrived(0), 0)
    assert list(predictor.predicted(S)) == []


def test_what_is_predicted_is_given_to_sinks_shown_and_counted_apart() -> None:
    sink = Notes()
    reception = Reception([sink], predicting(PLAIN))
    reception.handle(RobotPresence(robot="ada", boot="", is_present=True), 0)
    reception.handle(StreamSaid(robot="ada", boot="", number=1, info=TOLD), 0)
    reception.handle(arrived(7 * S), 0)
    for number in range(1, 11):
        assert reception.predict(number * 50 * MS) == (number + 1) * 50 * MS
    topic = reception.robots["ada"].topics["/odom"]
    assert (topic.flow.messages, topic.predicted) == (1, 10)
    assert [one.is_predicted for one in sink.taken] == [False, *[True] * 10]
    lines = [line.text.split() for line in reception_lines(reception)]
    assert lines[2][-2:] == ["Predicted", "Type"]
    assert lines[-1][-3:] == ["1", "10", ODOMETRY]


@given(st.frozensets(st.from_regex(r"/[a-z]{1,8}", fullmatch=True), max_size=5), st.booleans())
def test_a_report_says_what_is_predicted_and_an_older_one_says_nothing(
    topics: frozenset[str], has_ages: bool
) -> None:
    report = Report(
        receiver=1,
        received=Acknowledgement(session=2, received_bytes=3),
        ages_ms={4: 5.0} if has_ages else {},
        predicts=topics,
    )
    assert REPORTS.from_bytes(REPORTS.to_bytes(report)) == report
    assert REPORTS.from_bytes(REPORTS.to_bytes(replace(report, predicts=frozenset()))).predicts == frozenset()

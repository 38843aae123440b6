# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The law of dead reckoning: what an operator sees is what the robot's end believes, whatever happens.

It is judged whenever all that the robot's end sent has arrived, by the estimates of both ends and by the
messages that a program at the operator's end would have got, predicted ones included.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from link.protocol.simulated_link import MS, Link, S
from link.receive.predicted_link import Operator, PredictedLink, parts_of, x_of
from link.receive.virtual_source import START_NS, Source, read
from pacing.reckoning.ros_messages import JOINTS, ODOMETRY, TRANSFORMS
from smarttestudo.pacing.reckoning import estimate as estimates
from smarttestudo.pacing.reckoning.estimate import Shown

PERIOD_NS = 80 * MS
SOURCE_HZ = 12.5
DELAY_S = 0.05
END_S = 9
EPSILON = 1e-6
TYPES = {"/odom": ODOMETRY, "/tf": TRANSFORMS, "/joint_states": JOINTS}
PROPERTY = {"/odom": "position", "/tf": "position", "/joint_states": "positions"}


def rules(topic: str, bound: float = 0.05, heartbeat_hz: float = 0.5) -> str:
    return (
        f"begin SetFrequency {topic} Full KeepAtLeast {topic} {heartbeat_hz} "
        f"KeepWithin {topic} {PROPERTY[topic]} {bound} end"
    )


class Bench:
    """A link with one operator's end, and the law, which is judged after everything that happens."""

    def __init__(self, topic: str, *, delay_s: float = DELAY_S, bound: float = 0.05) -> None:
        self.source = Source(topic)
        link = Link([(0.0, 2_000_000.0)], delay_s)
        self.run = PredictedLink(
            topic,
            TYPES[topic],
            link,
            rules(topic, bound),
            write=self.source.write,
            read=lambda payload: read(topic, payload),
        )
        self.delay_s = delay_s
        self.looks = self.moving = self.held = 0
        self.operator = self.run.join(source_hz=SOURCE_HZ)
        self.run.watched = self.judge

    def drive(self, until_s: float = END_S, from_s: float = 0.0) -> None:
        for number in range(int(from_s * S / PERIOD_NS), int(until_s * S / PERIOD_NS)):
            self.run.at(number * PERIOD_NS, self.run.publish)

    def judge(self) -> None:
        """What is sent of a part, what is shown of it and what is believed of it agree."""
        run = self.run
        believed = run.robot.estimate
        for operator in run.operators:
            seen = operator.estimate
            if not operator.is_greeted or not run.robot.is_idle or believed is None or not operator.is_told:
                continue
            assert seen is not None
            shown = parts_of(seen)
            for thing, part in parts_of(believed).items():
                # Of a publisher that is gone nothing is compared any more.
                if part.publisher == run.publisher:
                    self.looks += 1
                    self._same(part, shown[thing])
                    self._seen(operator, part)

    def _same(self, believed: Shown, shown: Shown) -> None:
        assert (believed.moves, believed.motion) == (shown.moves, shown.motion)
        assert (believed.part.frames, believed.part.state) == (shown.part.frames, shown.part.state)
        if believed.moves:
            assert believed.part == shown.part

    def _seen(self, operator: Operator, believed: Shown) -> None:
        run, gauge = self.run, self.run.robot.estimate._gauges[0]  # type: ignore[union-attr]
        part = operator.screen[believed.part.name]
        if not believed.moves:
            self.held += 1
            assert x_of(part.state) == x_of(believed.part.state)
            return
        self.moving += 1
        assert x_of(part.state) == pytest.approx(x_of(believed.at(gauge, part.at_ns)), abs=EPSILON)
        relayed_ns = next(
            at_ns for at_ns, payload in reversed(run.robot.relays) if part.name in run.read(payload)
        )
        elapsed_ns = run.now_ns - relayed_ns
        if elapsed_ns <= 2 * S / run.robot.loop.relays.estimates[run.topic].heartbeat_hz:
            # Until a first round trip is measured, the way back is not known to be in the age.
            late_ns = believed.part.at_ns + elapsed_ns - part.at_ns
            assert late_ns <= PERIOD_NS + 2 * self.delay_s * S + MS


def late_errors(bench: Bench, from_s: float = 1.0) -> list[float]:
    return [error for _, sent, error in bench.run.judged if sent.at_ns > from_s * S]


def predicted_names(bench: Bench, from_s: float, to_s: float = math.inf) -> set[str]:
    return {
        name
        for at_ns, payload in bench.operator.predicted
        if from_s <= at_ns / S < to_s
        for name in read(bench.source.topic, payload)
    }


# Each defect that was there.


@pytest.mark.parametrize("topic", TYPES)
def test_what_has_no_stamp_is_held_at_both_ends_within_the_bound_and_said_once(topic: str) -> None:
    bench = Bench(topic)
    bench.source.has_stamps = False
    bench.drive()
    bench.run.run((END_S + 1) * S)
    errors = late_errors(bench)
    assert len(errors) > 50
    assert max(errors) <= 0.05 + EPSILON
    assert bench.operator.predicted == []
    (warning,) = bench.operator.warnings
    assert warning.startswith(f"{topic} of ada is not predicted: ")
    assert bench.held > 50
    assert bench.moving == 0


@pytest.mark.full
def test_a_frame_is_predicted_after_any_number_of_other_sets_of_frames() -> None:
    bench = Bench("/tf")
    bench.source.names, bench.source.crowd = ["base"], 0
    bench.drive(20)
    seen = []

    def disperse() -> None:
        seen.append(bench.source.crowd)
        bench.source.names, bench.source.crowd = ["tool"], None

    bench.run.at(14 * S, disperse)
    bench.run.run(20 * S)
    assert seen[0] is not None
    assert seen[0] > 64
    # The tool came after all of them. Nothing of the crowd, silent for 4 s, is predicted any more; of
    # the base, a last heartbeat came.
    assert predicted_names(bench, 18.5) == {"base", "tool"}
    assert max(late_errors(bench)) <= 0.05 + EPSILON


@pytest.mark.parametrize("topic", TYPES)
@pytest.mark.parametrize("has_velocities", [False, True])
def test_a_restarted_publisher_is_shown_where_it_is_and_nothing_of_the_one_before(
    topic: str, has_velocities: bool
) -> None:
    bench = Bench(topic)
    bench.source.has_velocities = has_velocities
    bench.drive(4)
    bench.drive(END_S, 4.6)

    def restart() -> None:
        bench.source.shift = 3.0
        bench.run.restart_source()

    bench.run.at(int(4.3 * S), restart)
    bench.run.run((END_S + 1) * S)
    assert max(late_errors(bench)) <= 0.05 + EPSILON
    after = [read(topic, payload) for at_ns, payload in bench.operator.predicted if at_ns > 5 * S]
    assert after
    # Both parts are 3 m on, the second one twice as far; the first robot was within 1.2 m of 0.
    assert min(x for one in after for x in one.values()) > 1.5


@pytest.mark.parametrize("topic", ["/odom", "/joint_states"])
def test_the_last_word_of_a_publisher_that_was_restarted_does_not_come_after_the_next_ones(
    topic: str,
) -> None:
    bench = Bench(topic)
    bench.drive(END_S)

    def restart() -> None:
        bench.source.shift = 3.0
        bench.run.restart_source()

    bench.run.at(4 * S + MS, restart)
    bench.run.run(END_S * S)
    after = [read(topic, payload) for at_ns, payload in bench.run.robot.relays if at_ns > 4 * S + MS]
    assert min(x for one in after for x in one.values()) > 1.5


@pytest.mark.parametrize("topic", ["/tf", "/joint_states"])
def test_nothing_is_predicted_of_a_publisher_that_is_gone(topic: str) -> None:
    bench = Bench(topic)
    bench.source.names = ["base"]
    bench.drive(6)

    def restart() -> None:
        bench.source.names = ["hand"]
        bench.run.restart_source()

    bench.run.at(3 * S, restart)
    bench.run.run(7 * S)
    assert predicted_names(bench, 2, 3) == {"base"}
    # That it is gone is noticed 0.4 s later; its last word, which is a heartbeat, comes all the same.
    last_s = next(
        (
            at_ns / S
            for at_ns, payload in bench.run.robot.relays
            if at_ns > 3 * S and "base" in read(topic, payload)
        ),
        7,
    )
    assert last_s > 4
    assert predicted_names(bench, 3.6, last_s) == {"hand"}


def test_nothing_is_predicted_of_an_earlier_run_of_the_robots_end() -> None:
    bench = Bench("/tf")
    bench.source.names = ["base"]
    bench.drive(6)

    def restart() -> None:
        bench.source.names = ["hand"]
        bench.run.restart_robot()

    bench.run.at(3 * S + MS, restart)
    bench.run.run(7 * S)
    assert predicted_names(bench, 2, 3) == {"base"}
    assert predicted_names(bench, 3.1) == {"hand"}


@pytest.mark.parametrize("topic", TYPES)
def test_where_stamps_jump_what_is_predicted_has_the_new_ones_at_once_also_if_nothing_moves(
    topic: str,
) -> None:
    bench = Bench(topic)
    bench.source.stands = True
    bench.drive()

    def jump() -> None:
        bench.source.offset_ns = -900 * S

    # A heartbeat went out shortly before.
    bench.run.at(int(4.3 * S), jump)
    bench.run.run(END_S * S)
    stamps_s = [
        (at_ns / S, part.at_ns / S)
        for at_ns, payload in bench.operator.predicted
        for part in bench.operator.estimate._gauges[0].read(payload, None, 0) or ()  # type: ignore[union-attr]
    ]
    before = [stamp_s for at_s, stamp_s in stamps_s if at_s < 4.3]
    after = [stamp_s for at_s, stamp_s in stamps_s if at_s > 4.6]
    assert before
    assert after
    assert min(before) > 1_000
    assert max(after) < 110


def test_another_heartbeat_begins_another_picture_as_it_says_which_stamps_have_jumped() -> None:
    bench = Bench("/odom")
    bench.drive()
    numbers = []
    for at_s, heartbeat_hz in ((3, 0.5), (4, 0.5), (5, 2.0)):
        bench.run.run(at_s * S)
        bench.run.reload(rules("/odom", heartbeat_hz=heartbeat_hz))
        numbers.append(bench.run.robot.loop.relays.estimates["/odom"].number)
    assert numbers[0] == numbers[1] < numbers[2]


# The law.

Happening = Callable[[Bench], None]


def _set(name: str, value: object) -> Happening:
    return lambda bench: setattr(bench.source, name, value)


def _join(bench: Bench) -> None:
    bench.run.join(source_hz=SOURCE_HZ)


def _jump(jump_s: float) -> Happening:
    def happen(bench: Bench) -> None:
        bench.source.offset_ns = max(bench.source.offset_ns + int(jump_s * S), 1 - START_NS)

    return happen


HAPPENINGS: Mapping[str, Happening] = {
    "the source restarts": lambda bench: bench.run.restart_source(),
    "the robot's end restarts": lambda bench: bench.run.restart_robot(),
    "another operator comes": _join,
    "no stamps": _set("has_stamps", value=False),
    "stamps": _set("has_stamps", value=True),
    "an hour on": _jump(3_600),
    "a moment on": _jump(1.5),
    "a moment back": _jump(-1.5),
    "far back": _jump(-600),
    "it is somewhere else": _set("shift", value=3.0),
    "other frames of odometry": _set("frames", value=("map", "base")),
    "one frame": _set("names", value=["base"]),
    "other frames": _set("names", value=["arm", "hand", "tool"]),
    "a crowd": _set("crowd", value=0),
    "velocities": _set("has_velocities", value=True),
    "a slow heartbeat": lambda bench: bench.run.reload(rules(bench.source.topic, 0.05, 0.3)),
    "a fast heartbeat": lambda bench: bench.run.reload(rules(bench.source.topic, 0.05, 2.0)),
    "a wide bound": lambda bench: bench.run.reload(rules(bench.source.topic, 0.5)),
}
happenings = st.lists(
    st.tuples(st.floats(0.5, END_S - 1), st.sampled_from([*HAPPENINGS])), min_size=1, max_size=6
)
pauses = st.lists(st.tuples(st.floats(0.5, 7), st.floats(0.2, 5)), max_size=1)


@settings(max_examples=60)
@given(
    st.sampled_from([*TYPES]),
    happenings,
    pauses,
    st.sampled_from([0.002, 0.05, 0.2]),
    st.sampled_from([3, 4096]),
)
@example("/joint_states", [(4.0, "the source restarts"), (4.0, "it is somewhere else")], [], 0.05, 4096)
@example("/odom", [(3.0, "no stamps"), (6.0, "stamps")], [(2.0, 0.5)], 0.05, 4096)
@example("/tf", [(1.0, "a crowd")], [], 0.05, 3)
def test_at_every_instant_the_operator_sees_what_the_robots_end_believes(
    topic: str,
    happened: list[tuple[float, str]],
    paused: list[tuple[float, float]],
    delay_s: float,
    most_parts: int,
) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(estimates, "MAX_PARTS", most_parts)
        bench = Bench(topic, delay_s=delay_s)
        for number in range(END_S * S // PERIOD_NS):
            at_s = number * PERIOD_NS / S
            if not any(begin_s <= at_s < begin_s + length_s for begin_s, length_s in paused):
                bench.run.at(number * PERIOD_NS, bench.run.publish)
        for at_s, name in happened:
            bench.run.at(int(at_s * S), lambda name=name: HAPPENINGS[name](bench))  # type: ignore[misc]
        bench.run.run((END_S + 3) * S)
    assert bench.looks > 0
    for _, sent, error in bench.run.judged:
        assert error <= sent.bound + EPSILON

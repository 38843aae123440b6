# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The law of a bound: after every message of the source, the receiver's estimate is within it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from hypothesis import given
from hypothesis import strategies as st

from pacing.reckoning.ros_messages import ODOMETRY, TRANSFORMS, odometry, planar, transforms
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.properties import gauges_for
from smarttestudo.pacing.bound import HEARTBEAT_HZ, MOST_BOUNDS, BoundRecords
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.reckoning.motion import (
    SpatialPose,
    Twist,
    Vector3,
    moved,
    position_distance_m,
    twist_between,
)
from smarttestudo.pacing.sample import Pass, Sample, StreamKind
from smarttestudo.pacing.topic_pacer import Accuracy, TopicPacer

START_NS = 1_000 * NS_PER_S


@dataclass
class Sent:
    """A message as the tests know it."""

    at_ns: int
    poses: Mapping[str, SpatialPose]
    twist: Twist


@dataclass
class Receiver:
    """A second opinion on what is shown: all that passed, looked up anew each time."""

    reckons: bool
    has_twist: bool
    got: list[Sent] = field(default_factory=list)

    def shows(self, name: str, at_ns: int) -> SpatialPose | None:
        of_name = [one for one in self.got if name in one.poses]
        if not of_name:
            return None
        last = of_name[-1]
        pose, elapsed_s = last.poses[name], (at_ns - last.at_ns) / NS_PER_S
        if not self.reckons:
            return pose
        if self.has_twist:
            return moved(pose, last.twist, elapsed_s)
        if len(of_name) == 1 or of_name[-2].at_ns >= last.at_ns:
            return pose
        since_s = (last.at_ns - of_name[-2].at_ns) / NS_PER_S
        return moved(pose, twist_between(of_name[-2].poses[name], pose, since_s), elapsed_s)

    def error_m(self, sent: Sent) -> float:
        shown = {name: self.shows(name, sent.at_ns) for name in sent.poses}
        return max(
            math.inf if (seen := shown[name]) is None else position_distance_m(pose, seen)
            for name, pose in sent.poses.items()
        )


class Bench:
    """A pacer of a topic with a bound on its position, and a receiver of what it passes."""

    def __init__(self, type_name: str, bound_m: float, *, reckons: bool = False) -> None:
        is_odometry = type_name == ODOMETRY
        kind = StreamKind.VOLATILE if is_odometry else StreamKind.NAMED
        self.pacer = TopicPacer(kind=kind)
        self.receiver = Receiver(reckons, is_odometry)
        self.estimate = Estimate(gauges_for(type_name, ["position"]), reckons=reckons)
        self.records: BoundRecords = {}
        self.of_sample: dict[int, Sent] = {}
        self.passed_ns: list[int] = []
        self._samples: list[Sample] = []
        self._is_odometry = is_odometry
        self.now_ns = START_NS
        self.bind(bound_m)

    def bind(self, bound_m: float, heartbeat_hz: float = HEARTBEAT_HZ) -> None:
        accuracy = Accuracy(
            estimate=self.estimate,
            bounds={"position": bound_m},
            heartbeat_hz=heartbeat_hz,
            records=self.records,
        )
        self._take(self.pacer.set_accuracy(accuracy, self.now_ns))
        self._wake()

    def send(self, after_ns: int, poses: Mapping[str, SpatialPose], twist: Twist) -> Sent:
        until_ns = self.now_ns + after_ns
        while after_ns >= 0 and (wake_ns := self.pacer.wake_ns) is not None and wake_ns <= until_ns:
            self.now_ns = max(self.now_ns, wake_ns)
            self._wake()
        self.now_ns = until_ns
        sent = Sent(until_ns, poses, twist)
        payload = odometry(until_ns, poses[""], twist) if self._is_odometry else transforms(until_ns, poses)
        frames = () if self._is_odometry else tuple(poses)
        readings = self.estimate.read(payload, None, until_ns)
        sample = Sample(payload, len(payload), None, frames, None, readings)
        self._samples.append(sample)  # Kept, so that its identity stays its own.
        self.of_sample[id(sample)] = sent
        self._take(self.pacer.offer(sample, until_ns))
        return sent

    def _wake(self) -> None:
        self._take(self.pacer.wake(self.now_ns))

    def _take(self, passes: Sequence[Pass]) -> None:
        for sample, repeated in passes:
            assert not repeated
            self.receiver.got.append(self.of_sample[id(sample)])
            self.passed_ns.append(self.now_ns)


FRAMES = (["base"], ["arm"], ["base", "arm"], ["arm", "base", "hand"])
steps_m = st.one_of(st.just(0.0), st.floats(-0.05, 0.05), st.floats(-2, 2))
gaps_ns = st.one_of(
    st.just(40_000_000),
    st.integers(1, 200_000_000),
    st.integers(NS_PER_S, 20 * NS_PER_S),
    st.integers(-30 * NS_PER_S, -1),
)
speeds = st.one_of(st.just(0.0), st.floats(-1, 1))
bounds_m = st.sampled_from([0.0, 0.01, 0.05, 0.5])
journeys = st.lists(st.tuples(gaps_ns, steps_m, speeds, st.none() | bounds_m), max_size=40)


def drive(
    bench: Bench,
    journey: Sequence[tuple[int, float, float, float | None]],
    names: Callable[[int], list[str]],
    check: Callable[[Sent, float], None],
    bound_m: float,
) -> None:
    x = 0.0
    for number, (gap_ns, step_m, speed, bound) in enumerate(journey):
        if bound is not None:
            bound_m = bound
            bench.bind(bound)
        x += step_m
        twist = Twist(Vector3(speed, 0, 0), Vector3(0, 0, speed))
        poses = {name: planar(x + place, speed, x) for place, name in enumerate(names(number))}
        check(bench.send(gap_ns, poses, twist), bound_m)


@given(bounds_m, journeys, st.booleans())
def test_after_every_odometry_the_picture_is_within_the_bound(
    bound_m: float, journey: list[tuple[int, float, float, float | None]], reckons: bool
) -> None:
    bench = Bench(ODOMETRY, bound_m, reckons=reckons)

    def within(sent: Sent, bound_m: float) -> None:
        assert bench.receiver.error_m(sent) <= bound_m

    drive(bench, journey, lambda _: [""], within, bound_m)
    assert all(record.broken == 0 for record in bench.records.get("position", {}).values())


@given(bounds_m, journeys, st.booleans(), st.lists(st.sampled_from(FRAMES), min_size=40, max_size=40))
def test_after_every_message_every_frame_in_it_is_within_the_bound(
    bound_m: float,
    journey: list[tuple[int, float, float, float | None]],
    reckons: bool,
    frames: list[list[str]],
) -> None:
    bench = Bench(TRANSFORMS, bound_m, reckons=reckons)

    def within(sent: Sent, bound_m: float) -> None:
        assert bench.receiver.error_m(sent) <= bound_m

    drive(bench, journey, frames.__getitem__, within, bound_m)


@given(bounds_m, journeys, st.sampled_from([1.0, 5.0]))
def test_where_the_ceiling_breaks_the_bound_it_is_counted_exactly(
    bound_m: float, journey: list[tuple[int, float, float, float | None]], ceiling_hz: float
) -> None:
    bench = Bench(ODOMETRY, bound_m)
    bench.pacer.set_rate(ceiling_hz, START_NS)
    broken, worst_m = 0, 0.0

    def count(sent: Sent, bound_m: float) -> None:
        nonlocal broken, worst_m
        error_m = bench.receiver.error_m(sent)
        broken += error_m > bound_m
        worst_m = max(worst_m, error_m)

    drive(bench, journey, lambda _: [""], count, bound_m)
    if journey:
        records = bench.records["position"].values()
        assert sum(record.broken for record in records) == broken
        assert max(record.worst for record in records if record.worst is not None) == worst_m


def test_ever_new_bounds_share_records_that_name_the_widest() -> None:
    bench = Bench(ODOMETRY, 0.05)
    for number in range(200):
        bench.bind(0.05 + number % 67 / 100)
        for step in range(5):
            pose = planar(0.11 * (5 * number + step), 0, 0)
            bench.send(NS_PER_S // 50, {"": pose}, Twist(Vector3(0, 0, 0), Vector3(0, 0, 0)))
    records = bench.records["position"].values()
    assert len(records) == MOST_BOUNDS
    assert all(record.broken == 0 and (record.worst or 0.0) <= record.bound for record in records)
    assert max(record.bound for record in records) == 0.05 + 66 / 100


def test_a_robot_that_stands_still_sends_a_heartbeat_and_no_more() -> None:
    bench = Bench(ODOMETRY, 0.05)
    for _ in range(1000):
        bench.send(NS_PER_S // 50, {"": planar(1, 1, 0)}, Twist(Vector3(0, 0, 0), Vector3(0, 0, 0)))
    assert 10 <= len(bench.passed_ns) <= 12
    gaps = [after - before for before, after in zip(bench.passed_ns, bench.passed_ns[1:], strict=False)]
    assert max(gaps) <= 2 * NS_PER_S


def test_what_the_ceiling_held_back_follows_as_soon_as_it_may() -> None:
    bench = Bench(ODOMETRY, 0.05)
    bench.pacer.set_rate(1.0, START_NS)
    still = Twist(Vector3(0, 0, 0), Vector3(0, 0, 0))
    bench.send(0, {"": planar(0, 0, 0)}, still)
    bench.send(NS_PER_S // 10, {"": planar(0, 0, 0)}, still)
    last = bench.send(NS_PER_S // 10, {"": planar(1, 0, 0)}, still)
    wake_ns = bench.pacer.wake_ns
    assert wake_ns is not None
    assert wake_ns <= START_NS + NS_PER_S
    bench.now_ns = wake_ns
    bench._wake()
    assert bench.receiver.got[-1] is last


def test_a_receiver_that_comes_later_gets_the_newest_at_once() -> None:
    bench = Bench(ODOMETRY, 0.05)
    still = Twist(Vector3(0, 0, 0), Vector3(0, 0, 0))
    for _ in range(3):
        newest = bench.send(NS_PER_S // 10, {"": planar(0, 0, 0)}, still)
    bench.receiver.got.clear()
    bench.pacer.forget_receivers(bench.now_ns)
    bench._wake()
    assert bench.receiver.got == [newest]

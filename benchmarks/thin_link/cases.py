# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is sent over which link, and what an operator should see of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import pairwise

from thin_link.emulated_path import PathConditions, wire
from thin_link.traffic import Topic

WARM_S = 2.0
"""What is not counted at the beginning: nothing is known of the link then."""
_WINDOW_S = 1.0

ODOM = Topic(
    name="/odom", size_bytes=720, hz=25, priority=5, zenoh_priority="INTERACTIVE_HIGH", reliable=True
)
IMU = Topic(name="/imu", size_bytes=320, hz=50, priority=4, zenoh_priority="DATA_HIGH")
SCAN = Topic(name="/scan", size_bytes=3_000, hz=5, priority=4, zenoh_priority="DATA_HIGH")
IMAGE = Topic(name="/image", size_bytes=60_000, hz=10, priority=1, zenoh_priority="DATA_LOW")
SMALL = (ODOM, IMU, SCAN)
HEARTBEAT = Topic(
    name="/heartbeat", size_bytes=100, hz=1, priority=9, zenoh_priority="REAL_TIME", reliable=True, floor_hz=1
)
BURST = Topic(name="/burst", size_bytes=40_000, hz=5, priority=1, zenoh_priority="DATA", from_s=35)
BATTERY = Topic(
    name="/battery", size_bytes=200, hz=1, priority=1, zenoh_priority="REAL_TIME", reliable=True, floor_hz=1
)
CAMERA = Topic(name="/camera", size_bytes=100_000, hz=25, priority=9, zenoh_priority="DATA")
_LARGE_MBIT = 25
# As much of their bytes is noise as makes raw images and clouds fit that link at all.
LARGE = (
    replace(SCAN, hz=8),
    Topic(name="/image", size_bytes=900_000, hz=12, priority=1, zenoh_priority="DATA_LOW", noise=0.35),
    Topic(name="/cloud", size_bytes=7_400_000, hz=1 / 3, priority=2, zenoh_priority="DATA", noise=0.35),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Arrival:
    """A message that arrived: when it was published and when it was there, in s from the start."""

    number: int
    sent_s: float
    at_s: float

    @property
    def age_s(self) -> float:
        """How old it was."""
        return self.at_s - self.sent_s


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """What one contender brought to the operator.

    ``used`` is of what the link does not lose, ``other_share`` of that what went beside. Of each topic the
    robot ``published`` so many messages; of those its end began to send some, and counted others as
    overflowed, where it says so.
    """

    arrived: Mapping[str, Sequence[Arrival]]
    seconds: float
    used: float
    cpu_s_per_mb: float
    other_share: float | None = None
    published: Mapping[str, int] = field(default_factory=dict)
    begun: Mapping[str, int] = field(default_factory=dict)
    overflowed: Mapping[str, int] = field(default_factory=dict)

    def of(self, topic: Topic, from_s: float = WARM_S, to_s: float = float("inf")) -> list[Arrival]:
        """What arrived of a topic in that time."""
        return [one for one in self.arrived.get(topic.name, ()) if from_s <= one.at_s < to_s]

    def rate_hz(self, topic: Topic) -> float:
        """How many messages of a topic arrived in a second while the robot sent them."""
        from_s = max(WARM_S, topic.from_s)
        return len(self.of(topic, from_s, self.seconds)) / (self.seconds - from_s)

    def ages_s(
        self, topics: Sequence[Topic], from_s: float = WARM_S, to_s: float = float("inf")
    ) -> list[float]:
        """How old messages were that arrived in that time, sorted."""
        return sorted(one.age_s for topic in topics for one in self.of(topic, from_s, to_s))


def lost(got: Sequence[Arrival]) -> int:
    """How many messages are missing before the last that arrived; later ones may be under way."""
    return max((one.number + 1 for one in got), default=0) - len({one.number for one in got})


def quantile(values: Sequence[float], share: float) -> float:
    """The value that ``share`` of the sorted ``values`` do not exceed; without values, infinite."""
    return values[min(len(values) - 1, int(len(values) * share))] if values else float("inf")


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A number that should be at least one limit and at most the other."""

    name: str
    value: float
    least: float = -math.inf
    most: float = math.inf

    @property
    def is_met(self) -> bool:
        """Whether it is; what could not be measured missed nothing."""
        return math.isnan(self.value) or self.least <= self.value <= self.most

    @property
    def wanted(self) -> str:
        """The target in words."""
        if self.most == math.inf:
            return self.name if self.least == -math.inf else f"{self.name} ≥ {self.least:g}"
        if self.least <= 0:
            return f"{self.name} ≤ {self.most:g}"
        return f"{self.name} {self.least:g} to {self.most:g}"


class Beside(Enum):
    """The rest that a link carries: a TCP flow that takes what it gets, or a second robot and operator."""

    NOTHING = "nothing"
    FLOW = "flow"
    ROBOT = "robot"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Case:
    """One link and its traffic. ``course`` has its conditions from each time on; ``None`` is no link."""

    title: str
    topics: Sequence[Topic]
    course: Sequence[tuple[float, PathConditions | None]]
    seconds: float
    judge: Callable[[Seen], list[Target]]
    beside: Beside = Beside.NOTHING
    takes_minutes: bool = False

    def capacity_bytes(self, from_s: float, to_s: float) -> float:
        """The bytes that the link can carry in that time, and does not lose."""
        ends = [*(at_s for at_s, _ in self.course[1:]), math.inf]
        spans = (
            (max(0.0, min(end_s, to_s) - max(at_s, from_s)), conditions)
            for (at_s, conditions), end_s in zip(self.course, ends, strict=True)
        )
        return sum(
            span_s * one.rate_bits_per_s / 8 * (1 - one.loss) for span_s, one in spans if one is not None
        )


def _mbit(*steps: tuple[float, float]) -> list[tuple[float, PathConditions | None]]:
    """A link that loses nothing, with a rate in Mbit/s from each time on; 0 is no link."""
    return [(at_s, wire(rate * 1e6) if rate else None) for at_s, rate in steps]


def _judge_thin(seen: Seen) -> list[Target]:
    return [
        *(
            Target(name=f"{one.name} p95 s", value=quantile(seen.ages_s([one]), 0.95), most=0.15)
            for one in SMALL
        ),
        Target(name="/image p95 s", value=quantile(seen.ages_s([IMAGE]), 0.95), most=0.6),
        Target(name="link used", value=seen.used, least=0.9),
    ]


_FALLS_S, _RISES_S = 7.0, 15.0


def _judge_step(seen: Seen) -> list[Target]:
    ends_s = [_RISES_S + 0.1 * step for step in range(10, 60)]
    enough = 0.9 * IMAGE.hz * _WINDOW_S
    back = (end for end in ends_s if len(seen.of(IMAGE, end - _WINDOW_S, end)) >= enough)
    low = [quantile(seen.ages_s([one], _FALLS_S, _RISES_S), 0.95) for one in SMALL]
    return [
        Target(
            name="small at the fall, max s",
            value=quantile(seen.ages_s(SMALL, _FALLS_S, _FALLS_S + 2), 1.0),
            most=0.6,
        ),
        Target(name="small while low, p95 s", value=max(low), most=0.25),
        Target(name="90 % of the images again after s", value=next(back, float("inf")) - _RISES_S, most=3.0),
    ]


_CUT_S, _BACK_S, _ROUND_TRIP_S = 5.0, 15.0, 0.15


def _judge_outage(seen: Seen) -> list[Target]:
    late = [first[0].age_s - 1 / one.hz for one in SMALL if (first := seen.of(one, _BACK_S))]
    newest = quantile(seen.ages_s(SMALL, _BACK_S), 1.0)
    again = [one.at_s for one in seen.of(ODOM, _BACK_S)]
    return [
        Target(
            name="first message of small, age beyond a period s",
            value=max(late, default=float("inf")),
            most=_ROUND_TRIP_S,
        ),
        Target(name="small after it, max s", value=newest, most=1 / SCAN.hz + _ROUND_TRIP_S),
        Target(name="first message after s", value=min(again, default=float("inf")) - _BACK_S, most=3.0),
    ]


def _judge_idle(seen: Seen) -> list[Target]:
    # The last may be under way.
    burst = len(seen.of(BURST, BURST.from_s, BURST.from_s + 2.0))
    return [
        Target(name="heartbeats lost", value=lost(seen.of(HEARTBEAT, 0)), most=0),
        Target(name="share of the burst in 2 s", value=burst / (2 * BURST.hz), least=0.9),
    ]


def _judge_floor(seen: Seen) -> list[Target]:
    got = seen.of(BATTERY, 0)
    gaps_s = [after.at_s - before.at_s for before, after in pairwise(got)]
    targets = [
        Target(name="floor topic lost", value=lost(got), most=0),
        Target(name="its longest gap s", value=max(gaps_s, default=float("inf")), most=2 / BATTERY.hz),
    ]
    if seen.other_share is not None:
        targets.append(Target(name="TCP flow's share", value=seen.other_share, least=0.4))
    return targets


def _judge_large(seen: Seen) -> list[Target]:
    _, image, cloud = LARGE
    gaps_s = [after.at_s - before.at_s for before, after in pairwise(seen.of(cloud, 0))]
    return [
        Target(name="images Hz", value=len(seen.of(image)) / (seen.seconds - WARM_S), least=4.4),
        Target(name="longest gap between clouds s", value=max(gaps_s, default=float("inf")), most=3.5),
        Target(name="bytes in whole messages", value=_whole_share(seen), least=0.95),
    ]


def _whole_share(seen: Seen) -> float:
    """What arrived in whole messages, compressed to its noise, of the bytes that the link carried."""
    whole = sum(len(seen.of(one, WARM_S, seen.seconds)) * one.size_bytes * one.noise for one in LARGE)
    return whole / (seen.used * _LARGE_MBIT * 1e6 / 8 * (seen.seconds - WARM_S))


CASES: Mapping[str, Case] = {
    "thin": Case(
        title="2 Mbit/s, 5 offered",
        topics=(*SMALL, IMAGE),
        course=_mbit((0, 2)),
        seconds=20,
        judge=_judge_thin,
    ),
    "step": Case(
        title="8, 0.8 and again 8 Mbit/s, 5 offered",
        topics=(*SMALL, IMAGE),
        course=_mbit((0, 8), (_FALLS_S, 0.8), (_RISES_S, 8)),
        seconds=22,
        judge=_judge_step,
    ),
    "outage": Case(
        title="2 Mbit/s, and 10 s without a link",
        topics=(*SMALL, IMAGE),
        course=_mbit((0, 2), (_CUT_S, 0), (_BACK_S, 2)),
        seconds=25,
        judge=_judge_outage,
    ),
    "idle": Case(
        title="2 Mbit/s, 35 s of heartbeats, then 1.6 Mbit/s",
        topics=(HEARTBEAT, BURST),
        course=_mbit((0, 2)),
        seconds=40,
        judge=_judge_idle,
    ),
    "overload": Case(
        title="2 Mbit/s, 20 offered, a floor for one topic",
        topics=(BATTERY, CAMERA),
        course=_mbit((0, 2)),
        seconds=60,
        judge=_judge_floor,
        takes_minutes=True,
    ),
    "beside": Case(
        title="The same beside a TCP flow",
        topics=(BATTERY, CAMERA),
        course=_mbit((0, 2)),
        seconds=20,
        judge=_judge_floor,
        beside=Beside.FLOW,
    ),
    "large": Case(
        title="25 Mbit/s, large messages, 106 offered before compression",
        topics=LARGE,
        course=_mbit((0, _LARGE_MBIT)),
        seconds=20,
        judge=_judge_large,
    ),
}

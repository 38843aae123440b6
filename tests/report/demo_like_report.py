# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A report of the size and shape of the demo's: 200 s, nine topics, two zones, a round through both."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from functools import cache
from itertools import pairwise

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, AccuracyPoint, BoundCost, FixedPicture, Motion
from smarttestudo.accuracy.arms import PacedPicture
from smarttestudo.accuracy.loss_report import (
    Age,
    Carried,
    ErrorSize,
    FieldError,
    FieldLoss,
    LossReport,
    TopicArm,
    TopicLoss,
)
from smarttestudo.bags.comparison import compare, mean_target, target_spans
from smarttestudo.bags.robot_path import PathPoint
from smarttestudo.bags.statistics import RecordingSpan, TraceAccumulator, topic_statistics
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, Obstacle, ObstacleKind, Rectangle
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.remote_robots import RuleText
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.report.rule_timeline import by_topic
from smarttestudo.report.run_report import (
    Fact,
    RunReport,
    TopicHistory,
    TopicSeries,
    bandwidth_series,
    rate_series,
)

START_NS = 1_795_230_365_474_043_000
SECONDS = 200.0
SPAN = RecordingSpan(start_ns=START_NS, end_ns=START_NS + ns_from_s(SECONDS))
CORRIDOR, SCAFFOLDING = "Warehouse Corridor", "Scaffolding"

SOURCES = {
    "/odom": (25.5, 720),
    "/cmd_vel": (10.0, 52),
    "/scan": (5.0, 2_940),
    "/camera/camera_info": (29.0, 380),
    "/camera/image_raw": (29.0, 6_220_000),
    "/camera/image_raw/compressed": (28.0, 420_000),
    "/imu": (195.0, 320),
    "/joint_states": (5.0, 120),
    "/tf": (30.0, 170),
}
DEFAULTS_HZ = dict(zip(SOURCES, (10, 7, 3, 3, 3, 3, 10, 3, 10), strict=True))
BLOCKS = {
    CORRIDOR: (14, {"/odom": 4, "/cmd_vel": 4, "/scan": 4}),
    SCAFFOLDING: (25, {"/odom": 10, "/cmd_vel": 10, "/scan": 10, "/camera/image_raw/compressed": 10}),
}
_ARMS = {"sent": 5100, "received": 1689, "fixed": 1500}
VISITS = ((31.25, CORRIDOR), (81.5, SCAFFOLDING), (143.75, None))

RULES = """begin
    // What an operator needs at rest
    SetFrequency /odom 10
    SetFrequency /cmd_vel 7
    SetFrequency /scan 3
    SetFrequency /camera/camera_info 3
    SetFrequency /camera/image_raw 3
    SetFrequency /camera/image_raw/compressed 3
    SetFrequency /imu 10
    SetFrequency /joint_states 3
    SetFrequency /tf 10

    // Nobody walks here
    Rule "Warehouse Corridor"
    If (CheckValue /odom pose_y > 1 AND CheckValue /odom pose_y < 5.4
        AND CheckValue /odom pose_x > -13 AND CheckValue /odom pose_x < 6)
    Then
        SetFrequency /odom 4
        SetFrequency /cmd_vel 4
        SetFrequency /scan 4
    EndIf

    // People work overhead: every centimetre counts
    Rule "Scaffolding"
    If (CheckValue /odom pose_y > 6 AND CheckValue /odom pose_y < 25.5
        AND CheckValue /odom pose_x > -13 AND CheckValue /odom pose_x < 6)
    Then
        SetFrequency /odom 10
        SetFrequency /cmd_vel 10
        SetFrequency /scan 10
        SetFrequency /camera/image_raw/compressed 10
    EndIf
end
"""

_ROUND_M = (
    (7.5, 0),
    (7.5, 3),
    (-2.5, 3),
    (-2.5, 8.5),
    (-0.5, 10),
    (2, 8.5),
    (4.5, 10),
    (7, 8.8),
    (10.8, 8.8),
    (10.8, -1),
)
_WALLS_M = (
    (-13.2, 14.2, -8.2, -8.0),
    (-13.2, 14.2, 25.5, 25.7),
    (-13.2, -13.0, -8.2, 25.7),
    (14.0, 14.2, -8.2, 25.7),
    (-13.0, -8.0, 0.8, 1.0),
    (-6.8, 6.0, 0.8, 1.0),
    (-13.0, -3.3, 5.6, 5.8),
    (-1.7, 6.0, 5.6, 5.8),
)
_RACKS_M = (
    (-11.0, -5.6, -6.5, -5.4),
    (-3.5, 1.9, -3.2, -2.1),
    (8.5, 9.6, -2.0, 2.5),
    (12.8, 13.9, 4.0, 9.4),
    (8.5, 9.6, 12.0, 20.0),
)


@cache
def demo_like_report() -> RunReport:
    decisions = _decisions()
    before = {topic: _source(topic) for topic in SOURCES}
    after = {topic: _relayed(topic, [one for one in decisions if one.topic == topic]) for topic in SOURCES}
    comparison = compare(
        {topic: topic_statistics(trace, SPAN, declared="image" in topic) for topic, trace in before.items()},
        {topic: topic_statistics(trace, SPAN, declared="image" in topic) for topic, trace in after.items()},
        {
            topic: mean_target(target_spans(own, SECONDS), SOURCES[topic][0])
            for topic, own in by_topic(decisions).items()
        },
    )
    series = tuple(
        TopicSeries(topic=topic, before=_history([before[topic]]), after=_history([after[topic]]))
        for topic in SOURCES
    )
    total = TopicSeries(
        topic="All topics", before=_history(list(before.values())), after=_history(list(after.values()))
    )
    return RunReport(
        title="A TurtleBot3 patrols a warehouse",
        duration_s=SECONDS,
        comparison=comparison,
        series=series,
        total=total,
        loss=_loss(),
        accuracy_curve=demo_like_accuracy(),
        decisions=decisions,
        rules=(RuleText(name="examples/warehouse.adirf", text=RULES),),
        provenance=(
            Fact(label="Source recording", value="demo-out/baseline"),
            Fact(label="SmartTestudo recording", value="demo-out/adaptive"),
            Fact(label="Seed", value="1"),
            Fact(label="SmartTestudo", value="0.1.0"),
        ),
        floor_plan=_floor_plan(),
        path=_path(),
    )


def small_report() -> RunReport:
    """The same with a point of its lines every 20 s and one of its path every 2 s."""

    def history(one: TopicHistory) -> TopicHistory:
        return replace(one, rate_hz=one.rate_hz[::20], kb_per_s=one.kb_per_s[::20])

    def series(one: TopicSeries) -> TopicSeries:
        return replace(one, before=history(one.before), after=history(one.after))

    report = demo_like_report()
    return replace(
        report, series=tuple(map(series, report.series)), total=series(report.total), path=report.path[::51]
    )


def _history(traces: list[TraceAccumulator]) -> TopicHistory:
    rate_hz = rate_series(traces[0], SPAN) if len(traces) == 1 else ()
    return TopicHistory(rate_hz=rate_hz, kb_per_s=bandwidth_series(traces, SPAN))


def _loss() -> LossReport:
    """The position of /odom, 1.2 cm off along x and 0.5 cm along y; 4 mm in all at fixed rates."""

    def error(rmse: float) -> FieldError:
        size = ErrorSize(rmse=rmse, maximum=3 * rmse, relative_rmse=rmse / 20, relative_maximum=3 * rmse / 20)
        return FieldError(hold=size, interpolated=size)

    age = Age(mean_s=0.1, p95_s=0.2, max_s=0.3)
    arms = {name: TopicArm(messages=count, size_bytes=720 * count, age=age) for name, count in _ARMS.items()}
    return LossReport(
        a="demo-out/baseline",
        b="demo-out/adaptive",
        duration_s=SECONDS,
        topics=(
            TopicLoss(
                topic="/odom",
                received_topic="/odom",
                type_name="nav_msgs/msg/Odometry",
                fixed_hz=20.0,
                **arms,
            ),
        ),
        fields=tuple(
            FieldLoss(
                topic="/odom",
                field=name,
                unit="m",
                value_range=20.0,
                received=error(rmse),
                fixed=error(fixed),
            )
            for name, rmse, fixed in (("pose_x", 0.012, 0.004), ("pose_y", 0.005, 0.0))
        ),
        crossings=(),
        images=(),
        carried=Carried(sent_bytes=3_600_000, received_bytes=1_200_000, fixed_bytes=1_100_000),
    )


def _decisions() -> tuple[Decision, ...]:
    found = []
    plan: dict[str, tuple[float, str | None]] = {}
    for t_s, visited in ((0.0, SCAFFOLDING), (0.54, None), *VISITS):
        line, block_hz = BLOCKS[visited] if visited else (None, {})
        for topic, default_hz in DEFAULTS_HZ.items():
            to_hz = block_hz.get(topic, default_hz)
            rule = visited if topic in block_hz else None
            if plan.get(topic) == (to_hz, rule):
                continue
            start = topic not in plan
            reason = Reason.DEFAULT if rule is None else Reason.UNKNOWN if start else Reason.BLOCK
            found.append(
                Decision(
                    t_s=t_s,
                    stamp_ns=START_NS + ns_from_s(t_s),
                    topic=topic,
                    from_rate=None if start else Rate(plan[topic][0]),
                    planned=PlannedRate(
                        rate=Rate(to_hz), reason=reason, rule=rule, line=line if rule else None
                    ),
                    values=dict.fromkeys(("/odom pose_x", "/odom pose_y"), None if start else 2.1)
                    if rule
                    else {},
                )
            )
            plan[topic] = (to_hz, rule)
    return tuple(found)


def _source(topic: str) -> TraceAccumulator:
    rate_hz, size_bytes = SOURCES[topic]
    noise = random.Random(topic)
    trace = TraceAccumulator()
    for index in range(int(SECONDS * rate_hz)):
        trace.add(START_NS + int((index + 0.2 * noise.random()) / rate_hz * NS_PER_S), size_bytes)
    return trace


def _relayed(topic: str, decisions: list[Decision]) -> TraceAccumulator:
    """Every message that falls on a grid of the planned rate."""
    rate_hz, size_bytes = SOURCES[topic]
    trace = TraceAccumulator()
    ends_s = [*(one.t_s for one in decisions[1:]), SECONDS]
    for decision, end_s in zip(decisions, ends_s, strict=True):
        paced_hz = min(rate_hz, decision.planned.rate.hz)
        for index in range(int((end_s - decision.t_s) * paced_hz)):
            trace.add(START_NS + ns_from_s(decision.t_s + index / paced_hz), size_bytes)
    return trace


def _floor_plan() -> FloorPlan:
    walls = (
        Obstacle(kind=ObstacleKind.WALL, footprint=_rectangle(*sides), height_m=4.0) for sides in _WALLS_M
    )
    racks = (
        Obstacle(kind=ObstacleKind.RACK, footprint=_rectangle(*sides), height_m=2.5) for sides in _RACKS_M
    )
    return FloorPlan(
        obstacles=(*walls, *racks),
        zones=(
            FloorZone(name=CORRIDOR, area=_rectangle(-13.0, 6.0, 1.0, 5.4)),
            FloorZone(name=SCAFFOLDING, area=_rectangle(-13.0, 6.0, 6.0, 25.5)),
        ),
    )


def _path() -> tuple[PathPoint, ...]:
    """25.5 places a second along the round, at a constant speed."""
    lengths_m = [math.dist(a, b) for a, b in pairwise(_ROUND_M)]
    count = int(SECONDS * 25.5)
    speed_m = sum(lengths_m) / count
    points, index, along_m = [], 0, 0.0
    for step in range(count):
        while index < len(lengths_m) - 1 and along_m > lengths_m[index]:
            along_m -= lengths_m[index]
            index += 1
        (x0, y0), (x1, y1) = _ROUND_M[index : index + 2]
        share = along_m / lengths_m[index]
        points.append(PathPoint(t_s=step / 25.5, x_m=x0 + share * (x1 - x0), y_m=y0 + share * (y1 - y0)))
        along_m += speed_m
    return tuple(points)


def _rectangle(min_x_m: float, max_x_m: float, min_y_m: float, max_y_m: float) -> Rectangle:
    return Rectangle(min_x_m=min_x_m, max_x_m=max_x_m, min_y_m=min_y_m, max_y_m=max_y_m)


def demo_like_accuracy() -> AccuracyCurve:
    """The position of a robot at constant speed: with hold a bound gains little, with dead reckoning much."""
    sent = {0.01: (764, 35), 0.02: (509, 33), 0.05: (254, 31), 0.1: (139, 31), 0.2: (73, 31)}
    return AccuracyCurve(
        topic="/odom",
        property_name="position",
        unit="m",
        messages=1530,
        source_hz=25.5,
        motion=Motion(mean_per_s=0.248, max_per_s=0.25),
        points=tuple(
            AccuracyPoint(bound=bound, hold=_cost(bound, held, 1.2), reckoned=_cost(bound, reckoned, 4.0))
            for bound, (held, reckoned) in sent.items()
        ),
    )


def _cost(bound: float, messages: int, worse: float) -> BoundCost:
    close, far = 0.99 * bound, worse * bound
    return BoundCost(
        within=PacedPicture(messages=messages, rmse=close / 2, worst=close, unknown=0),
        fixed=FixedPicture(hz=messages / 60, messages=messages, rmse=far / 2, worst=far, unknown=0),
    )

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of a fleet's recordings, without recordings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from smarttestudo.bags.statistics import RecordingSpan
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.report.fleet.numbers import Received, RecordingNumbers, RuleNumbers, TopicNumbers
from smarttestudo.report.fleet.page import FleetReport, OwnReport
from smarttestudo.report.fleet.totals import FleetTotals
from smarttestudo.report.run_report import Fact
from smarttestudo.report.summary import PositionError

MONDAY_S = 1_793_577_600
"""2 November 2026."""
DAY_S = 86_400
_TOPICS = {"/odom": 700, "/scan": 3000, "/camera/image_raw": 90_000, "/imu": 320, "/battery_state": 80}


def recording(
    robot: int, day: int, *, shift: int = 0, is_pair: bool = True, topics: int = 5
) -> RecordingNumbers:
    """An hour of ``robot``, of which the more is lost the higher its number and the later the day."""
    kept = 1 / (1 + robot + day % 7)
    names = [*_TOPICS.items(), *((f"/sensor_{number}", 100) for number in range(topics))][:topics]
    place = f"ada-{robot:02}/day-{day:03}-{shift:02}"
    return RecordingNumbers(
        a=f"fleet/{place}",
        b=f"received/{place}" if is_pair else None,
        robot=f"ada-{robot:02}",
        span=span_from(MONDAY_S + day * DAY_S + shift * 600 + robot),
        topics=tuple(_topic(name, size * 1000, kept, is_pair=is_pair) for name, size in names),
        rules=tuple(
            RuleNumbers(
                rule=rule,
                decided_s=1800.0,
                decisions=3,
                messages=5000,
                size_bytes=10**8,
                received_messages=int(5000 * kept) if is_pair else None,
                received_bytes=int(10**8 * kept) if is_pair else None,
            )
            for rule in ("", "Near people")
        ),
        position=PositionError(topic="/odom", received_m=1 - kept, fixed_m=None) if is_pair else None,
    )


def span_from(start_s: int) -> RecordingSpan:
    """An hour."""
    return RecordingSpan(start_ns=start_s * NS_PER_S, end_ns=(start_s + 3600) * NS_PER_S)


def _topic(name: str, size_bytes: int, kept: float, *, is_pair: bool) -> TopicNumbers:
    received = Received(
        messages=int(1000 * kept), size_bytes=int(size_bytes * kept), age_mean_s=0.5, age_max_s=4 / kept
    )
    return TopicNumbers(
        topic=name, messages=1000, size_bytes=size_bytes, received=received if is_pair else None
    )


def recordings(count: int, *, robots: int = 12, is_pair: bool = True) -> Iterator[RecordingNumbers]:
    """``count`` of them, day after day, with five of each robot a day."""
    for number in range(count):
        day, of_day = divmod(number, 5 * robots)
        shift, robot = divmod(of_day, robots)
        yield recording(robot, day, shift=shift, is_pair=is_pair)


def fleet_report(count: int = 240, *, is_pair: bool = True, path: str = "/data") -> FleetReport:
    """The contents of the page over ``count`` recordings and two files that cannot be read."""
    totals = FleetTotals(are_pairs=is_pair)
    for number, one in enumerate(recordings(count, is_pair=is_pair)):
        noted = replace(one, notices=("damaged: the last second is missing",)) if number == 3 else one
        totals.add(noted)
    totals.failures.add("fleet/ada-03/a.mcap: error: the file is empty; give a rosbag2 folder")
    totals.failures.add("fleet/ada-04/b.mcap: error: not a recording; give a rosbag2 folder")

    def own_report(one: RecordingNumbers) -> OwnReport:
        command = f"testudo bag report {path}/{one.a} {path}/{one.b} -o {path}/{one.robot}-0a1b2c3d.html"
        return OwnReport(
            command=command, file_name=f"{one.robot}-0a1b2c3d.html", is_made=one.robot.endswith("1")
        )

    return FleetReport(
        title="fleet beside received",
        totals=totals,
        own_report=own_report,
        provenance=(Fact(label="A", value="fleet"),),
    )

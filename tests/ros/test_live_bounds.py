# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A bound of the operator's picture on a real graph, judged by an operator who hears the source too.

The operator's process has every message of the source and every relayed one. The picture after a message of
the source is the newest relayed message that is not younger than it, by their stamps: that is what is shown
when all has come that was relayed up to that message. So what a relayed message takes to come, which the
robot's end cannot know, moves no message into the picture or out of it; it is told as the delay of the
messages that mended the picture, and not judged.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import pytest

from ros.ros_processes import Process, SmallRobot
from ros.test_reload import replace_text

HZ = 25
SPEED_M_PER_S = 0.4
ODOMETRY = {"type": "nav_msgs/msg/Odometry", "hz": HZ, "twist": [SPEED_M_PER_S, 0.2]}
ENOUGH = 75
"""Messages in each part of a run: at this speed at least five have to pass even with the widest bound."""
ATTEMPTS = 5
LOST = "before they could be relayed"


class Heard(NamedTuple):
    """A message as it came to the operator's process; times are of one clock."""

    at_s: float
    due_s: float
    x: float
    y: float


@dataclass(frozen=True)
class Part:
    """Messages that were due after ``since_s`` and until ``until_s`` are judged by ``bound_m``."""

    since_s: float
    until_s: float
    bound_m: float


@dataclass(frozen=True)
class Judged:
    """What one operator's picture was in one part; delays are those of the messages that made it."""

    bound_m: float
    messages: int
    relayed: int
    worst_m: float
    longest_delay_s: float


class Run:
    """A robot that drives, and its operators."""

    def __init__(self, robot: SmallRobot) -> None:
        self.robot = robot
        self.source = robot.source(odom=ODOMETRY)
        self.source.line_with("ready")
        self.rule_file = robot.folder / "bounds.adirf"
        replace_text(self.rule_file, rules(0.05))
        self.runtime = robot.testudo_run("--rules", str(self.rule_file))
        self.watchers = [robot.watcher()]
        self.parts: list[Part] = []
        self.bound_m = 0.05
        self.since_s = -math.inf

    def drive(self) -> None:
        """Let every operator compare enough messages."""
        for watcher in self.watchers:
            for _ in range(ENOUGH):
                watcher.line_with("heard")

    def reload(self, bound_m: float) -> None:
        """Another bound. What may have been judged by either of both has the wider one."""
        relayed_s = max(self.relayed_s(watcher) for watcher in self.watchers)
        replace_text(self.rule_file, rules(bound_m))
        self.runtime.line_with("rules reloaded")
        since_s = time.monotonic()
        self.parts.append(Part(self.since_s, relayed_s, self.bound_m))
        self.parts.append(Part(relayed_s, since_s, max(self.bound_m, bound_m)))
        self.bound_m, self.since_s = bound_m, since_s

    def judged(self) -> list[list[Judged]]:
        """Of each operator each part; the robot's end has told by then what it lost in the last one."""
        self.parts.append(Part(self.since_s, time.monotonic(), self.bound_m))
        self.drive()
        return [[judge(watcher, part) for part in self.parts] for watcher in map(self.heard, self.watchers)]

    @staticmethod
    def relayed_s(watcher: Process) -> float:
        watcher.say("relayed")
        return float(watcher.line_with("relayed").split()[1])

    @staticmethod
    def heard(watcher: Process) -> tuple[list[Heard], list[Heard]]:
        result = watcher.result("stop")
        return [Heard(*one) for one in result["source"]], [Heard(*one) for one in result["relayed"]]


def rules(bound_m: float) -> str:
    """A heartbeat once in 1000 s: what passes does because of the bound."""
    return f"""begin
    SetFrequency /odom Full
    KeepWithin /odom position {bound_m}
    KeepAtLeast /odom 0.001
end"""


def judge(heard: tuple[Sequence[Heard], Sequence[Heard]], part: Part) -> Judged:
    """How far the picture was off after each message of the source, from the first relayed one on."""
    source, relayed = heard
    came_s = {one.due_s: one.at_s for one in source}
    errors_m, delays_s, shown = [], [], 0
    for one in source:
        if not (part.since_s < one.due_s <= part.until_s) or one.due_s < relayed[0].due_s:
            continue
        while shown + 1 < len(relayed) and relayed[shown + 1].due_s <= one.due_s:
            shown += 1
        errors_m.append(math.dist(one[2:], relayed[shown][2:]))
        if relayed[shown].due_s == one.due_s:
            delays_s.append(relayed[shown].at_s - came_s[one.due_s])
    return Judged(
        part.bound_m,
        len(errors_m),
        len(delays_s),
        max(errors_m, default=0.0),
        max(delays_s, default=0.0),
    )


def drive_with_everything_that_happens(robot: SmallRobot) -> Run:
    run = Run(robot)
    run.drive()
    run.reload(0.02)
    run.drive()
    run.reload(0.12)
    run.drive()
    # Nothing passes of a robot that stands still, so what a late joiner gets was sent because it joined.
    run.source.say("halt odom")
    run.watchers[0].line_with("heard")
    late = robot.watcher()
    late.line_with("heard")
    run.watchers.append(late)
    run.source.say("drive odom")
    run.drive()
    run.source.say("hush odom")
    run.watchers.append(robot.watcher())
    run.source.say("speak odom")
    run.drive()
    return run


@pytest.mark.calm
def test_the_picture_is_within_its_bound_through_reloads_late_joiners_and_a_pause(robot: SmallRobot) -> None:
    for _ in range(ATTEMPTS):
        run = drive_with_everything_that_happens(robot)
        judged = run.judged()
        has_lost = any(LOST in line for line in run.runtime.output)
        robot.end()
        if has_lost:
            # The source's queue ran over while this machine stood still: the robot's end had no such message.
            continue
        for part in (part for parts in judged for part in parts):
            assert part.worst_m <= part.bound_m, judged
        first, _, tighter, _, wider = judged[0]
        assert min(part.messages for part in (first, tighter, wider)) >= ENOUGH // 2
        # Each bound is made use of: no more passes than it asks for.
        assert tighter.worst_m <= 0.02 < first.worst_m <= 0.05 < wider.worst_m, judged
        for part in (first, tighter, wider):
            assert part.relayed <= 1 + part.messages * SPEED_M_PER_S / HZ / part.bound_m * 2, judged
        assert all(parts[-1].messages >= ENOUGH for parts in judged[1:])
        return
    pytest.fail(f"machine too slow: {ATTEMPTS} times messages were lost before they were judged")

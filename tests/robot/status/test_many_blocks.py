# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A status of many blocks: bounded, made in slices, and of one moment."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from loop.loop_driver import SECOND, LoopDriver
from robot.memory_link import MemoryLink
from robot.status.statuses import STATUS
from robot.status.virtual_robot import VirtualRobot
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.record import to_json
from smarttestudo.domain.status import MOST_BLOCKS, RuntimeStatus, status_from_text
from smarttestudo.loop.block_states import BlockStates
from smarttestudo.robot.status_topics import BLOCKS_PER_SLICE, StatusPublisher, StatusReporter, StatusTimer

BARE = replace(STATUS, blocks=())


def zones(count: int) -> str:
    blocks = [
        f"If CheckValue /odom pose_x > {place} Then SetFrequency /scan 5 EndIf" for place in range(count)
    ]
    return "\n".join(["begin SetFrequency /scan 1", *blocks, "end"])


class Telling:
    """A run with ``count`` blocks that tells its status to so many listeners, and over a link."""

    def __init__(self, count: int, listeners: int = 1) -> None:
        self.robot, self.link = VirtualRobot(listeners=listeners), MemoryLink()
        self.driver = LoopDriver(zones(count))
        self.is_broken = False
        timer = StatusTimer(self.robot, self.link)
        publisher = StatusPublisher(self.robot, self.link)
        self.reporter = StatusReporter(self.robot, publisher, timer, self.measure, lambda: BARE.rules)

    def measure(self, most: int) -> tuple[RuntimeStatus, BlockStates]:
        if self.is_broken:
            raise ZeroDivisionError("odd")
        return BARE, self.driver.loop.block_states(self.driver.now_ns, most)

    def told(self) -> RuntimeStatus:
        """The next status that comes to be told, whatever time that takes."""
        before = len(self.robot.texts)
        while len(self.robot.texts) == before:
            self.reporter.report()
        ((topic, text),) = self.robot.texts[before:]
        assert topic == STATUS_TOPIC
        assert self.link.told[-1] == json.loads(text)
        return status_from_text(text)


@pytest.mark.parametrize("count", [0, 1, 19, 20, 21, 40, 999, 1000, 1001, 2500])
def test_whoever_listens_is_told_the_first_thousand_blocks_and_how_many_there_are(count: int) -> None:
    run = Telling(count)
    run.driver.drive(SECOND, 7.5, 0.0)
    status = run.told()
    assert len(status.blocks) == min(count, MOST_BLOCKS)
    assert len(status.blocks) + status.blocks_left_out == count
    assert [block.line for block in status.blocks] == [place + 2 for place in range(len(status.blocks))]
    assert [block.state.name for block in status.blocks] == [
        "TRUE" if place < 7.5 else "FALSE" for place in range(len(status.blocks))
    ]
    assert replace(status, blocks=(), blocks_left_out=0) == BARE


@pytest.mark.full
def test_while_nobody_listens_the_latched_status_costs_the_same_whatever_the_rules() -> None:
    run = Telling(2500, listeners=0)
    status = run.told()
    assert (len(status.blocks), status.blocks_left_out) == (20, 2480)
    run.link.is_watched = True
    assert len(run.told().blocks) == MOST_BLOCKS


def test_messages_are_relayed_between_two_slices_and_the_status_is_of_the_moment_of_its_first() -> None:
    run = Telling(200)
    run.driver.drive(SECOND, 7.5, 0.0)
    waits_s = [run.reporter.report()]
    run.driver.drive(SECOND, 150.5, 0.0)
    run.driver.reload(zones(3))
    while not run.robot.texts:
        waits_s.append(run.reporter.report())
    assert len(waits_s) == 200 // BLOCKS_PER_SLICE + 1
    assert max(waits_s[:-1]) < 0.001
    assert waits_s[-1] == pytest.approx(1, abs=0.01)
    status = status_from_text(run.robot.texts[0][1])
    assert sum(block.state.name == "TRUE" for block in status.blocks) == 8
    assert len(run.told().blocks) == 3


@pytest.mark.full
def test_long_conditions_do_not_make_a_status_large() -> None:
    condition = " AND ".join(f"CheckValue /odom pose_x > {place}" for place in range(90))
    blocks = [f"If ({condition}) Then SetFrequency /scan {rate} EndIf" for rate in range(1, 201)]
    run = Telling(0)
    run.driver.reload("\n".join(["begin SetFrequency /scan 1", *blocks, "end"]))
    status = run.told()
    assert sum(len(block.checks) for block in status.blocks) <= 8 * MOST_BLOCKS
    assert len(status.blocks) + status.blocks_left_out == 200
    assert len(run.robot.texts[-1][1]) < 1_000_000


def test_a_failure_is_said_once_and_the_next_status_is_made_all_the_same() -> None:
    run = Telling(30)
    run.is_broken = True
    run.reporter.report()
    run.reporter.report()
    assert run.robot.log_lines == ["error: unexpected ZeroDivisionError: odd; some statuses are missing"]
    run.is_broken = False
    assert len(run.told().blocks) == 30


def test_what_was_told_before_reads_as_complete() -> None:
    older = {name: value for name, value in to_json(STATUS).items() if name != "blocks_left_out"}
    assert status_from_text(json.dumps(older)).blocks_left_out == 0

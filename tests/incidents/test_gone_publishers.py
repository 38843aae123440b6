# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Latched messages of publishers that are gone, in incidents of a robot that runs."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from pathlib import Path

from incidents.test_reloads import TEXT, Run, rules
from robot.status.virtual_robot import SECOND
from smarttestudo.domain.robot import Qos
from smarttestudo.robot.gone_publishers import FOUND_WITHIN_NS
from smarttestudo.robot.source import LiveSource

LATCHED = Qos(reliable=True, transient_local=True, depth=10)
FIRST, BRIEF = b"first", b"brief"


@contextmanager
def run_with_an_incident(folder: Path) -> Iterator[Run]:
    """A run that records the map, and does so right after the block."""
    run = Run(folder, rules('Record "far" /map Before 1 s After 1 s'))
    with run.part.running():
        yield run
        run.trigger()
        run.pass_time(30)


def messages_of_map(run: Run) -> int:
    """How many messages of the map the incident has."""
    messages: int = run.record()["topics"]["/map"]["messages"]
    return messages


def look(run: Run, *gids: bytes, publishers: int | None = None) -> None:
    """The run looks at the graph, where these publish the map, or were the last that did."""
    source = LiveSource(
        type_name=TEXT,
        publishers=len(gids) if publishers is None else publishers,
        qos=LATCHED,
        gids=frozenset(gids),
    )
    run.part.on_source("/map", source, run.robot.now_ns())


def latch(run: Run, publisher: Hashable) -> None:
    run.part.on_message("/map", b"map", publisher, run.robot.now_ns(), None)


def wait(run: Run, *gids: bytes, publishers: int | None = None) -> None:
    """So long that a publisher that the graph lacks is gone, and what it latched in no window."""
    for _ in range(2 + FOUND_WITHIN_NS // SECOND):
        look(run, *gids, publishers=publishers)
        run.pass_time(10)


def test_what_many_brief_publishers_latched_is_not_in_an_incident(tmp_path: Path) -> None:
    with run_with_an_incident(tmp_path) as run:
        look(run, FIRST)
        latch(run, FIRST)
        for number in range(20):
            latch(run, b"brief %d" % number)
            wait(run, FIRST)
    assert messages_of_map(run) == 1


def test_where_nobody_is_left_the_last_that_was_heard_still_counts(tmp_path: Path) -> None:
    with run_with_an_incident(tmp_path) as run:
        look(run, FIRST)
        latch(run, b"brief before")
        latch(run, BRIEF)
        wait(run, FIRST, publishers=0)
    assert messages_of_map(run) == 1


def test_what_a_publisher_latched_counts_in_a_window_that_begins_before_it_left(tmp_path: Path) -> None:
    with run_with_an_incident(tmp_path) as run:
        for gid in (FIRST, BRIEF):
            look(run, FIRST, BRIEF)
            latch(run, gid)
        run.pass_time(30)
        look(run, FIRST)
        run.pass_time(FOUND_WITHIN_NS * 10 // SECOND)
        look(run, FIRST)
    assert messages_of_map(run) == 2


def test_publishers_that_cannot_be_told_apart_are_not_taken_for_gone(tmp_path: Path) -> None:
    with run_with_an_incident(tmp_path) as run:
        look(run, FIRST)
        latch(run, None)
        wait(run, FIRST)
    assert messages_of_map(run) == 1

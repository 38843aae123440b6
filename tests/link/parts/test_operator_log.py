# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the log says of operators: who came and left, and no flood."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.parts.live_link import MOST_LINES, REFILL_NS, OperatorLog

ADA, BOB = 0x1A2B << 48, 0x9 << 48


def said(*looks: tuple[float, set[int]]) -> list[str]:
    """What is said where so many seconds after the start these are there."""
    lines: list[str] = []
    log = OperatorLog(lines.append)
    for at_s, there in looks:
        log.look(frozenset(there), round(at_s * NS_PER_S))
    return lines


def test_who_came_and_left_is_said_once_each() -> None:
    assert said(
        (0, set()), (1, {ADA}), (2, {ADA}), (5, {ADA, BOB}), (60, {BOB}), (61, set()), (62, set())
    ) == [
        "operator 1a2b came over the link",
        "operator 0009 came over the link",
        "operator 1a2b left the link",
        "operator 0009 left the link; none is there now",
    ]


def test_how_long_nobody_was_there_is_said() -> None:
    assert said((0, {ADA}), (100, set()), (120, {BOB}))[1:] == [
        "operator 1a2b left the link; none is there now",
        "operator 0009 came over the link, after 20 s without any",
    ]


def test_one_that_gives_way_to_another_is_one_line() -> None:
    assert said((0, {ADA}), (100, {BOB}))[1:] == [
        "operator 1a2b left the link; operator 0009 came over the link"
    ]


def test_a_connection_that_flaps_is_summed_up() -> None:
    flaps = [(number * 0.5, {ADA} if number % 2 else set()) for number in range(100)]
    lines = said(*flaps, (60, {ADA}), (100, {ADA}))
    assert len(lines) == MOST_LINES + 2
    assert lines[-2:] == [
        "operator 1a2b came over the link; operators came or left 54 more times meanwhile",
        "operators came or left 38 more times meanwhile",
    ]


@given(
    st.lists(st.tuples(st.floats(0.01, 100), st.sets(st.integers(1, 2**64 - 1), max_size=3)), max_size=100)
)
def test_no_more_is_said_than_so_many_lines_and_in_the_end_all_of_it(
    looks: list[tuple[float, set[int]]],
) -> None:
    at_s, timed = 0.0, []
    for after_s, there in looks:
        at_s += after_s
        timed.append((at_s, there))
    lines = said(*timed)
    assert len(lines) <= MOST_LINES + at_s * NS_PER_S / REFILL_NS
    last = timed[-1][1] if timed else set()
    final = said(*timed, (at_s + 1000, last))
    if len(final) > len(lines) or lines:
        assert final[-1].endswith("none is there now") == (not last)
    else:
        assert not last

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates are judged where the machine kept up, and only there."""

from __future__ import annotations

from ros.calm_window import Arrival, calm_window

SPAN_S = 10.0


def run_of(seconds: int, *stalls: tuple[float, float]) -> dict[str, list[Arrival]]:
    """A 10 Hz topic in which what is due during a stall comes at its end."""

    def at_s(due_s: float) -> float:
        return next((end_s for start_s, end_s in stalls if start_s <= due_s < end_s), due_s) + 0.001

    return {"imu": [Arrival(at_s(k / 10), None, k / 10) for k in range(10 * seconds)]}


def edges(received: dict[str, list[Arrival]]) -> tuple[float, float] | None:
    window = calm_window(received, SPAN_S)
    return None if window is None else (window["imu"][0].due_s, window["imu"][-1].due_s)


def test_a_calm_run_is_looked_at_but_for_its_first_second() -> None:
    assert edges(run_of(13)) == (1.0, 12.9)


def test_a_run_that_is_too_short_has_no_window() -> None:
    assert edges(run_of(11)) is None


def test_the_edges_keep_away_from_a_stall() -> None:
    assert edges(run_of(14, (0.9, 1.1))) == (2.1, 13.9)
    assert edges(run_of(14, (13.6, 13.8))) == (1.0, 13.5)


def test_a_short_stall_between_the_edges_does_no_harm() -> None:
    assert edges(run_of(13, (6.0, 6.15))) == (1.0, 12.9)


def test_a_longer_stall_parts_the_run() -> None:
    assert edges(run_of(20, (6.0, 6.4))) == (7.4, 19.9)
    assert edges(run_of(16, (6.0, 6.4))) is None


def test_stalls_that_follow_each_other_count_together() -> None:
    assert edges(run_of(13, (6.0, 6.08), (6.8, 6.88))) == (1.0, 12.9)
    assert edges(run_of(16, (6.0, 6.15), (6.8, 6.95))) is None

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents of a robot whose clock was set back, as by a simulation that begins anew."""

from __future__ import annotations

from pathlib import Path

from incidents.folder_runs import LATCHED, FolderRun, payloads, record_of
from incidents.incident_runs import recording_rules

RULES = recording_rules('Record "near miss" /odom Before 30 s After 2 s')


def pass_time(run: FolderRun, seconds: int) -> None:
    for _ in range(10 * seconds):
        run.wait(100)
        run.message("/odom")


def test_a_window_that_begins_before_simulated_time_does_is_whole(tmp_path: Path) -> None:
    run = FolderRun(RULES, tmp_path / "incidents")
    run.message(LATCHED)
    pass_time(run, 60)
    run.wait(-run.clock_ms + 10)
    pass_time(run, 5)
    run.trigger()
    pass_time(run, 3)
    (folder,) = run.finish()
    (_, begun_ms), record = run.begun_ms[0], record_of(folder)
    window = {payload for _, at_ms, topic, payload in run.came if -30_000 <= at_ms - begun_ms <= 2000} | {
        payload for *_, topic, payload in run.came if topic == LATCHED
    }
    assert payloads(folder).keys() == window
    assert record["missing"] == []
    assert record["from_ns"] < 0

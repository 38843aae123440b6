# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents of a robot whose clock was set back, as by a simulation that begins anew."""

from __future__ import annotations

from pathlib import Path

import pytest

from incidents.folder_runs import LATCHED, MS, FolderRun, payloads, record_of
from incidents.incident_runs import recording_rules
from smarttestudo.incidents.folder import complete_incidents

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


@pytest.mark.parametrize("into_ms", [-500, 0, 200, 1900])
@pytest.mark.parametrize("by_ms", [-900_000, -900, -100])
def test_a_window_in_which_the_clock_is_set_back_is_whole(tmp_path: Path, into_ms: int, by_ms: int) -> None:
    run = FolderRun(RULES, tmp_path / "incidents")
    for at_ms in range(-5000, 3000, 100):
        if at_ms == into_ms:
            run.wait(by_ms)
        if at_ms == 0:
            run.trigger()
        run.wait(100)
        run.message("/odom")
    (folder,) = run.finish()
    begun_ms = run.begun_ms[0][1]
    window = {payload for _, at_ms, _, payload in run.came if at_ms - begun_ms <= 2000}
    assert payloads(folder).keys() == window
    assert [one["reason"] for one in record_of(folder)["missing"]] == ["late"]


@pytest.mark.parametrize("latched_again", [False, True])
def test_a_killed_run_says_what_its_incident_lacks_also_after_the_clock_was_set_back(
    tmp_path: Path, *, latched_again: bool
) -> None:
    run = FolderRun(RULES, tmp_path / "incidents")
    run.message(LATCHED)
    pass_time(run, 60)
    run.wait(-run.clock_ms + 3000)
    pass_time(run, 2)
    run.trigger()
    pass_time(run, 1)
    if latched_again:
        run.message(LATCHED)
    last_ns = run.clock_ms * MS
    (found,) = complete_incidents(run.folder)
    record = record_of(run.folder / found.name)
    assert found.last_ns == last_ns
    assert [(one["reason"], one["from_ns"], one["to_ns"]) for one in record["missing"]] == [
        ("killed", last_ns, record["to_ns"])
    ]


def test_a_run_that_is_killed_right_after_the_trigger_lacks_all_from_there_on(tmp_path: Path) -> None:
    run = FolderRun(RULES, tmp_path / "incidents")
    run.message(LATCHED)
    run.wait(60_000)
    run.trigger()
    (found,) = complete_incidents(run.folder)
    record = record_of(run.folder / found.name)
    assert [(one["reason"], one["from_ns"]) for one in record["missing"]] == [
        ("killed", record["triggered_ns"])
    ]

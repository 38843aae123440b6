# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo demo --thesis`` writes, of a run that repeats as the thesis did."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from made_demos import Ran, made_demo
from simulation.demo.demo_runs import Messages, binned_hz, robots_messages_of, run_testudo

UNCHANGED_BY_BLOCKS = ("/camera/image_raw", "/imu", "/joint_states", "/camera/camera_info")
TABLES = {
    f"{name}.{form}" for name in ("table-7.1-frequency", "table-7.2-bandwidth") for form in ("md", "csv")
}


@pytest.fixture(scope="module")
def thesis_demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ran]:
    return made_demo(tmp_path_factory, "--thesis")


@pytest.fixture(scope="module")
def received(thesis_demo: tuple[Path, Ran]) -> Messages:
    return robots_messages_of(thesis_demo[0] / "adaptive")


def _table(folder: Path, name: str) -> dict[str, dict[str, str]]:
    with (folder / "thesis" / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return {row["Topic"]: row for row in csv.DictReader(file)}


@pytest.mark.full
def test_both_tables_a_figure_of_each_topic_and_the_zones_are_written(
    thesis_demo: tuple[Path, Ran], received: Messages
) -> None:
    folder, ran = thesis_demo
    figures = {f"frequency{topic.replace('/', '-')}.png" for topic in received}

    assert (ran.code, ran.stderr) == (0, "")
    assert "demo-out/thesis " in ran.stdout
    assert len(figures) == 9
    assert {path.name for path in (folder / "thesis").iterdir()} == {*TABLES, *figures, "zones.png"}
    for name in (*figures, "zones.png"):
        assert (folder / "thesis" / name).read_bytes().startswith(b"\x89PNG")


def test_the_tables_have_what_the_recordings_have(
    thesis_demo: tuple[Path, Ran], baseline: Messages, received: Messages
) -> None:
    folder, _ = thesis_demo
    frequency, bandwidth = _table(folder, "table-7.1-frequency"), _table(folder, "table-7.2-bandwidth")

    assert set(frequency) == set(bandwidth) == set(received)
    for topic, row in frequency.items():
        assert float(row["Default (Hz)"]) == pytest.approx(binned_hz(baseline[topic]))
        assert float(row["Adaptive (Hz)"]) == pytest.approx(binned_hz(received[topic]))
    size_bits = 8 * sum(len(payload) for _, payload in baseline["/odom"])
    length_s = (max(m[-1][0] for m in baseline.values()) - min(m[0][0] for m in baseline.values())) / 1e9
    assert float(bandwidth["/odom"]["Default (kbit/s)"]) == pytest.approx(size_bits / length_s / 1000)


@pytest.mark.parametrize("topic", UNCHANGED_BY_BLOCKS)
def test_changes_that_no_block_makes_are_those_of_the_thesis(
    thesis_demo: tuple[Path, Ran], topic: str
) -> None:
    row = _table(thesis_demo[0], "table-7.1-frequency")[topic]

    assert float(row["Change (%)"]) == pytest.approx(float(row["Thesis (%)"]), abs=1.5)


def test_repeating_makes_the_scan_come_more_often_than_its_source_as_in_the_thesis(
    thesis_demo: tuple[Path, Ran], baseline: Messages, received: Messages
) -> None:
    row = _table(thesis_demo[0], "table-7.1-frequency")["/scan"]

    assert float(row["Change (%)"]) > 10
    assert float(row["Thesis (%)"]) == 18
    assert {payload for _, payload in received["/scan"]} <= {payload for _, payload in baseline["/scan"]}


def test_the_table_also_says_what_passes_where_nothing_is_repeated(
    thesis_demo: tuple[Path, Ran], baseline: Messages, adaptive: Messages
) -> None:
    """``adaptive`` is of a demo without --thesis."""
    for topic, row in _table(thesis_demo[0], "table-7.1-frequency").items():
        change = 100 * (binned_hz(adaptive[topic]) / binned_hz(baseline[topic]) - 1)
        assert float(row["Passed once (%)"]) == pytest.approx(change)
    text = (thesis_demo[0] / "thesis" / "table-7.1-frequency.md").read_text(encoding="utf-8")
    assert "Passed once: the change where it is not (--when-slow pass)." in text


@pytest.mark.full
def test_who_asks_for_passing_reads_in_the_table_what_repeating_gives(tmp_path: Path) -> None:
    out = tmp_path / "out"
    ran = run_testudo("demo", "--thesis", "--when-slow", "pass", "--seconds", 90, "--out", out)
    assert (ran.code, ran.stderr) == (0, "")
    row = _table(out, "table-7.1-frequency")["/scan"]
    assert float(row["Change (%)"]) < float(row["Repeated (%)"])

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The table of ``benchmarks/trajectories.py``: the same motion in each format, and files that are none."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

import trajectories
from trajectories import TrajectoryError, compare

START_NS = 1_403_715_524_900_000_000
STEP_NS = 50_000_000
Pose = tuple[float, float, float, float]


def motion() -> Iterator[Pose]:
    """x, y and heading for a minute: a robot drives bends at a speed that changes, and stands a while."""
    x_m, y_m, heading = 0.0, 0.0, 0.0
    for number in range(1200):
        t_s = number * STEP_NS / 1e9
        speed = 0.0 if 20 < t_s < 30 else 0.4 * (1 + math.sin(0.7 * t_s))
        heading += 0.05 * math.sin(0.3 * t_s)
        x_m += speed * math.cos(heading) * STEP_NS / 1e9
        y_m += speed * math.sin(heading) * STEP_NS / 1e9
        yield t_s, x_m, y_m, heading


def written(folder: Path, form: str, poses: Sequence[Pose]) -> list[Path]:
    folder.mkdir(exist_ok=True)
    path = folder / {"KITTI": "00.txt", "EuRoC": "data.csv", "TUM": "groundtruth.txt"}[form]
    lines = ["# made by a test"]
    for number, (t_s, x_m, y_m, heading) in enumerate(poses):
        cos, sin = math.cos(heading), math.sin(heading)
        q_w, q_z = math.cos(heading / 2), math.sin(heading / 2)
        lines.append(
            {
                "KITTI": f"{cos:.12f} {-sin:.12f} 0 {x_m:.12f} {sin:.12f} {cos:.12f} 0 {y_m:.12f} 0 0 1 0",
                "EuRoC": f"{START_NS + number * STEP_NS},{x_m:.12f},{y_m:.12f},0,{q_w:.12f},0,0,{q_z:.12f}",
                "TUM": f"{START_NS / 1e9 + t_s:.6f} {x_m:.12f} {y_m:.12f} 0 0 0 {q_z:.12f} {q_w:.12f}",
            }[form]
        )
    path.write_text("\n".join(lines) + "\n")
    if form != "KITTI":
        return [path]
    times = folder / "00_times.txt"
    times.write_text("".join(f"{t_s:e}\n" for t_s, *_ in poses))
    return [path, times]


def test_the_same_motion_in_each_format_has_the_same_row(tmp_path: Path) -> None:
    poses = list(motion())
    files = [path for form in ("KITTI", "EuRoC", "TUM") for path in written(tmp_path / form, form, poses)]

    rows = [compare(one, 0.05) for one in trajectories.trajectories(files)]

    assert [row.trajectory.form for row in rows] == ["KITTI", "EuRoC", "TUM"]
    for row in rows:
        assert row.bounded.messages == rows[0].bounded.messages
        for way, other in zip(
            (row.bounded, row.held, row.reckoned),
            (rows[0].bounded, rows[0].held, rows[0].reckoned),
            strict=True,
        ):
            assert way.rmse == pytest.approx(other.rmse, rel=0.01)
            assert way.worst == pytest.approx(other.worst, rel=0.01)


def test_rivals_have_as_many_messages_and_only_the_bound_is_kept(tmp_path: Path) -> None:
    (one,) = trajectories.trajectories(written(tmp_path, "TUM", list(motion())))

    row = compare(one, 0.05)

    assert row.bounded.worst <= 0.05 < row.reckoned.worst < row.held.worst
    assert row.bounded.rmse < row.reckoned.rmse < row.held.rmse
    for rival in (row.held, row.reckoned):
        assert rival.messages == pytest.approx(row.bounded.messages, rel=0.02, abs=1)


def test_velocities_of_a_set_are_those_of_its_frame(tmp_path: Path) -> None:
    """A robot that looks along y and drives along x moves to its right."""
    q = math.sqrt(0.5)
    lines = [f"{START_NS + n * STEP_NS},{n * 0.05},0,0,{q},0,0,{q},1.0,0,0" for n in range(40)]
    path = tmp_path / "data.csv"
    path.write_text("\n".join(lines))

    (one,) = trajectories.trajectories([path])

    assert one.places[3].velocity_of_body == pytest.approx((0, -1, 0))
    assert compare(one, 0.05).bounded.worst == pytest.approx(0, abs=1e-9)


def test_time_without_poses_is_no_error(tmp_path: Path) -> None:
    poses = [(t_s + (40 if t_s > 30 else 0), x_m, y_m, heading) for t_s, x_m, y_m, heading in motion()]
    (one,) = trajectories.trajectories(written(tmp_path, "TUM", poses))

    assert [len(stretch) for stretch in one.stretches()] == [601, 599]
    assert compare(one, 0.05).bounded.worst <= 0.05


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "holds no numbers"),
        ("1 2 3\n", "3 numbers a line are neither KITTI, EuRoC nor TUM"),
        ("1 2 3\n4 5\n", "different counts of numbers"),
        ("begin\n", "cannot be read as lines of numbers"),
        ("1\n2\n", "only times"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n" * 5, "its stamps are not at"),
        ("5 0 0 0 0 0 0 1\n" * 5, "fewer than three poses"),
    ],
)
def test_a_file_that_is_no_trajectory_is_refused_in_one_line(
    text: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "poses.txt"
    path.write_text(text)
    monkeypatch.setattr(sys, "argv", ["trajectories.py", str(path)])

    with pytest.raises(SystemExit, match=said) as ended:
        trajectories.main()

    assert str(ended.value).startswith(f"error: {path}: ")
    assert "\n" not in str(ended.value)


def test_times_of_another_length_are_refused(tmp_path: Path) -> None:
    poses, times = written(tmp_path, "KITTI", list(motion()))
    times.write_text("0\n1\n")

    with pytest.raises(TrajectoryError, match="1200 poses, and 2 times"):
        list(trajectories.trajectories([poses, times]))


def test_the_table_says_rmse_and_worst_of_each_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (path,) = written(tmp_path, "TUM", list(motion()))
    monkeypatch.setattr(sys, "argv", ["trajectories.py", str(path), "--bound", "0.1"])

    assert trajectories.main() == 0

    head, _, row = capsys.readouterr().out.splitlines()
    assert row.startswith("| TUM, groundtruth.txt | 1 200 | 10 | ")
    assert row.count("|") == head.count("|")
    assert row.endswith(" times |")

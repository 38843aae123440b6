# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo: what it records, replays, says and leaves."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections import Counter
from itertools import groupby
from pathlib import Path

import pytest

from made_demos import Ran
from report.golden_files import assert_reads_as
from robot.status.virtual_robot import Source, VirtualRobot
from simulation.demo.demo_runs import GOLDEN, Messages, binned_hz, messages_of, run_testudo, without_replay
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.recording import Channel
from smarttestudo.simulation.demo.live import lost_lines, recorded

THESIS_CHANGE_PERCENT = {
    "/camera/image_raw": -89.6,
    "/imu": -94.7,
    "/joint_states": -38.9,
    "/camera/camera_info": -89.5,
}
WRITTEN = {
    "accuracy.json",
    "adaptive",
    "baseline",
    "decisions.jsonl",
    "demo.json",
    "report.html",
    "warehouse.adirf",
    "warehouse_predicted.adirf",
    "warehouse_within.adirf",
}


def _change_percent(before: Messages, after: Messages, topic: str) -> float:
    return 100 * (binned_hz(after[topic]) / binned_hz(before[topic]) - 1)


def _declared_bytes(bag: Path) -> dict[str, int]:
    with open_recording(bag) as recording:
        return dict(recording.declared_bytes)


def _replay(demo_out: Path, output: Path, *options: str) -> None:
    """The demo's recording under the rules in its folder."""
    rules = ("--rules", demo_out / "warehouse.adirf")
    ran = run_testudo("replay", demo_out / "baseline", *rules, "--output", output, *options)
    assert (ran.code, ran.stderr) == (0, "")


@pytest.fixture(scope="module")
def short_demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a demo of 3 s with seed 3."""
    out = tmp_path_factory.mktemp("short") / "out"
    run_testudo("demo", "--out", out, "--seconds", 3, "--seed", 3)
    return out


@pytest.mark.parametrize("topic", THESIS_CHANGE_PERCENT)
def test_topics_that_no_block_sets_change_as_in_the_thesis(
    topic: str, baseline: Messages, adaptive: Messages
) -> None:
    change = _change_percent(baseline, adaptive, topic)

    assert change == pytest.approx(THESIS_CHANGE_PERCENT[topic], abs=1.5)


def test_each_frame_has_the_rate_of_tf_so_slow_ones_pass_whole(
    baseline: Messages, adaptive: Messages
) -> None:
    """The thesis thinned /tf whatever was in a message (-66.4 %), and lost wheels to the odometry frame."""

    def with_wheels(messages: Messages) -> list[bytes]:
        return [payload for _, payload in messages["/tf"] if b"wheel_left_link" in payload]

    assert with_wheels(adaptive) == with_wheels(baseline)
    odometry = [(at_ns, payload) for at_ns, payload in adaptive["/tf"] if b"base_footprint" in payload]
    assert binned_hz(odometry) == pytest.approx(10, rel=0.01)


def test_no_topic_comes_more_often_than_its_source(baseline: Messages, adaptive: Messages) -> None:
    for topic, received in adaptive.items():
        assert len(received) <= len(baseline[topic])
    assert _change_percent(baseline, adaptive, "/scan") < 0


@pytest.mark.full
def test_a_demo_that_repeats_is_a_replay_that_repeats(tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_testudo("demo", "--out", out, "--seconds", 3, "--when-slow", "repeat")
    _replay(out, tmp_path / "repeated", "--when-slow", "repeat")
    _replay(out, tmp_path / "passed")

    received = messages_of(out / "adaptive")
    assert received == messages_of(tmp_path / "repeated")
    assert received != messages_of(tmp_path / "passed")


@pytest.mark.contract
def test_what_is_received_was_published_byte_for_byte(baseline: Messages, adaptive: Messages) -> None:
    for topic, received in adaptive.items():
        published = Counter(payload for _, payload in baseline[topic])
        assert not Counter(payload for _, payload in received) - published


@pytest.mark.contract
def test_the_blocks_decide_in_the_order_of_the_zones(whole_demo: Ran, demo_out: Path) -> None:
    decisions = [json.loads(line) for line in (demo_out / "decisions.jsonl").read_text().splitlines()]
    compressed_or_scan = [d for d in decisions if d["topic"] == "/scan"]

    blocks = [rule for rule, _ in groupby(d["rule"] for d in compressed_or_scan)]

    # Unknown at first, then hall, corridor, the wall in between, scaffolding, hall.
    assert blocks == ["Scaffolding", None, "Warehouse Corridor", None, "Scaffolding", None]
    assert f"{len(decisions)} decisions" in whole_demo.stdout


@pytest.mark.contract
def test_the_screen_reads_as_in_the_golden_file(whole_demo: Ran) -> None:
    assert (whole_demo.code, whole_demo.stderr) == (0, "")
    assert_reads_as(GOLDEN / "demo.txt", without_replay(whole_demo))


def test_both_recordings_declare_the_size_of_whole_camera_frames(whole_demo: Ran, demo_out: Path) -> None:
    expected = {"/camera/image_raw": 6_220_872, "/camera/image_raw/compressed": 420_000}

    assert _declared_bytes(demo_out / "baseline") == expected
    assert _declared_bytes(demo_out / "adaptive") == expected


def test_the_page_names_zones_topics_seed_and_fixed_rates(demo_out: Path, baseline: Messages) -> None:
    page = (demo_out / "report.html").read_text("utf-8")

    for text in ("Warehouse Corridor", "Scaffolding", "Seed", "Best fixed rates", *baseline):
        assert text in page
    assert len(page.encode()) < 500_000


def test_the_folder_holds_what_the_screen_says(whole_demo: Ran, demo_out: Path) -> None:
    assert {path.name for path in demo_out.iterdir()} == WRITTEN
    assert {path.name for path in demo_out.parent.iterdir()} == {demo_out.name, "examples"}


def test_the_rules_left_in_the_folder_replay_to_the_same_recording(
    whole_demo: Ran, demo_out: Path, tmp_path: Path
) -> None:
    _replay(demo_out, tmp_path / "own")

    assert messages_of(tmp_path / "own") == messages_of(demo_out / "adaptive")


@pytest.mark.full
def test_the_same_seed_gives_the_same_files_and_another_one_other_noise(
    short_demo: Path, tmp_path: Path
) -> None:
    for name, seed in (("again", 3), ("other", 4)):
        run_testudo("demo", "--out", tmp_path / name, "--seconds", 3, "--seed", seed)

    folders = (short_demo, tmp_path / "again", tmp_path / "other")
    for bag in ("baseline", "adaptive"):
        first, again, other = (messages_of(folder / bag) for folder in folders)
        assert first == again
        assert first != other
    for file in ("decisions.jsonl", "report.html"):
        assert (short_demo / file).read_bytes() == (tmp_path / "again" / file).read_bytes()


def test_rules_that_were_edited_after_a_demo_are_those_of_the_next_one(
    short_demo: Path, tmp_path: Path
) -> None:
    out = shutil.copytree(short_demo, tmp_path / "out")
    edited = b"\xef\xbb\xbfbegin\r\n    SetFrequency /odom 1 // mine\r\nend\r\n"
    (out / "warehouse.adirf").write_bytes(edited)

    again = run_testudo("demo", "--out", out, "--seconds", 3)

    assert (out / "warehouse.adirf").read_bytes() == edited
    assert set(messages_of(out / "adaptive")) == {"/odom", "/testudo/decisions"}
    assert "// mine" in (out / "report.html").read_text("utf-8")
    assert again.code == 0
    assert f"note: {out}/warehouse.adirf was edited: kept and used" in again.stderr


def test_edited_rules_with_an_error_are_refused_in_one_line_and_stay(
    short_demo: Path, tmp_path: Path
) -> None:
    out = shutil.copytree(short_demo, tmp_path / "out")
    (out / "warehouse.adirf").write_text("begin\n    SetFrequency /odom\nend\n")
    before = {path.name: path.stat().st_mtime_ns for path in out.iterdir()}

    again = run_testudo("demo", "--out", out, "--seconds", 1)

    assert (again.code, again.stdout) == (1, "")
    assert again.stderr.startswith(f"{out}/warehouse.adirf:2:")
    assert again.stderr.count("\n") == 1
    assert {path.name: path.stat().st_mtime_ns for path in out.iterdir()} == before


def test_the_last_line_can_be_typed_as_it_stands_and_shows_what_edited_rules_give(tmp_path: Path) -> None:
    testudo = Path(sys.executable).with_name("testudo")
    bare = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)}
    demo = [os.path.relpath(testudo, tmp_path), "demo", "--seconds", "1", "--out", "my demo"]
    ran = subprocess.run(demo, cwd=tmp_path, env=bare, capture_output=True, text=True, check=True)
    (tmp_path / "my demo" / "warehouse.adirf").write_text("begin SetFrequency /odom 1 end")

    typed = ran.stdout.splitlines()[-1]
    subprocess.run(["sh", "-c", typed], cwd=tmp_path, env=bare, capture_output=True, check=True)

    assert "SetFrequency /odom 1" in (tmp_path / "my-report.html").read_text("utf-8")


def test_the_last_line_names_the_command_alone_where_the_shell_finds_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    testudo = Path(sys.executable).with_name("testudo")
    monkeypatch.setenv("PATH", str(testudo.parent))
    monkeypatch.setattr(sys, "argv", [str(testudo)])
    monkeypatch.chdir(tmp_path)

    ran = run_testudo("demo", "--seconds", 1, "--out", "out")

    assert ran.stdout.splitlines()[-1].startswith("  testudo replay out/baseline ")


@pytest.mark.full
def test_full_images_are_recorded_whole_and_declare_nothing(tmp_path: Path) -> None:
    ran = run_testudo("demo", "--out", tmp_path / "out", "--seconds", 1, "--full-images")
    images = messages_of(tmp_path / "out" / "baseline")["/camera/image_raw"]

    assert {len(payload) for _, payload in images} == {6_220_872}
    assert "No figure counts declared sizes: all are of messages as they are recorded." in ran.stdout
    assert ran.stdout.count("declared") == 1


def test_a_folder_that_no_demo_made_is_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()

    ran = run_testudo("demo", "--out", tmp_path, "--seconds", 1)

    assert (ran.code, ran.stdout) == (1, "")
    assert ran.stderr == (
        f"{tmp_path}: error: exists and was not made by 'testudo demo'; name another folder with --out\n"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize(
    "arguments",
    [("--seconds", "0"), ("--seconds", "nan"), ("--seconds", "long"), ("--seed", "-1"), ("--seed", "1.5")],
)
def test_wrong_numbers_are_wrong_usage(arguments: tuple[str, str], tmp_path: Path) -> None:
    ran = run_testudo("demo", "--out", tmp_path / "out", *arguments)

    assert ran.code == 2
    assert repr(arguments[1]) in ran.stderr
    assert list(tmp_path.iterdir()) == []


def test_messages_that_a_recording_lost_are_counted_topic_by_topic(tmp_path: Path) -> None:
    robot = VirtualRobot(sources={"/image": Source(hz=15, one_of=3), "/scan": Source(hz=10)})
    channels = [Channel(topic=topic, type_name="sensor_msgs/msg/Imu") for topic in robot.sources]
    folder = tmp_path / "baseline"
    with recorded(robot, folder, channels, {}) as subscribed:
        robot.wait(None, 200)
        said = lost_lines(folder, subscribed)
    assert said == ["baseline: 2 000 of 3 000 messages of /image were lost on their way"]

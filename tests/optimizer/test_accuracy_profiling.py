# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What accuracies need, measured in a recording."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from bags.bag_factory import START_NS, BagContent, write_bag
from pacing.reckoning.ros_messages import JOINTS, ODOMETRY, TRANSFORMS, odometry, planar
from replays.replay_runs import replay_content
from replays.test_replay_bounds import moved_frames, recorded, walking_arm
from smarttestudo.cli.main import main
from smarttestudo.domain.profile import AccuracyTiers, LevelledProperty, TopicProfile
from smarttestudo.optimizer.profiling import AccuracyMeasure
from smarttestudo.pacing.reckoning.motion import Twist, Vector3
from smarttestudo.rules.profile_file import load_profile

SECONDS = 30
STEADY = Twist(Vector3(0.0, 0, 0), Vector3(0, 0, 0.0))


def where(t_s: float) -> float:
    """Waits for 10 s, then hurries forth and back in 4 s."""
    return 0.0 if t_s < 10 else math.sin((t_s - 10) * math.pi / 2)


def hurried(stamp_ns: int, t_s: float) -> bytes:
    return odometry(stamp_ns, planar(where(t_s), 0, 0), STEADY)


def hurry() -> BagContent:
    return recorded("/odom", ODOMETRY, 20, SECONDS, hurried)


def profiled(tmp_path: Path, content: BagContent, *options: str) -> dict[str, TopicProfile]:
    write_bag(tmp_path / "bag", content)
    output = tmp_path / "profile.toml"
    assert main(["profile", "--bag", str(tmp_path / "bag"), "-o", str(output), *options]) == 0
    return dict(load_profile(output).topics)


def held_messages(bound: float) -> int:
    """The naive count: hold what passed, and pass what is more off, or comes 2 s after the one before."""
    count, shown, last_s = 0, math.inf, -math.inf
    for number in range(20 * SECONDS):
        t_s = number / 20
        if abs(where(t_s) - shown) > bound or t_s - last_s >= 2:
            count, shown, last_s = count + 1, where(t_s), t_s
    return count


def test_each_accuracy_needs_what_passes_and_the_profile_reads_back(tmp_path: Path) -> None:
    tiers = profiled(tmp_path, hurry())["/odom"].accuracies[LevelledProperty.POSITION]
    assert tiers.bounds == (0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
    # The heartbeat is a grid, which the naive count restarts with each message: up to two messages of 600.
    naive_hz = [20 * held_messages(bound) / (20 * SECONDS) for bound in tiers.bounds]
    assert list(tiers.needs_hz or ()) == pytest.approx(naive_hz, rel=0.005, abs=2 / SECONDS)


@pytest.mark.parametrize("bound", [0.5, 0.05, 0.01])
def test_what_is_measured_is_what_a_replay_under_the_bound_sends(tmp_path: Path, bound: float) -> None:
    content = hurry()
    known = {LevelledProperty.POSITION: AccuracyTiers(bounds=(bound,) * 6)}
    measure = AccuracyMeasure(ODOMETRY, known)
    for message in content.messages:
        measure.record(message.stamp_ns, message.payload)
    needs_hz = measure.tiers(20.0)[LevelledProperty.POSITION].needs_hz
    assert needs_hz is not None
    run = replay_content(content, f"SetFrequency /odom Full KeepWithin /odom position {bound}", tmp_path)
    # What waits for its heartbeat at the end goes out after it.
    waits = run.on("/odom")[-1].stamp_ns > content.messages[-1].stamp_ns
    assert round(needs_hz[0] / 20 * len(content.messages)) == len(run.on("/odom")) - waits


@pytest.mark.parametrize("chosen", [(2, 1, 0.5, 0.2, 0.1, 0.05), (1e-4, 1e-5, 1e-6, 2e-7, 1.5e-7, 1e-9)])
def test_accuracies_of_a_given_profile_are_measured_in_place_of_proposed_ones(
    tmp_path: Path, chosen: tuple[float, ...]
) -> None:
    levels = tmp_path / "levels.toml"
    levels.write_text(f'[topics."/odom"]\ntiers_m = {list(chosen)}\n')
    entry = profiled(tmp_path, hurry(), "--accuracies-of", str(levels))["/odom"]
    position = entry.accuracies[LevelledProperty.POSITION]
    assert position.bounds == chosen
    assert position.needs_hz is not None
    assert 0.5 <= position.needs_hz[0] < position.needs_hz[-1] or chosen[0] < 1e-3
    assert entry.accuracies[LevelledProperty.ORIENTATION].bounds == (20, 10, 5, 3, 2, 1)


def test_numbers_of_a_profile_have_six_decimals(tmp_path: Path) -> None:
    levels = tmp_path / "levels.toml"
    levels.write_text('[topics."/odom"]\ntiers_m = [2, 1, 0.5, 0.2, 0.12345678, 0.05]\n')
    entry = profiled(tmp_path, hurry(), "--accuracies-of", str(levels))["/odom"]
    assert entry.accuracies[LevelledProperty.POSITION].bounds == (2, 1, 0.5, 0.2, 0.123457, 0.05)


def test_frames_and_joints_have_accuracies_and_other_topics_have_none(tmp_path: Path) -> None:
    parts = [
        recorded("/tf", TRANSFORMS, 20, 10, moved_frames),
        recorded("/joint_states", JOINTS, 20, 10, walking_arm),
    ]
    messages = sorted((one for part in parts for one in part.messages), key=lambda one: one.stamp_ns)
    topics = tuple(topic for part in parts for topic in part.topics)
    found = profiled(tmp_path, BagContent(topics, tuple(messages)))
    assert set(found["/tf"].accuracies) == {LevelledProperty.POSITION, LevelledProperty.ORIENTATION}
    assert set(found["/joint_states"].accuracies) == {LevelledProperty.POSITIONS}
    needs = found["/tf"].accuracies[LevelledProperty.POSITION].needs_hz
    # The base drives 0.5 m/s; every tenth of a second it is 5 cm on.
    assert needs is not None
    assert needs[2] == pytest.approx(20 / 5, rel=0.2)


def test_messages_that_cannot_be_read_are_told_beside_the_rates_that_they_raise(tmp_path: Path) -> None:
    def cut_off(stamp_ns: int, t_s: float) -> bytes:
        return hurried(stamp_ns, t_s) if t_s < SECONDS / 2 else b"\x00\x01"

    profiled(tmp_path, recorded("/odom", ODOMETRY, 20, SECONDS, cut_off))
    text = (tmp_path / "profile.toml").read_text(encoding="utf-8")
    needs = [line for line in text.splitlines() if "_need_hz" in line]
    assert len(needs) == 2
    assert all(line.endswith("; 300 messages could not be read and passed") for line in needs)


def test_one_message_says_nothing_about_what_accuracies_need(tmp_path: Path) -> None:
    content = recorded("/odom", ODOMETRY, 1, 1, hurried)
    assert content.messages[0].stamp_ns == START_NS
    assert profiled(tmp_path, content)["/odom"].accuracies == {}

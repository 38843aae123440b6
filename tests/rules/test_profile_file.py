# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles: what is read, and what a user is told about a wrong one."""

from __future__ import annotations

from pathlib import Path

import pytest

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.profile import AccuracyTiers, LevelledProperty, LevelUnit, Profile, TopicProfile
from smarttestudo.rules.profile_file import load_profile

WHOLE = """\
budget_kb_per_s = 15000.0
settle_s = 0.25
allow_calls = ["/dock", "lights/dim"]

[allow_parameters]
"/camera" = ["quality", "fps"]
camera = ["gain"]

[topics."/odom"]
type = "nav_msgs/msg/Odometry"
message_kb = 0.72
source_hz = 25.5
tiers_hz = [10, 15, 20, 25, 30, 35]
tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]
tiers_m_need_hz = [0.9, 1.5, 2.6, 4.2, 8.5, 8.5]
priority = 1.0
min_hz = 1.0
max_hz = 25.5

[topics."battery"]
level_unit = "percent"
tiers_deg = [20, 10, 5, 5, 2, 1]
stale_after_s = 30

[topics."/camera/camera_info"]
paced_with = "/camera/image_raw"
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "profile.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_key_is_read(tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, WHOLE))
    assert (profile.budget_kb_per_s, profile.settle_s) == (15000.0, 0.25)
    assert profile.topic("/odom") == TopicProfile(
        type_name="nav_msgs/msg/Odometry",
        message_kb=0.72,
        source_hz=25.5,
        tiers_hz=(10, 15, 20, 25, 30, 35),
        priority=1.0,
        min_hz=1.0,
        max_hz=25.5,
        accuracies={
            LevelledProperty.POSITION: AccuracyTiers(
                bounds=(0.5, 0.2, 0.1, 0.05, 0.02, 0.01), needs_hz=(0.9, 1.5, 2.6, 4.2, 8.5, 8.5)
            )
        },
    )
    assert profile.topic("/battery") == TopicProfile(
        level_unit=LevelUnit.PERCENT,
        stale_after_s=30.0,
        accuracies={LevelledProperty.ORIENTATION: AccuracyTiers(bounds=(20, 10, 5, 5, 2, 1))},
    )
    assert profile.topic("/camera/camera_info").paced_with == "/camera/image_raw"
    assert profile.allow_calls == {"/dock", "/lights/dim"}
    assert profile.allow_parameters == {"/camera": {"quality", "fps", "gain"}}


def test_what_is_allowed_is_so_by_its_full_names(tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, WHOLE)).resolved(lambda name: f"/tb3{name}")
    assert profile.allow_calls == {"/tb3/dock", "/tb3/lights/dim"}
    assert profile.allow_parameters == {"/tb3/camera": {"quality", "fps", "gain"}}


def test_an_empty_profile_knows_nothing(tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, ""))
    assert profile.settle_s == 0.5
    assert profile.topic("/odom") == TopicProfile()


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("budget_kb_per_s = -1", ":1:1: error: budget_kb_per_s must not be negative, it is -1"),
        ("\nbuget_kb_per_s = 1", ":2:1: error: unknown key buget_kb_per_s; did you mean budget_kb_per_s?"),
        ('allow_calls = "/dock"', ":1:1: error: allow_calls must be a list of names"),
        ("allow_calls = [1]", ":1:1: error: allow_calls must be a string in quotes"),
        ('allow_calls = ["a b"]', ":1:1: error: 'a b' is not a valid ROS 2 topic name"),
        (
            'allow_parameters = ["/a"]',
            ":1:1: error: allow_parameters must be a table of nodes; "
            'write it as in "/camera_driver" = ["jpeg_quality"]',
        ),
        ('[allow_parameters]\n"/a" = "b"', ':2:1: error: allow_parameters."/a" must be a list of names'),
        ("budget_kb_per_s = nan", ":1:1: error: budget_kb_per_s must be a finite number"),
        ('[topics."/a"]\nmessage_kb = 0', ':2:1: error: topics."/a".message_kb must be above 0, it is 0'),
        (
            '[topics."/a"]\n\ntiers_hz = [1, 2, 3, 4, 5]',
            ':3:1: error: topics."/a".tiers_hz must be a list of six rates τ0 … τ5 in Hz, it is 5 numbers',
        ),
        (
            '[topics."/a"]\ntiers_hz = [\n  1, 2, 3,\n  9, 5, 6 ]',
            ':2:1: error: topics."/a".tiers_hz must not fall from one level to the next: '
            "Competitive (5 Hz) is below Desirable (9 Hz)",
        ),
        (
            '[topics."/a"]\ntiers_m = [0.5, 0.2]',
            ':2:1: error: topics."/a".tiers_m must be a list of six accuracies α0 … α5 in m, it is 2 numbers',
        ),
        (
            '[topics."/a"]\ntiers_deg = [9, 5, 6, 3, 2, 1]',
            ':2:1: error: topics."/a".tiers_deg must not rise from one level to the next: '
            "Acceptable (6) is above Marginal (5); write the widest bound first",
        ),
        (
            '[topics."/a"]\ntiers_rad = [3, 2, 1, 1, 1, 0]',
            ':2:1: error: topics."/a".tiers_rad must be above 0, it is 0',
        ),
        (
            '[topics."/a"]\ntiers_m = [inf, 2, 1, 1, 1, 1]',
            ':2:1: error: topics."/a".tiers_m must be a finite number',
        ),
        (
            '[topics."/a"]\ntiers_m = [1e10, 2, 1, 1, 1, 1]',
            ':2:1: error: topics."/a".tiers_m must be from 1e-09 to 1e+09, it is 1e+10; '
            "the unit is in the key's name",
        ),
        (
            '[topics."/a"]\npriority = 1\ntiers_m_need_hz = [1, 2, 3, 4, 5, 6]',
            ':3:1: error: topics."/a".tiers_m_need_hz says what tiers_m need, which is missing; '
            "add tiers_m, or remove it",
        ),
        ('[topics."a//b"]', ":1:1: error: 'a//b' is not a valid ROS 2 topic name"),
        ('[topics."/a"]\nmin_hz = 5\nmax_hz = 1', ":2:1: error: min_hz is above max_hz"),
        (
            '[topics."/a"]\nlevel_unit = "volt"',
            ':2:1: error: topics."/a".level_unit must be "percent" or "fraction"',
        ),
        (
            '[topics."/a"]\nmin_hz = 1e-9',
            ':2:1: error: topics."/a".min_hz must be 0, or from 0.001 to 1e+06 Hz, it is 1e-09',
        ),
        ("settle_s = 1e300", ":1:1: error: settle_s must be from 0 to 1e+06 s, it is 1e+300; is it in s?"),
        (
            '[topics."/a"]\nstale_after_s = 1e300',
            ':2:1: error: topics."/a".stale_after_s must be from 0.001 to 1e+06 s, it is 1e+300; is it in s?',
        ),
        (
            '[topics."/a"]\nmessage_kb = 1e308',
            ':2:1: error: topics."/a".message_kb must be from 1e-06 to 1e+06 KB, it is 1e+308; is it in KB?',
        ),
        (
            '[topics."/a"]\npriority = 1e-300',
            ':2:1: error: topics."/a".priority must be from 1e-06 to 1e+06, it is 1e-300; '
            "only its ratio to the others counts",
        ),
        (
            f"\nbudget_kb_per_s = {'9' * 400}",
            ":2:1: error: budget_kb_per_s has more digits than a number can have; "
            "write it shorter, as in 1500.0",
        ),
        (
            f"\nbudget_kb_per_s = {'9' * 5000}",
            ":2:1: error: a number has thousands of digits; write it shorter, as in 1500.0",
        ),
        (
            f"budget_kb_per_s = 0x{'f' * 5000}",
            ":1:1: error: budget_kb_per_s has more digits than a number can have; "
            "write it shorter, as in 1500.0",
        ),
        (
            f'[topics."/a"]\ntiers_hz = [0, 1, 2, 3, 4, {"9" * 400}]',
            ':2:1: error: topics."/a".tiers_hz has more digits than a number can have; '
            "write it shorter, as in 1500.0",
        ),
        (
            '[topics."odom"]\n[topics."/odom"]\npriority = 2',
            ":2:1: error: the topic /odom has a table already; keep one of the two tables",
        ),
        *(
            (f"\n{key} = 1", ":2:1: error: a key has more than 10 parts; is it the right file?")
            for key in ("a." * 20_000 + "a", "[" + "a . " * 20_000 + "a]", '"a".' * 20_000 + "'a'")
        ),
        ('topics = "x"', ':1:1: error: topics must be tables such as [topics."/odom"]'),
    ],
)
def test_a_wrong_value_is_named_with_its_line(tmp_path: Path, text: str, complaint: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(ProfileError) as caught:
        load_profile(path)
    assert str(caught.value) == f"{path}{complaint}"


def test_what_is_no_toml_is_refused_with_its_line(tmp_path: Path) -> None:
    path = write(tmp_path, "budget_kb_per_s = 1\n[topics\n")
    with pytest.raises(ProfileError, match=r"profile\.toml:2:8: error: not valid TOML: "):
        load_profile(path)


def test_a_missing_profile_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "none.toml"
    with pytest.raises(ProfileError) as caught:
        load_profile(path)
    assert str(caught.value) == (
        f"{path}: error: the profile cannot be read: No such file or directory; give the path of a TOML file"
    )


def test_a_profile_in_another_encoding_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "profile.toml"
    path.write_bytes("budget_kb_per_s = 1".encode("utf-16"))
    with pytest.raises(ProfileError, match="not UTF-8 text; save it as UTF-8"):
        load_profile(path)


def test_a_profile_is_resolved_as_the_rules_are() -> None:
    camera_info = TopicProfile(priority=2.0, paced_with="image")
    profile = Profile(budget_kb_per_s=10.0, topics={"/odom": TopicProfile(), "camera_info": camera_info})
    resolved = profile.resolved(lambda name: f"/tb3_0/{name.lstrip('/')}")
    assert resolved.budget_kb_per_s == 10.0
    assert set(resolved.topics) == {"/tb3_0/odom", "/tb3_0/camera_info"}
    assert resolved.topic("/tb3_0/camera_info").paced_with == "/tb3_0/image"
    assert resolved.topic("/tb3_0/camera_info").priority == 2.0

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A profile as a table, and the table in the profile's text."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from smarttestudo.domain.errors import ProfileError
from smarttestudo.ruler.topics.presets import all_presets
from smarttestudo.ruler.topics.profiles import (
    ProfileRow,
    ProfileTable,
    read_table,
    write_table,
)
from smarttestudo.rules.profile_file import parse_profile

P_TOML = Path("p.toml")
PROFILE = """\
# Our radio.
budget_kb_per_s = 15000.0  # measured in hall 3
settle_s = 1.0

# Wheel odometry
[topics."/odom"]
type = "nav_msgs/msg/Odometry"
message_kb = 0.72  # mean of 100
tiers_hz = [10, 15, 20,  # slow
            25, 30, 35]
stale_after_s = 3.0

# The lidar
[topics."/scan"]
message_kb = 2.94
"""


def test_a_table_that_says_the_same_leaves_every_byte() -> None:
    assert write_table(read_table(PROFILE, P_TOML), PROFILE, P_TOML) == PROFILE


def test_new_values_leave_comments_and_other_keys() -> None:
    table = read_table(PROFILE, P_TOML)
    odom = replace(table.rows[0], message_kb=0.8, tiers_hz=(1.0, 2.0, 3.0, 4.0, 5.0, 6.5), priority=2.0)
    scan = replace(table.rows[1], message_kb=None, source_hz=5.0)
    imu = ProfileRow(topic="/imu", message_kb=0.32)
    text = write_table(ProfileTable(rows=(odom, scan, imu), budget_kb_per_s=275000.0), PROFILE, P_TOML)
    assert (
        text
        == """\
# Our radio.
budget_kb_per_s = 275000  # measured in hall 3
settle_s = 1.0

# Wheel odometry
[topics."/odom"]
type = "nav_msgs/msg/Odometry"
message_kb = 0.8  # mean of 100
tiers_hz = [1, 2, 3, 4, 5, 6.5]
stale_after_s = 3.0
priority = 2

# The lidar
[topics."/scan"]
source_hz = 5

[topics."/imu"]
message_kb = 0.32
"""
    )


def test_what_is_not_measured_is_marked_and_a_mark_that_goes_leaves_all_else() -> None:
    table = read_table(PROFILE, P_TOML)
    guessed = ProfileTable(
        rows=(table.rows[0], replace(table.rows[1], measured=False)), budget_kb_per_s=table.budget_kb_per_s
    )
    text = write_table(guessed, PROFILE, P_TOML)
    assert text == PROFILE + "measured = false\n"
    assert read_table(text, P_TOML) == guessed
    topics = parse_profile(text, P_TOML).topics
    assert (topics["/odom"].measured, topics["/scan"].measured) == (True, False)
    assert write_table(table, text, P_TOML) == PROFILE


def test_presets_are_profiles_that_say_where_they_are_from_and_that_nothing_was_measured() -> None:
    presets = all_presets().presets
    assert {one.title for one in presets} >= {"TurtleBot3", "IMU", "Lidar"}
    for one in presets:
        assert one.about.endswith(".")
        rows = read_table(one.text, P_TOML).rows
        assert all(row.type or row.topic == "/cmd_vel" for row in rows)
        assert all(row.message_kb and row.source_hz and row.tiers_hz for row in rows)
        assert {row.measured for row in rows} == {False}


def test_a_byte_order_mark_stays_in_front() -> None:
    marked = f"\ufeff{PROFILE}"
    table = read_table(marked, P_TOML)
    assert table == read_table(PROFILE, P_TOML)
    assert write_table(table, marked, P_TOML) == marked
    other = replace(table, budget_kb_per_s=8000.0)
    assert write_table(other, marked, P_TOML) == f"\ufeff{write_table(other, PROFILE, P_TOML)}"


def test_a_row_that_is_gone_takes_its_table_and_comment_along() -> None:
    table = read_table(PROFILE, P_TOML)
    text = write_table(ProfileTable(rows=table.rows[1:], budget_kb_per_s=None), PROFILE, P_TOML)
    assert text == '# Our radio.\nsettle_s = 1.0\n\n# The lidar\n[topics."/scan"]\nmessage_kb = 2.94\n'


def test_the_first_table_is_written_into_an_empty_text() -> None:
    rows = (ProfileRow(topic="/odom", message_kb=0.72, tiers_hz=(10.0, 15.0, 20.0, 25.0, 30.0, 35.0)),)
    text = write_table(ProfileTable(rows=rows, budget_kb_per_s=275000.0), "", P_TOML)
    assert parse_profile(text, P_TOML).budget_kb_per_s == 275000
    assert read_table(text, P_TOML).rows == rows


@pytest.mark.parametrize(
    "text", ['topics = {"/odom" = {message_kb = 1}}\n', 'topics."/odom".message_kb = 1\n']
)
def test_tables_written_in_one_line_are_not_guessed_at(text: str) -> None:
    table = read_table(text, P_TOML)
    assert write_table(table, text, P_TOML) == text
    changed = ProfileTable(rows=(replace(table.rows[0], message_kb=2.0),), budget_kb_per_s=None)
    with pytest.raises(ProfileError, match="cannot edit a profile that is written this way"):
        write_table(changed, text, P_TOML)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (ProfileRow(topic="no topic"), "not a valid ROS 2 topic name"),
        (ProfileRow(topic="/a", message_kb=-1.0), "Message size of /a must be above 0, it is -1"),
        (
            ProfileRow(topic="/a", tiers_hz=(6.0, 5.0, 4.0, 3.0, 2.0, 1.0)),
            "Levels of /a must not fall from one level to the next",
        ),
        (
            ProfileRow(topic="/a", tiers_m=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)),
            "Accuracies in position of /a must not rise from one level to the next",
        ),
        (ProfileRow(topic="/a", source_hz=1e9), "Source rate of /a must be from"),
    ],
)
def test_a_row_that_no_profile_can_hold_is_refused_in_words_of_the_table(row: ProfileRow, said: str) -> None:
    with pytest.raises(ProfileError, match=said):
        write_table(ProfileTable(rows=(row,), budget_kb_per_s=None), PROFILE, P_TOML)


SIZES = st.none() | st.sampled_from([0.5, 1.0, 420.0, 1e-3])
ROWS = st.builds(
    ProfileRow,
    topic=st.sampled_from(["/odom", "/scan", "/imu", "/a/b"]),
    type=st.none() | st.sampled_from(["nav_msgs/msg/Odometry", 'a "quoted" # é']),
    message_kb=SIZES,
    source_hz=SIZES,
    priority=SIZES,
    tiers_hz=st.none() | st.just((1.0, 2.0, 3.0, 4.0, 5.0, 6.0)),
)


@given(rows=st.lists(ROWS, max_size=4, unique_by=lambda row: row.topic), budget=SIZES)
@settings(max_examples=60)
def test_what_is_written_reads_back_and_foreign_keys_stay(
    rows: list[ProfileRow], budget: float | None
) -> None:
    text = write_table(ProfileTable(rows=tuple(rows), budget_kb_per_s=budget), PROFILE, P_TOML)
    read = read_table(text, P_TOML)
    assert sorted(read.rows, key=str) == sorted(rows, key=str)
    profile = parse_profile(text, P_TOML)
    assert (profile.settle_s, profile.budget_kb_per_s) == (1.0, budget)
    if any(row.topic == "/odom" for row in rows):
        assert profile.topic("/odom").stale_after_s == 3.0

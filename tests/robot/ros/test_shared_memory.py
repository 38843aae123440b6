# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How much memory our nodes share with Fast DDS, and what of it a user decides."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

pytest.importorskip("rclpy")

from smarttestudo.robot.ros.shared_memory import (
    FILES_OF_USERS,
    OF_USERS,
    PROFILE,
    PROFILES_FILE,
    PROFILES_FILE_BEFORE_KILTED,
    SEGMENT_BYTES,
    room_for_large_messages,
    segment_bytes,
    senders_remedy,
)

MB = 1024 * 1024


@pytest.fixture(autouse=True)
def nothing_is_configured(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A user's own variables and files are not ours to test."""
    monkeypatch.chdir(tmp_path)
    for name in (*OF_USERS, "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize(
    ("free_mb", "taken_mb"), [(8000, 16), (64, 16), (63, 15.75), (20, 5), (4, 1), (3, None), (0, None)]
)
def test_a_quarter_of_what_is_free_is_shared_and_16_mb_at_most(free_mb: int, taken_mb: float | None) -> None:
    assert segment_bytes(free_mb * MB) == (None if taken_mb is None else taken_mb * MB)


@pytest.mark.parametrize("name", OF_USERS)
def test_a_user_who_configures_fast_dds_has_nothing_else(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(name, "/home/ada/profile.xml")
    before = dict(os.environ)
    with room_for_large_messages():
        assert dict(os.environ) == before
    assert dict(os.environ) == before


@pytest.mark.parametrize("name", FILES_OF_USERS)
def test_so_has_one_whose_profiles_lie_in_the_working_directory(name: str) -> None:
    Path(name).touch()
    before = dict(os.environ)
    with room_for_large_messages():
        assert dict(os.environ) == before


def test_the_environment_is_as_before_once_the_node_is_there() -> None:
    before = dict(os.environ)
    with room_for_large_messages():
        added = os.environ.keys() - before
        assert added <= {PROFILES_FILE, PROFILES_FILE_BEFORE_KILTED}
        assert [os.environ[name] for name in added] == [str(PROFILE)]
    assert dict(os.environ) == before


def test_the_profile_adds_a_transport_and_changes_no_other() -> None:
    text = PROFILE.read_text(encoding="utf-8")
    assert re.findall(r"<type>(.*)</type>", text) == ["SHM"]
    assert f"<segment_size>{SEGMENT_BYTES}</segment_size>" in text
    assert "useBuiltinTransports" not in text


def test_what_a_sender_sets_suits_how_far_its_node_is_discovered(monkeypatch: pytest.MonkeyPatch) -> None:
    assert senders_remedy() == "FASTDDS_BUILTIN_TRANSPORTS='DEFAULT?sockets_size=8MB'"
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    assert senders_remedy().endswith(f"_DEFAULT_PROFILES_FILE={PROFILE}")

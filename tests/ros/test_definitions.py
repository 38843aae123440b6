# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The definitions that a robot sends along: others must read them as ROS reads the types."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from smarttestudo.robot.ros.message_types import is_installed, message_definition
from smarttestudo.simulation.messages import RobotMessages

PACKAGES = ("diagnostic_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs")
ODOMETRY = "nav_msgs/msg/Odometry"


def installed_types() -> list[str]:
    return [
        f"{package}/msg/{name}"
        for package in PACKAGES
        for name, kind in vars(importlib.import_module(f"{package}.msg")).items()
        if isinstance(kind, type) and hasattr(kind, "get_fields_and_field_types")
    ]


def store_of(definition: str, type_name: str) -> Any:
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(definition, type_name))
    return store


def as_read(definition: Any) -> str:
    """The fields of a type; rclpy calls a char what it is read as, an uint8."""
    return str(definition[1]).replace("'char'", "'uint8'")


def test_the_demos_types_have_the_fields_and_the_hashes_that_rosbags_knows() -> None:
    known = get_typestore(Stores.ROS2_HUMBLE)
    demo = {channel.type_name for channel in RobotMessages().channels.values()}
    installed = sorted(filter(is_installed, demo))
    assert len(installed) >= 7
    for type_name in installed:
        store = store_of(message_definition(type_name), type_name)
        for within in store.fielddefs:
            assert store.fielddefs[within][1] == known.fielddefs[within][1], within
        assert store.hash_rihs01(type_name) == known.hash_rihs01(type_name)


def test_every_installed_type_has_the_fields_that_rosbags_knows_of_some_release(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    releases = [get_typestore(one) for one in (Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY, Stores.ROS2_KILTED)]
    types = [one for one in installed_types() if any(one in release.fielddefs for release in releases)]
    assert len(types) > 90
    for type_name in types:
        fields = store_of(message_definition(type_name), type_name).fielddefs
        for within in fields:
            known = [
                as_read(release.fielddefs[within]) for release in releases if within in release.fielddefs
            ]
            assert as_read(fields[within]) in known, within


def test_the_text_of_an_installed_file_is_sent_word_for_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "share" / "sensor_msgs" / "msg"
    folder.mkdir(parents=True)
    text = "# Range limits.\nuint8 ULTRASOUND=0\nstd_msgs/Header header\nuint8 radiation_type\n"
    (folder / "Range.msg").write_text(text, "utf-8")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'none'}:{tmp_path}")
    definition = message_definition("sensor_msgs/msg/Range")
    assert definition.startswith(text)
    separator = "=" * 80
    first, header, time = definition.split(f"\n{separator}\n")
    assert first == text
    assert header == "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    assert time == "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"


@pytest.mark.parametrize("type_name", ["acme_msgs/msg/Odd", "os/msg/path", "std_srvs/srv/Empty", ""])
def test_a_type_that_is_not_installed_has_no_definition(type_name: str) -> None:
    assert message_definition(type_name) == ""

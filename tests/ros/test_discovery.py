# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Nodes that are to stay on this machine are told so in the words of each distribution."""

from __future__ import annotations

import ctypes
from types import SimpleNamespace

import pytest

from smarttestudo.domain.robot import DiscoveryRange
from smarttestudo.robot.ros.discovery import discovery_variables

HUMBLE = SimpleNamespace()
LATER = SimpleNamespace(rcl_get_automatic_discovery_range=None)


def told(
    monkeypatch: pytest.MonkeyPatch, librcl: SimpleNamespace, discovery: DiscoveryRange
) -> tuple[str, str | None]:
    """The range and ``ROS_LOCALHOST_ONLY``."""
    with monkeypatch.context() as patched:
        patched.setattr(ctypes, "CDLL", lambda name, mode: librcl)
        variables = discovery_variables(discovery)
    return variables["ROS_AUTOMATIC_DISCOVERY_RANGE"], variables.get("ROS_LOCALHOST_ONLY")


def test_where_librcl_knows_no_ranges_its_older_variable_says_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_LOCALHOST_ONLY", raising=False)
    assert told(monkeypatch, HUMBLE, DiscoveryRange.LOCALHOST) == ("LOCALHOST", "1")
    assert told(monkeypatch, HUMBLE, DiscoveryRange.SUBNET) == ("SUBNET", "0")


def test_elsewhere_the_older_variable_says_it_only_where_it_was_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_LOCALHOST_ONLY", raising=False)
    assert told(monkeypatch, LATER, DiscoveryRange.LOCALHOST) == ("LOCALHOST", None)
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    assert told(monkeypatch, LATER, DiscoveryRange.SUBNET) == ("SUBNET", "0")

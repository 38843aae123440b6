# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The range of discovery, and what else only the environment of a process sets."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from smarttestudo.domain.robot import DiscoveryRange
from smarttestudo.robot.ros.loading import load_rclpy

_RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
# All that Humble has. Jazzy heeds it more than the range, and warns of it; Kilted has dropped it.
_LOCALHOST_ONLY = "ROS_LOCALHOST_ONLY"


def discovery_variables(discovery: DiscoveryRange) -> Mapping[str, str]:
    """Environment variables with which nodes of this ROS look as far as ``discovery``."""
    variables = {_RANGE: discovery.name}
    if _LOCALHOST_ONLY in os.environ or not knows_ranges():
        variables[_LOCALHOST_ONLY] = "1" if discovery is DiscoveryRange.LOCALHOST else "0"
    return variables


@contextmanager
def environment(variables: Mapping[str, str]) -> Iterator[None]:
    """Have these variables for what ROS makes in the block."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def is_on_localhost() -> bool:
    """Whether nodes of this environment stay on this machine."""
    is_only = os.environ.get(_LOCALHOST_ONLY) == "1"
    return is_only or os.environ.get(_RANGE, "").upper() == DiscoveryRange.LOCALHOST.name


def knows_ranges() -> bool:
    """Whether this ROS has ranges of discovery, as all have after Humble."""
    try:
        # It loads librcl.
        load_rclpy()
        library = ctypes.CDLL("librcl.so", mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
    except (ImportError, OSError, AttributeError):
        # An installation for Windows or macOS is likely to be a newer one.
        return True
    return hasattr(library, "rcl_get_automatic_discovery_range")

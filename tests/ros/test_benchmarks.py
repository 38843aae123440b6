# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks on a ROS graph start and end."""

from __future__ import annotations

import importlib.util

import pytest

from real_browser import chromium_path
from smallest_benchmarks import WITH_ROS, WITH_ROS_AND_CHROMIUM, ends_well
from smarttestudo.ruler.server.page import is_page_built

if importlib.util.find_spec("rclpy") is None:
    pytest.skip("ROS 2 (rclpy) is not installed", allow_module_level=True)

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", WITH_ROS)
def test_a_benchmark_ends_well(name: str, domain: int) -> None:
    ends_well(name, "--domain", str(domain))


@pytest.mark.parametrize("name", WITH_ROS_AND_CHROMIUM)
def test_a_benchmark_of_the_page_ends_well(name: str, domain: int) -> None:
    chromium_path()
    if not is_page_built():
        pytest.skip("the Ruler's page is not built ('make gui'): it is not tested")
    ends_well(name, "--domain", str(domain))

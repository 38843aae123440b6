# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks on a ROS graph start and end."""

from __future__ import annotations

import pytest

from smallest_benchmarks import WITH_ROS, WITH_ROS_AND_CHROMIUM, ends_well


@pytest.mark.parametrize("name", WITH_ROS)
def test_a_benchmark_ends_well(name: str, domain: int) -> None:
    ends_well(name, "--domain", str(domain))


@pytest.mark.parametrize("name", WITH_ROS_AND_CHROMIUM)
@pytest.mark.usefixtures("chromium", "built_page")
def test_a_benchmark_of_the_page_ends_well(name: str, domain: int) -> None:
    ends_well(name, "--domain", str(domain))

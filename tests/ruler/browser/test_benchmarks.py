# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of the page start and end."""

from __future__ import annotations

import pytest

from real_browser import chromium_path
from smallest_benchmarks import WITH_CHROMIUM, ends_well


@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_CHROMIUM)
def test_a_benchmark_ends_well(name: str) -> None:
    chromium_path()
    ends_well(name)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of the page start and end."""

from __future__ import annotations

import pytest

from smallest_benchmarks import WITH_CHROMIUM, ends_well


@pytest.mark.parametrize("name", WITH_CHROMIUM)
@pytest.mark.usefixtures("chromium", "built_page")
def test_a_benchmark_ends_well(name: str) -> None:
    ends_well(name)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks start and end; those on a ROS graph are in ``ros``, those of the page in ``ruler/browser``."""

from __future__ import annotations

import re

import pytest

from smallest_benchmarks import FOLDER, SMALLEST, WITH_NAMESPACES, WITH_NOTHING, ends_well


def test_each_benchmark_has_a_smallest_case() -> None:
    assert sorted(SMALLEST) == sorted(path.stem for path in FOLDER.glob("*.py"))


def test_documents_name_benchmarks_that_are_there() -> None:
    pages = [path.read_text("utf-8") for path in (FOLDER.parent / "docs").rglob("*.md")]
    named = {name for page in pages for name in re.findall(r"python benchmarks/(\w+)\.py", page)}
    assert named <= set(SMALLEST)
    assert named >= {"link_ages", "optimizer_speed"}


@pytest.mark.full
@pytest.mark.parametrize("name", WITH_NOTHING)
def test_a_benchmark_ends_well(name: str) -> None:
    ends_well(name)


@pytest.mark.full
@pytest.mark.usefixtures("network_namespaces")
@pytest.mark.parametrize("name", WITH_NAMESPACES)
def test_a_benchmark_of_the_link_ends_well(name: str) -> None:
    ends_well(name)

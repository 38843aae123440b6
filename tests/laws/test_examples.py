# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which examples a law is tried with: the same in every ordinary run, others and more when asked for."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
LAW = """
from pathlib import Path
from hypothesis import given, settings, strategies as st

@settings(max_examples=7)
@given(number=st.integers())
def test_law(number):
    with Path("tried").open("a") as tried:
        tried.write(f"{number}\\n")
"""
BROKEN_LAW = """
from hypothesis import given, strategies as st

@given(number=st.integers())
def test_law(number):
    assert number < 1000
"""


@pytest.fixture
def laws(tmp_path: Path) -> Path:
    (tmp_path / "test_law.py").write_text(LAW, encoding="utf-8")
    return tmp_path


def run(laws: Path, *options: str) -> str:
    """What pytest says of the laws of another folder, by the settings of this one."""
    command = (sys.executable, "-m", "pytest", "-p", "conftest", "-p", "no:cacheprovider", *options, ".")
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(TESTS), str(TESTS.parent / "benchmarks")]),
    }
    return subprocess.run(
        command, cwd=laws, env=environment, check=False, capture_output=True, text=True
    ).stdout


def tried(laws: Path, *options: str) -> list[str]:
    """The examples of one run."""
    assert "1 passed" in run(laws, *options)
    path = laws / "tried"
    examples = path.read_text(encoding="utf-8").split()
    path.unlink()
    return examples


def test_an_ordinary_run_tries_the_same_examples_each_time(laws: Path) -> None:
    once, again = tried(laws), tried(laws)
    assert once == again
    assert len(once) == 7


def test_fuzzing_tries_others_each_time_and_more_than_a_law_says_that_it_wants(laws: Path) -> None:
    fuzzing = ("--hypothesis-profile", "fuzz", "--examples-factor", "10")
    once, again = tried(laws, *fuzzing), tried(laws, *fuzzing)
    assert once != again
    assert len(once) == len(again) == 70


def test_a_tenth_of_few_examples_is_one(laws: Path) -> None:
    assert len(tried(laws, "--examples-factor", "0.1")) == 1


PROCESSES = """\
import subprocess
import pytest


def start():
    return subprocess.run(["true"], check=True)


@pytest.fixture
def started():
    return start()


def test_plain():
    pass


def test_of_a_helper():
    start()


def test_of_a_fixture(started):
    pass


@pytest.mark.contract
def test_promise():
    start()


@pytest.mark.contract
@pytest.mark.calm
def test_rates():
    pass


@pytest.mark.full
def test_long():
    pass
"""


@pytest.mark.parametrize(
    ("tiers", "names"),
    [
        ("plain", ["plain"]),
        ("contract,plain", ["plain", "promise"]),
        ("full", ["of_a_helper", "of_a_fixture", "rates", "long"]),
    ],
)
def test_what_starts_a_process_or_judges_rates_is_full_unless_it_says_otherwise(
    laws: Path, tiers: str, names: list[str]
) -> None:
    (laws / "test_law.py").write_text(PROCESSES, encoding="utf-8")
    said = run(laws, "--tiers", tiers, "--collect-only", "--quiet")
    assert re.findall(r"::test_(\w+)", said) == names


def test_a_law_that_fails_says_how_to_see_it_fail_again(laws: Path) -> None:
    (laws / "test_law.py").write_text(BROKEN_LAW, encoding="utf-8")
    said = run(laws, "--hypothesis-profile", "fuzz")
    assert "number=1000" in said
    assert "@reproduce_failure(" in said

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which tier a test belongs to, by what it is.

======== ============================================================================== =====================
tier     what such a test is                                                            who runs it
======== ============================================================================== =====================
plain    it starts no process, and takes less than a second                             quick, test, test-all
journey  it goes through one panel of the page in a real browser                        test, test-all
contract it keeps one promise of a document or a port with real nodes or compiled code  test, test-all
full     all others: what starts processes, and what is marked so, as it takes seconds  test-all
======== ============================================================================== =====================

A test, or its module, is marked only where it is not what it would be by itself. A test that judges rates
(``calm``) is ``full``, for it needs the machine for itself. ``pytest --tiers plain,contract`` runs these two.
"""

from __future__ import annotations

import enum
import functools
import subprocess
import sysconfig
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType

import pytest

_TESTS = Path(__file__).parent
_NOT_OF_TESTS = (*sysconfig.get_paths().values(), str(_TESTS.parent / "src"))
_FOLDERS_OF_PROCESSES = ("ros", "ruler/browser")
_FIXTURES_OF_PROCESSES = ("browser", "link", "ros")


class Tier(enum.Enum):
    """The tiers, by the names of their markers."""

    PLAIN = "plain"
    JOURNEY = "journey"
    CONTRACT = "contract"
    FULL = "full"


MARKERS = (
    "journey: a panel of the page in a real browser; `make test` runs it",
    "contract: a promise of a document or a port, with real nodes or compiled code; `make test` runs it",
    "full: `make test-all` only; all that starts processes is it unless it says otherwise",
    "calm: judges rates of real messages or a quiet graph, so that nothing runs beside it; always full",
)


def tier_of(item: pytest.Item) -> Tier:
    """What the closest marker says, of the test before its module."""
    if item.get_closest_marker("calm"):
        return Tier.FULL
    names = {tier.value for tier in Tier}
    said = (Tier(mark.name) for mark in item.iter_markers() if mark.name in names)
    return next(said, Tier.FULL if starts_processes(item) else Tier.PLAIN)


def of_tiers(items: list[pytest.Item], names: str) -> tuple[list[pytest.Item], list[pytest.Item]]:
    """The tests of these tiers, as in ``plain,contract``, and the others."""
    tiers = {Tier(name) for name in names.split(",")}
    kept: list[pytest.Item] = []
    others: list[pytest.Item] = []
    for item in items:
        (kept if tier_of(item) in tiers else others).append(item)
    return kept, others


def starts_processes(item: pytest.Item) -> bool:
    """Whether it is in a folder of browsers or ROS nodes, or it or a fixture of its may start a process."""
    if any(_TESTS / folder in item.path.parents for folder in _FOLDERS_OF_PROCESSES):
        return True
    if not isinstance(item, pytest.Function):
        return False
    if any(name in item.fixturenames for name in _FIXTURES_OF_PROCESSES):
        return True
    fixtures = [known[-1].func for known in item._fixtureinfo.name2fixturedefs.values()]
    return any(_uses_subprocess(each) for each in (item.function, *fixtures))


@functools.cache
def _uses_subprocess(function: object) -> bool:
    """Whether it names ``subprocess``, or a function or class of the tests that does."""
    to_look_at, seen = [function], set[int]()
    while to_look_at:
        used = to_look_at.pop()
        if used is subprocess:
            return True
        if id(used) not in seen:
            seen.add(id(used))
            to_look_at += _used_by(used)
    return False


def _used_by(used: object) -> list[object]:
    """What a function or class of the tests names; nothing for all else."""
    if isinstance(used, type):
        return list(vars(used).values())
    function = getattr(used, "__wrapped__", getattr(used, "__func__", used))
    if isinstance(function, FunctionType) and not function.__code__.co_filename.startswith(_NOT_OF_TESTS):
        return [function.__globals__.get(name) for name in _names(function.__code__)]
    return []


def _names(code: CodeType) -> Iterator[str]:
    """The global names that a function and those inside it use."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)

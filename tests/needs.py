# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What some tests need of a machine: where it is missing they are left out, and one line says so.

A test needs what a fixture of its says, by name. In continuous integration nothing is left out, and what is
missing fails each test that needs it.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import shutil
import subprocess
from collections import Counter
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

from axe import AXE
from smarttestudo.robot.ros.rcl.relay_library import LIBRARY
from smarttestudo.ruler.server.page import DOCUMENTATION_FOLDER, is_page_built
from thin_link.network_namespaces import NetworkError, require_links

_TESTS = Path(__file__).parent
_FILES_WITH_EXTRAS = ("docs/test_site.py", "docs/test_site_search.py", "bags/many/test_workers.py")
_CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome")
_LEFT_OUT = "testudo_left_out"


@dataclass(frozen=True, slots=True, kw_only=True)
class Need:
    """One thing that a machine may lack; ``have_it`` says how to get it."""

    name: str
    have_it: str
    is_there: Callable[[], bool]


def chromium_path() -> str | None:
    """The Chromium that is installed."""
    return next((path for name in _CHROMIUM_NAMES if (path := shutil.which(name))), None)


def _can_make_namespaces() -> bool:
    try:
        require_links()
    except NetworkError:
        return False
    name = f"testudo-needs-{os.getpid()}"
    # A container may be root's and not allow it.
    made = subprocess.run(["ip", "netns", "add", name], capture_output=True, check=False)
    subprocess.run(["ip", "netns", "del", name], capture_output=True, check=False)
    return made.returncode == 0


NEEDS: Mapping[str, Need] = {
    "chromium": Need(
        name="Chromium",
        have_it="on Debian: sudo apt install chromium",
        is_there=functools.cache(lambda: chromium_path() is not None),
    ),
    "built_page": Need(
        name="the Ruler's page, which Node builds",
        have_it="make gui",
        is_there=functools.cache(lambda: is_page_built() and AXE.exists()),
    ),
    "built_documentation": Need(
        name="the documentation that the Ruler's page opens",
        have_it="make documentation",
        is_there=functools.cache((DOCUMENTATION_FOLDER / "index.html").is_file),
    ),
    "ros": Need(
        name="ROS 2 (rclpy)",
        have_it="on x86-64 with Python 3.10 to 3.13: pip install '.[ros]'",
        is_there=functools.cache(lambda: importlib.util.find_spec("rclpy") is not None),
    ),
    "test_msgs": Need(
        name="messages of all types (test_msgs)",
        have_it="pip install '.[ros-test]', or sudo apt install ros-$ROS_DISTRO-test-msgs",
        is_there=functools.cache(lambda: importlib.util.find_spec("test_msgs") is not None),
    ),
    "full_extra": Need(
        name="the extra `full`",
        have_it="make test-all installs it",
        is_there=functools.cache(lambda: importlib.util.find_spec("distributed") is not None),
    ),
    "compiled_relays": Need(
        name="compiled relays",
        have_it="on Debian: sudo apt install gcc libc6-dev, then install SmartTestudo again",
        is_there=functools.cache(lambda: shutil.which("cc") is not None and LIBRARY.exists()),
    ),
    "network_namespaces": Need(
        name="the right to make network namespaces and TUN devices",
        have_it="as root on Linux: apt install iproute2; a container must be privileged",
        is_there=functools.cache(_can_make_namespaces),
    ),
}
"""By the name of the fixture that says so."""


def is_on_ci() -> bool:
    return os.environ.get("CI") == "true"


def require(name: str) -> None:
    """Fail a test where what it needs is missing."""
    need = NEEDS[name]
    if not need.is_there():
        pytest.fail(f"This test needs {need.name} ({need.have_it})", pytrace=False)


def _need_of_file(path: Path) -> str | None:
    if path.parent == _TESTS / "ros" and path.name.startswith("test_"):
        return "ros"
    return "full_extra" if path in {_TESTS / name for name in _FILES_WITH_EXTRAS} else None


class LeavingOut:
    """Leaves out the tests that this machine cannot run, and says at the end which."""

    def __init__(self) -> None:
        self._left_out: Counter[str] = Counter()

    def pytest_ignore_collect(self, collection_path: Path, config: pytest.Config) -> bool | None:
        """Leave out the files that could not be imported: live tests, and some full ones."""
        name = _need_of_file(collection_path)
        if name is None or NEEDS[name].is_there():
            return None
        if name == "full_extra" and config.getoption("--tiers"):
            # Whoever asks for other tiers misses nothing.
            return True
        if is_on_ci():
            return None
        self._left_out[name] += 1
        return True

    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        """Leave out the others."""
        if is_on_ci():
            return
        left_out = {item for item in items if self._lacks(item)}
        config.hook.pytest_deselected(items=[*left_out])
        items[:] = [item for item in items if item not in left_out]

    def _lacks(self, item: pytest.Item) -> bool:
        fixtures = getattr(item, "fixturenames", ())
        missing = [name for name in NEEDS if name in fixtures and not NEEDS[name].is_there()]
        self._left_out.update(missing[:1])
        return bool(missing)

    @pytest.hookimpl(wrapper=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> Generator[None, None, None]:
        """Tell the process that started this worker."""
        output = getattr(session.config, "workeroutput", None)
        if output is not None:
            output[_LEFT_OUT] = dict(self._left_out)
        yield

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: object) -> None:
        """All workers collect the same tests."""
        told = getattr(node, "workeroutput", {}).get(_LEFT_OUT, {})
        self._left_out |= Counter(told)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        for name, count in self._left_out.items():
            what = "files of tests" if name in {"ros", "full_extra"} else "tests"
            need = NEEDS[name]
            terminalreporter.line(f"Not tested: {count} {what} need {need.name} ({need.have_it})")

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests.

Hypothesis tries the same examples each time, so that a commit has one verdict; with the profile ``fuzz`` it
tries new ones. It is never timed. ``tiers.py`` says which tests run where, ``needs.py`` which cannot run on a
machine. In continuous integration nothing is skipped.
"""

from __future__ import annotations

import signal
from collections.abc import Generator, Iterator
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, settings

from needs import LeavingOut, is_on_ci, require
from progress import Progress
from real_browser import opened_chromium
from smarttestudo.domain.robot import DataPathKind
from tiers import MARKERS, of_tiers

if TYPE_CHECKING:
    from playwright.sync_api import Browser

_UNTIMED = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True)
settings.register_profile("default", _UNTIMED, derandomize=True)
settings.register_profile("fuzz", _UNTIMED, derandomize=False)
settings.load_profile("default")
# Where Hypothesis itself reads them at each run; its decorator may be applied to a test but once.
_SETTINGS_OF_LAW = "_hypothesis_internal_use_settings"
_SIGNALS_OF_A_TERMINAL = (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let whoever looks for rare failures try more examples than a law asks for, or another data path."""
    parser.addoption(
        "--examples-factor",
        metavar="N",
        type=float,
        default=1,
        help="try N times as many Hypothesis examples as each law asks for; 0.1 is a tenth",
    )
    parser.addoption(
        "--data-path",
        choices=[kind.value for kind in DataPathKind],
        default=DataPathKind.AUTO.value,
        help="how `testudo run` of live tests relays where the test does not say; as its own --data-path",
    )
    parser.addoption("--tiers", metavar="NAMES", help="only tests of these tiers, as in plain,contract")
    parser.addoption("--part", metavar="NAME", help="say how far this part is, in place of dots")


def pytest_configure(config: pytest.Config) -> None:
    """Start processes with the signals of a terminal, also under ``nohup`` and in the background of a shell.

    What is ignored stays ignored in children; what has a handler, though it does nothing, is reset in them.
    """
    for marker in MARKERS:
        config.addinivalue_line("markers", marker)
    config.pluginmanager.register(LeavingOut())
    if config.getoption("--part") and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Progress(config.getoption("--part")))
    for number in _SIGNALS_OF_A_TERMINAL:
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


@pytest.fixture(scope="session", name="chromium")
def need_chromium() -> None:
    """For tests that open a page."""
    require("chromium")


@pytest.fixture(scope="session", name="built_page")
def need_built_page() -> None:
    """For tests of the Ruler's page."""
    require("built_page")


@pytest.fixture(scope="session", name="built_documentation")
def need_built_documentation() -> None:
    """For tests of the documentation that the Ruler's page opens."""
    require("built_documentation")


@pytest.fixture(scope="session", name="ros")
def need_ros() -> None:
    """For tests on a ROS graph."""
    require("ros")


@pytest.fixture(scope="session", name="compiled_relays")
def need_compiled_relays() -> None:
    """For tests of what is compiled, and of what the compiler makes of it with other settings."""
    require("compiled_relays")


@pytest.fixture(scope="session", name="test_msgs")
def need_test_msgs() -> None:
    """For tests of messages of every type."""
    require("test_msgs")


@pytest.fixture(scope="session", name="network_namespaces")
def need_network_namespaces() -> None:
    """For tests of a link between two machines."""
    require("network_namespaces")


@pytest.fixture(scope="session")
def worker_browser(chromium: None) -> Iterator[Browser]:
    """The one Chromium of this worker; Playwright allows no second one."""
    with opened_chromium() as browser:
        yield browser


@pytest.fixture
def browser(worker_browser: Browser) -> Iterator[Browser]:
    """The same; what a test opened in it is closed behind it."""
    kept = worker_browser.contexts
    yield worker_browser
    for context in worker_browser.contexts:
        if context not in kept:
            context.close()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep the tiers that were asked for, and multiply the examples of every law, however many it wants."""
    factor: float = config.getoption("--examples-factor")
    if config.getoption("--tiers"):
        items[:], others = of_tiers(items, config.getoption("--tiers"))
        config.hook.pytest_deselected(items=others)
    for law in {item.obj for item in items if isinstance(item, pytest.Function)}:
        own = getattr(law, _SETTINGS_OF_LAW, None)
        if own is not None:
            setattr(
                law, _SETTINGS_OF_LAW, settings(own, max_examples=max(1, round(factor * own.max_examples)))
            )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A user's machine may lack a part and skip; continuous integration may not."""
    report = yield
    if report.skipped and not hasattr(report, "wasxfail") and is_on_ci():
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid} was skipped, which is a failure here: {report.longrepr}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """The same for a whole file that would be skipped."""
    report = yield
    if report.outcome == "skipped" and is_on_ci():
        report.outcome = "failed"
        report.longrepr = f"{collector.nodeid} was skipped, which is a failure here: {report.longrepr}"
    return report

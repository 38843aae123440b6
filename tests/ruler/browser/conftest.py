# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from first_free import first_free
from ruler.browser.ruler_page import EXAMPLES, RulerPage, copied, served
from ruler.browser.tabs import Tabs

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# Linux gives those above to connections that ask for none.
PORTS = range(20_000, 20_200)


@pytest.fixture(autouse=True)
def page_of_browser(chromium: None, built_page: None) -> None:
    """All tests of this folder open the Ruler's page."""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """The folder that the page of the test works in; it starts with the examples."""
    return copied(EXAMPLES, tmp_path / "project")


@pytest.fixture
def options() -> tuple[str, ...]:
    """What ``testudo ruler`` is started with, besides the project."""
    return ()


@pytest.fixture(scope="session")
def ruler_port() -> Iterator[int]:
    """Of all servers of this worker: an address that the browser knows need not be compiled anew."""
    with first_free("port", PORTS, _nobody_listens) as port:
        yield port


@pytest.fixture
def robot_port() -> Iterator[int]:
    """Of a robot that leaves and comes back: nobody else gets it meanwhile."""
    with first_free("port", PORTS, _nobody_listens) as port:
        yield port


def _nobody_listens(port: int) -> bool:
    try:
        with socket.create_server(("127.0.0.1", port)):
            return True
    except OSError:
        return False


@pytest.fixture(scope="session")
def tabs(worker_browser: Browser) -> Tabs:
    """The tabs of all tests of this worker."""
    return Tabs(worker_browser.new_context(accept_downloads=True, reduced_motion="reduce"))


@pytest.fixture
def ruler(tabs: Tabs, project: Path, options: tuple[str, ...], ruler_port: int) -> Iterator[RulerPage]:
    """The Ruler on its home screen. Afterwards: no console error, and no request to anybody else."""
    with served(project, ruler_port, options) as url:
        tab = tabs.open_at(url)
        tab.set_viewport_size({"width": 1440, "height": 900})
        page = RulerPage(tab, url)
        page.home()
        yield page
        tabs.close()
    assert page.complaints == []
    assert [request for request in page.requests if not request.startswith((url, "data:", "blob:"))] == []

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from smarttestudo.web.page import is_page_built
from web.browser.ruler_page import EXAMPLES, RulerPage, copied, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(autouse=True)
def built_page() -> None:
    if not is_page_built():
        pytest.skip("the Ruler's page is not built ('make gui'): it is not tested")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """The folder that the page of the test works in; it starts with the examples."""
    return copied(EXAMPLES, tmp_path / "project")


@pytest.fixture
def options() -> tuple[str, ...]:
    """What ``testudo ruler`` is started with, besides the project."""
    return ()


@pytest.fixture
def ruler(browser: Browser, project: Path, options: tuple[str, ...]) -> Iterator[RulerPage]:
    """The Ruler on its home screen. Afterwards: no console error, and no request to anybody else."""
    with served(project, options=options) as url:
        context = browser.new_context(
            viewport={"width": 1440, "height": 900}, accept_downloads=True, reduced_motion="reduce"
        )
        page = RulerPage(context.new_page(), url)
        page.home()
        yield page
        context.close()
    assert page.complaints == []
    assert [request for request in page.requests if not request.startswith((url, "data:", "blob:"))] == []

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The files of the page, which are built from ``gui`` and come with the wheel."""

from __future__ import annotations

from pathlib import Path

from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Route, Router
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

PAGE_FOLDER = Path(__file__).parent / "static"
_INDEX = "index.html"
_MISSING = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>ADIRF Ruler</title>
<h1>The Ruler's page is not built</h1>
<p>This is a checkout of the source. Build the page with <code>make gui</code> and reload,
or install the wheel: <code>pip install 'smarttestudo[studio]'</code>.</p>
</html>
"""


def is_page_built() -> bool:
    """Whether there is a page to serve."""
    return (PAGE_FOLDER / _INDEX).is_file()


def page_files() -> ASGIApp:
    """Serves the page, or one that says how to get it."""
    if is_page_built():
        return StaticFiles(directory=PAGE_FOLDER, html=True)
    return Router([Route("/", _missing)])


async def _missing(_: Request) -> Response:
    return HTMLResponse(_MISSING, status_code=503)

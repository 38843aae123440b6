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
<p>SmartTestudo was installed without it, for want of Node.js or of a network.
In the checkout of its source:</p>
<ol>
<li><code>make gui</code> builds the page; it takes Node.js 20 or later, or gets it itself.</li>
<li><code>pip install '.[studio]'</code>, in the environment of this server, installs it.
A server that runs from the checkout does not need this step.</li>
<li>Start <code>testudo ruler</code> again.</li>
</ol>
</html>
"""


def is_page_built() -> bool:
    """Whether there is a page to serve."""
    return (PAGE_FOLDER / _INDEX).is_file()


def page_files() -> ASGIApp:
    """Serves the page, or one that explains how to build it."""
    if is_page_built():
        return StaticFiles(directory=PAGE_FOLDER, html=True)
    return Router([Route("/", _missing)])


async def _missing(_: Request) -> Response:
    return HTMLResponse(_MISSING, status_code=503)

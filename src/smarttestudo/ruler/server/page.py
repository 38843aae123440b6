# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The files of the page and of the documentation, which are built from ``gui`` and ``docs``."""

from __future__ import annotations

import mimetypes
import os
import re
from collections.abc import Sequence
from pathlib import Path

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from starlette.routing import BaseRoute, Mount, Route, Router
from starlette.staticfiles import NotModifiedResponse, StaticFiles
from starlette.types import ASGIApp, Scope

from smarttestudo.ruler.server.routes import taken_encodings

PAGE_FOLDER = Path(__file__).parent / "static"
DOCUMENTATION_FOLDER = Path(__file__).parent / "documentation"
_INDEX = "index.html"
_ENCODINGS = (("br", ".br"), ("gzip", ".gz"))
"""What the build compresses with, best first, and how those files end."""
_HASHED = re.compile(r"-[\w-]{8}\.(?:js|css)\Z|\.[0-9a-f]{8}\.(?:min\.)?(?:js|css)\Z")
_ASKED_FOR = (".html", ".json")
_FOR_EVER = "public, max-age=31536000, immutable"
_FOR_A_DAY = "max-age=86400"
_ASK_AGAIN = "no-cache"
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


_WITHOUT_DOCUMENTATION = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>ADIRF Ruler</title>
<h1>The documentation is not built</h1>
<p>SmartTestudo was installed without it, for want of a network. In the checkout of its source,
<code>docs</code> has its text, and <code>make documentation</code> builds it; then install again.</p>
</html>
"""


def is_page_built() -> bool:
    """Whether there is a page to serve."""
    return (PAGE_FOLDER / _INDEX).is_file()


def page_files() -> ASGIApp:
    """Serves the page, or one that explains how to build it."""
    if is_page_built():
        return PageFiles(directory=PAGE_FOLDER, html=True)
    return Router([Route("/", _missing)])


def documentation_routes(folder: Path = DOCUMENTATION_FOLDER) -> Sequence[BaseRoute]:
    """Routes of the documentation, which comes with the wheel, and of what a finding means in it."""
    if not (folder / _INDEX).is_file():
        return [Route("/documentation/{path:path}", _no_documentation)]

    def finding(request: Request) -> Response:
        # Errors of syntax explain themselves; what they are about is the language.
        code = request.path_params["code"]
        for page in folder.glob("reference/checks-*.html"):
            if f'id="{code}"' in page.read_text(encoding="utf-8"):
                return RedirectResponse(f"../reference/{page.name}#{code}")
        return RedirectResponse("../language.html")

    files = PageFiles(directory=folder, html=True)
    return [Route("/documentation/finding/{code}", finding), Mount("/documentation", files)]


class PageFiles(StaticFiles):
    """The built files, compressed where the browser takes that.

    A name with a hash of what is in it is kept for ever, a picture for a day; pages are asked for always.
    """

    def file_response(
        self,
        full_path: str | os.PathLike[str],
        stat_result: os.stat_result,
        scope: Scope,
        status_code: int = 200,
    ) -> Response:
        """The file, its compressed form, or that it did not change."""
        headers = Headers(scope=scope)
        path, encoding = _sent(Path(full_path), headers.get("accept-encoding", ""))
        told = {
            "Cache-Control": _kept(Path(full_path).name),
            "Vary": "Accept-Encoding",
        }
        if encoding:
            told["Content-Encoding"] = encoding
        kind = mimetypes.guess_type(full_path)[0] or "application/octet-stream"
        response = FileResponse(
            path,
            status_code=status_code,
            headers=told,
            media_type=kind,
            stat_result=path.stat() if encoding else stat_result,
        )
        if self.is_not_modified(response.headers, headers):
            return NotModifiedResponse(response.headers)
        return response


def _kept(name: str) -> str:
    if _HASHED.search(name):
        return _FOR_EVER
    return _ASK_AGAIN if name.endswith(_ASKED_FOR) else _FOR_A_DAY


def _sent(path: Path, accepted: str) -> tuple[Path, str | None]:
    """The file to send, and how it is compressed, for a browser that accepts these encodings."""
    taken = taken_encodings(accepted)
    for encoding, suffix in _ENCODINGS:
        compressed = path.with_name(path.name + suffix)
        if encoding in taken and compressed.is_file():
            return compressed, encoding
    return path, None


async def _no_documentation(_: Request) -> Response:
    return HTMLResponse(_WITHOUT_DOCUMENTATION, status_code=503)


async def _missing(_: Request) -> Response:
    return HTMLResponse(_MISSING, status_code=503)


_UNAUTHORIZED = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>ADIRF Ruler</title>
<meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark">
<style>
body { font: 1rem/1.5 system-ui, sans-serif; max-width: 40rem; margin: 3rem auto; padding: 0 1rem }
</style>
<main>
<h1>The token is missing or wrong</h1>
<p>Open the whole address that <code>testudo ruler</code> printed in its terminal, with all that follows
<code>?token=</code>. It prints another one each time that it is started.</p>
<p>A link that somebody copied from the page has no token. Open the printed address in this browser once;
then the link works, too.</p>
<p>If you did not start <code>testudo ruler</code>, ask whoever did. Nothing that this browser keeps of your
work is lost.</p>
</main>
</html>
"""


def token_page(status: int) -> Response:
    """The answer, with ``status``, to a browser that shows what it is sent."""
    return HTMLResponse(_UNAUTHORIZED, status_code=status)

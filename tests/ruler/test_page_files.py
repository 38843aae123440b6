# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files of the page and its documentation: compressed where that is taken, kept where they cannot change."""

from __future__ import annotations

import asyncio
import gzip
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from starlette.exceptions import HTTPException
from starlette.routing import Router
from starlette.types import ASGIApp, Message, Scope

from smarttestudo.ruler.server.page import PageFiles, documentation_routes

SCRIPT = b"console.log('as it is')"
FILES = {
    "index.html": b"<!doctype html>",
    "index.html.gz": gzip.compress(b"<!doctype html>"),
    "icon.svg": b"<svg/>",
    "assets/editor-BaNRLu9I.js": SCRIPT,
    "assets/editor-BaNRLu9I.js.br": b"what brotli made",
    "assets/editor-BaNRLu9I.js.gz": gzip.compress(SCRIPT),
}
ASSET = "assets/editor-BaNRLu9I.js"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, data in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data)
    return tmp_path


def get(folder: Path, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    return answer(PageFiles(directory=folder, html=True), path, **headers)


def answer(app: ASGIApp, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body."""
    told: list[Message] = []
    sent = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    scope: Scope = {
        "type": "http",
        "method": "GET",
        "path": f"/{path}",
        "root_path": "",
        "headers": sent,
        "extensions": {},
    }

    async def receive() -> Message:
        await asyncio.Event().wait()
        raise AssertionError("the browser says nothing more")

    async def send(message: Message) -> None:
        told.append(message)

    async def serve() -> None:
        await app(scope, receive, send)

    # Playwright, in the tests of pages, has a loop of its own in this thread.
    with ThreadPoolExecutor(max_workers=1) as thread:
        thread.submit(asyncio.run, serve()).result()
    start, *rest = told
    answered = {name.decode(): value.decode() for name, value in start["headers"]}
    return start["status"], answered, b"".join(each.get("body", b"") for each in rest)


@pytest.mark.parametrize(
    ("accepted", "encoding"),
    [
        ("gzip, deflate, br, zstd", "br"),
        ("gzip, deflate", "gzip"),
        ("gzip;q=0.5, BR;q=0", "gzip"),
        ("br;q=0.000, gzip;q=0", None),
        ("identity", None),
        ("", None),
    ],
)
def test_a_file_goes_as_the_browser_takes_it_best(folder: Path, accepted: str, encoding: str | None) -> None:
    status, headers, body = get(folder, ASSET, accept_encoding=accepted)
    suffix = {"br": ".br", "gzip": ".gz", None: ""}[encoding]
    assert status == 200
    assert headers.get("content-encoding") == encoding
    assert headers["vary"] == "Accept-Encoding"
    assert headers["content-type"].startswith("text/javascript")
    assert body == FILES[ASSET + suffix]


def test_what_was_not_compressed_goes_as_it_is(folder: Path) -> None:
    _, headers, body = get(folder, "icon.svg", accept_encoding="br, gzip")
    assert "content-encoding" not in headers
    assert body == FILES["icon.svg"]


def test_names_with_a_hash_are_kept_for_ever_and_the_page_is_asked_for(folder: Path) -> None:
    assert get(folder, ASSET)[1]["cache-control"] == "public, max-age=31536000, immutable"
    assert get(folder, "icon.svg")[1]["cache-control"] == "max-age=86400"
    status, headers, _ = get(folder, "", accept_encoding="gzip")
    assert (status, headers["cache-control"]) == (200, "no-cache")
    status, told, body = get(folder, "", accept_encoding="gzip", if_none_match=headers["etag"])
    assert (status, told["cache-control"], body) == (304, "no-cache", b"")
    assert get(folder, "", accept_encoding="", if_none_match=headers["etag"])[0] == 200


@pytest.fixture
def documentation(tmp_path: Path) -> ASGIApp:
    """The documentation in a folder beside which there is something else."""
    made = {
        "documentation/index.html": "start",
        "documentation/reference/checks-rates.html": '<h2 id="two-defaults">',
        "documentation/assets/javascripts/bundle.a5f9d56c.min.js": "script",
        "documentation/search/search_index.json": "{}",
        "secret.html": "secret",
    }
    for name, text in made.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "documentation" / "link.html").symlink_to(tmp_path / "secret.html")
    return Router(documentation_routes(tmp_path / "documentation"))


def test_the_documentation_is_read_below_its_own_address(documentation: ASGIApp) -> None:
    for path in ("documentation/", "documentation/index.html"):
        status, headers, body = answer(documentation, path)
        assert (status, body, headers["cache-control"]) == (200, b"start", "no-cache")
        assert headers["content-type"].startswith("text/html")
    kept = answer(documentation, "documentation/assets/javascripts/bundle.a5f9d56c.min.js")[1]
    assert kept["cache-control"] == "public, max-age=31536000, immutable"
    assert answer(documentation, "documentation/search/search_index.json")[1]["cache-control"] == "no-cache"


@pytest.mark.parametrize(
    "path", ["../secret.html", "reference/../../secret.html", "link.html", "/etc/passwd"]
)
def test_nothing_beside_the_documentation_is_sent(documentation: ASGIApp, path: str) -> None:
    with pytest.raises(HTTPException) as refused:
        answer(documentation, f"documentation/{path}")
    assert refused.value.status_code == 404


@pytest.mark.parametrize(
    ("code", "place"),
    [
        ("two-defaults", "../reference/checks-rates.html#two-defaults"),
        ("expected-statement", "../language.html"),
        ('"><script>', "../language.html"),
    ],
)
def test_a_finding_leads_to_its_heading_and_an_error_of_syntax_to_the_language(
    documentation: ASGIApp, code: str, place: str
) -> None:
    status, headers, _ = answer(documentation, f"documentation/finding/{code}")
    assert (status, headers["location"]) == (307, place)


def test_where_the_documentation_is_not_built_its_address_says_how_to(tmp_path: Path) -> None:
    status, _, body = answer(Router(documentation_routes(tmp_path)), "documentation/ruler/rules.html")
    assert status == 503
    assert b"make documentation" in body

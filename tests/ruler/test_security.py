# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What strangers can and cannot do with a Ruler that runs on somebody's laptop."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from http.cookies import SimpleCookie
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from ruler.ruler_server import TIMEOUT_S, Page, served
from smarttestudo.ruler.server.guard import ServerAddress

TOKEN = "a-token-that-was-printed"
GIGABYTE = 10**9


@pytest.fixture(scope="module")
def secret_page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with served(tmp_path_factory.mktemp("project"), token=TOKEN) as page:
        yield page


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://127.0.0.1", "http://localhost:1"]
)
def test_a_page_of_another_site_gets_nothing(examples_page: Page, origin: str) -> None:
    for method, path in (("GET", "/api/project"), ("PUT", "/api/file"), ("POST", "/api/document")):
        answer = examples_page.request(method, path, b"{}", {"Origin": origin})
        assert (answer.status, answer.error) == (403, "the request comes from another site's page")


def test_another_site_without_an_origin_is_told_by_fetch_metadata(examples_page: Page) -> None:
    answer = examples_page.request(
        "GET", "/api/project", headers={"Origin": None, "Sec-Fetch-Site": "cross-site"}
    )
    assert answer.status == 403


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1:1", "127.0.0.1@evil.example:{port}", "", "::1"]
)
def test_a_name_that_was_made_to_point_here_gets_nothing(examples_page: Page, host: str) -> None:
    host = host.format(port=examples_page.port)
    answer = examples_page.request("GET", "/api/project", headers={"Host": host, "Origin": f"http://{host}"})
    assert answer.status == 403


@pytest.mark.parametrize("host", ["127.0.0.1:{port}", "localhost:{port}", "[::1]:{port}"])
def test_the_servers_own_names_are_let_in(examples_page: Page, host: str) -> None:
    host = host.format(port=examples_page.port)
    answer = examples_page.request("GET", "/api/project", headers={"Host": host, "Origin": f"http://{host}"})
    assert answer.status == 200


@pytest.mark.parametrize("origin", ["http://evil.example", None])
def test_a_web_socket_of_another_site_is_not_opened(examples_page: Page, origin: str | None) -> None:
    with pytest.raises(InvalidStatus) as refused:
        connect(f"ws://127.0.0.1:{examples_page.port}/ws", origin=origin, proxy=None)  # type: ignore[arg-type]
    assert refused.value.response.status_code == 403


def test_a_web_socket_says_who_it_is_and_ends_where_too_much_comes(examples_page: Page) -> None:
    url = f"ws://127.0.0.1:{examples_page.port}/ws"
    with connect(url, origin=examples_page.origin, proxy=None) as page:  # type: ignore[call-overload]
        assert '"kind":"hello"' in str(page.recv(timeout=TIMEOUT_S))
        page.send(b"\0" * 10)
        page.send("{}")
        with pytest.raises(ConnectionClosed):  # noqa: PT012  either notices first
            page.send(" " * 3_000_000)
            for _ in range(20):
                page.recv(timeout=TIMEOUT_S)


@pytest.mark.parametrize(
    "path", ["/", "/api/project", "/index.html", "/?token=wrong", "/api/project?token=" + TOKEN]
)
def test_without_the_token_there_is_nothing_to_see(secret_page: Page, path: str) -> None:
    answer = secret_page.get(path)
    assert (answer.status, answer.error) == (401, "the token is missing or wrong")
    with pytest.raises(InvalidStatus):
        connect(f"ws://127.0.0.1:{secret_page.port}/ws", origin=secret_page.origin, proxy=None)  # type: ignore[call-overload]


def test_the_token_in_the_address_becomes_a_cookie(secret_page: Page) -> None:
    answer = secret_page.get(f"/?token={TOKEN}")
    assert (answer.status, answer.headers["location"]) == (303, "/")
    cookie = SimpleCookie(answer.headers["set-cookie"])
    (name,) = cookie
    assert cookie[name]["httponly"] is True
    assert cookie[name]["samesite"] == "lax"
    project = secret_page.request("GET", "/api/project", headers={"Cookie": f"{name}={cookie[name].value}"})
    assert project.status == 200
    wrong = secret_page.request("GET", "/api/project", headers={"Cookie": f"{name}=x; broken"})
    assert wrong.status == 401


def test_with_a_token_only_addresses_and_own_names_are_served(secret_page: Page) -> None:
    for name, status in (("robot.local", 401), ("192.168.0.7", 401), ("evil.example", 403)):
        host = f"{name}:{secret_page.port}"
        answer = secret_page.request("GET", "/", headers={"Host": host, "Origin": f"http://{host}"})
        assert answer.status == status, name


def test_only_this_machine_needs_no_token() -> None:
    for host in ("127.0.0.1", "localhost", "::1"):
        assert ServerAddress.at(host, 8750).token is None
    for host in ("0.0.0.0", "::", "192.168.0.7", "robot"):
        access = ServerAddress.at(host, 8750, machine="Lab-7")
        assert access.token is not None
        assert access.url.startswith(f"http://{'Lab-7' if host in ('0.0.0.0', '::') else host}:8750/")
        assert all(access.allows_host(f"{name}:8750") for name in ("lab-7", "Lab-7.local", "10.0.0.5"))
        assert access.token in access.url
        assert access.token not in repr(access)


@pytest.mark.parametrize(
    "name",
    [
        "../outside.adirf",
        "a/../../outside.adirf",
        "/etc/hosts.adirf",
        "link.adirf",
        "linked/outside.adirf",
        "..\\outside.adirf",
        "a\0.adirf",
        "",
        ".",
        "C:outside.adirf",
    ],
)
def test_no_name_leads_out_of_the_project(tmp_path: Path, name: str) -> None:
    project = tmp_path / "project"
    project.mkdir()
    secret = tmp_path / "outside.adirf"
    secret.write_text("secret")
    (project / "link.adirf").symlink_to(secret)
    (project / "linked").symlink_to(tmp_path)
    with served(project) as page:
        read = page.request("GET", "/api/file?name=" + name.replace("\0", "%00").replace("\\", "%5C"))
        written = page.put("/api/file", {"name": name, "text": "x", "base_hash": None})
        assert (read.status, written.status) == (403, 403)
        assert page.get("/api/project").json["files"] == []
    assert secret.read_text() == "secret"


@pytest.mark.parametrize("name", ["evil.sh", ".bashrc", "x.py", ".adirf", ".x.toml", "folder"])
def test_only_the_rulers_own_kinds_of_files_are_written(tmp_path: Path, name: str) -> None:
    with served(tmp_path) as page:
        assert page.put("/api/file", {"name": name, "text": "x", "base_hash": None}).status == 403
    assert list(tmp_path.iterdir()) == []


def test_an_upload_that_says_it_has_a_gigabyte_is_refused_unread(examples_page: Page) -> None:
    with socket.create_connection(("127.0.0.1", examples_page.port), timeout=TIMEOUT_S) as stranger:
        stranger.sendall(
            f"POST /api/document HTTP/1.1\r\nHost: 127.0.0.1:{examples_page.port}\r\n"
            f"Content-Type: application/json\r\nContent-Length: {GIGABYTE}\r\n\r\n".encode()
        )
        assert stranger.recv(4096).startswith(b"HTTP/1.1 413 ")


def test_an_upload_that_grows_to_a_gigabyte_is_cut_off(examples_page: Page) -> None:
    sent = 0
    with socket.create_connection(("127.0.0.1", examples_page.port), timeout=TIMEOUT_S) as stranger:
        stranger.sendall(
            f"POST /api/document HTTP/1.1\r\nHost: 127.0.0.1:{examples_page.port}\r\n"
            "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n".encode()
        )
        piece = b"10000\r\n" + b" " * 0x10000 + b"\r\n"
        answer = b""
        while not answer and sent < GIGABYTE:
            stranger.settimeout(TIMEOUT_S)
            try:
                sent += stranger.send(piece)
            except (BrokenPipeError, ConnectionResetError):
                break
            stranger.settimeout(0.0)
            try:
                answer = stranger.recv(4096)
            except (BlockingIOError, ConnectionResetError):
                continue
        assert answer.startswith(b"HTTP/1.1 413 ") or sent < GIGABYTE
    assert sent < GIGABYTE / 10
    assert examples_page.get("/api/project").status == 200


@pytest.mark.parametrize(
    ("body", "content_type"),
    [
        (b'{"text": "begin end"}', "text/plain"),
        (b'{"text": "begin end"}', None),
        (b"not json", "application/json"),
        (b'{"text": 5}', "application/json"),
        (b"[" * 100_000, "application/json"),
        (b'{"text": "\\ud800"}', "application/json"),
        (b"\xff\xfe", "application/json"),
    ],
)
def test_what_is_no_request_is_refused_with_a_sentence(
    examples_page: Page, body: bytes, content_type: str | None
) -> None:
    answer = examples_page.request("POST", "/api/document", body, {"Content-Type": content_type})
    assert answer.status in (400, 415)
    assert answer.error


def test_a_script_in_a_comment_or_name_comes_back_as_text(examples_page: Page) -> None:
    script = "<script>alert(1)</script>"
    rule = f'Rule "{script}" If CheckValue /a age > 1 Then SetFrequency /a 1'
    text = f"// {script}\nbegin\n// {script}\n{rule}\nend"
    answer = examples_page.post("/api/document", {"text": text})
    (rule,) = answer.json["collections"][0]["statements"]
    assert (rule["name"], rule["comments"]) == (script, [script])
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"
    topic = examples_page.post("/api/document", {"text": f"begin SetFrequency /{script} 1 end"})
    assert topic.json["findings"][0]["severity"] == "error"


def test_every_answer_forbids_foreign_scripts_frames_and_guesses(examples_page: Page) -> None:
    for path in ("/", "/api/project", "/api/nothing", "/nothing.js"):
        headers = examples_page.get(path).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "script-src 'self';" in policy
        assert "frame-ancestors 'none'" in policy
        assert "http" not in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert "access-control-allow-origin" not in headers

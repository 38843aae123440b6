# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What clients do wrong is no traceback in the Ruler's log."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosedError

from ruler.page_socket import open_socket
from ruler.ruler_server import TIMEOUT_S, Page, served


def leave_with_half_a_body(page: Page) -> None:
    with socket.create_connection(("127.0.0.1", page.port), timeout=TIMEOUT_S) as client:
        client.sendall(
            f"POST /api/document HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\nOrigin: {page.origin}\r\n"
            'Content-Type: application/json\r\nContent-Length: 100\r\n\r\n{"text": "beg'.encode()
        )
        client.shutdown(socket.SHUT_WR)
        while client.recv(4096):
            pass


def send_text_that_is_none(page: Page) -> None:
    with open_socket(page) as opened:
        opened.connection.send(b"\xff\xfe", text=True)
        with pytest.raises(ConnectionClosedError) as closed:
            list(opened.connection)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1007


@pytest.mark.parametrize("misbehave", [leave_with_half_a_body, send_text_that_is_none])
def test_a_client_that_goes_wrong_leaves_no_traceback(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], misbehave: object
) -> None:
    assert callable(misbehave)
    with served(tmp_path) as page:
        misbehave(page)
        assert page.get("/api/project").status == 200
    assert "Traceback" not in capsys.readouterr().err

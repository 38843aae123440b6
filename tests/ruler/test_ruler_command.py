# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo ruler`` as its user starts and ends it."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from ruler.ruler_server import TIMEOUT_S, Page
from smarttestudo.cli.main import main


@pytest.mark.contract
def test_the_command_prints_where_the_page_is_serves_it_and_ends_at_ctrl_c(tmp_path: Path) -> None:
    (tmp_path / "a.adirf").write_text("begin end")
    command = [sys.executable, "-m", "smarttestudo", "ruler", str(tmp_path / "a.adirf"), "--port", "0"]
    with subprocess.Popen(
        [*command, "--no-browser"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        line = process.stdout.readline().decode()
        matched = re.fullmatch(r"ADIRF Ruler of (.*): http://127\.0\.0\.1:(\d+)/ \(Ctrl-C ends it\)\n", line)
        assert matched, line
        assert matched[1] == str(tmp_path.resolve())
        assert Page(port=int(matched[2])).get("/api/project").json["opened"] == "a.adirf"
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=TIMEOUT_S)
    assert (process.returncode, errors) == (0, b"")


def test_a_port_in_use_and_a_missing_folder_are_said_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["ruler", str(tmp_path), "--port", str(port), "--no-browser"]) == 1
    assert capsys.readouterr().err == (
        f"127.0.0.1:{port}: error: the server cannot listen there: Address already in use; "
        "give another --port\n"
    )
    assert main(["ruler", str(tmp_path / "no" / "a.adirf"), "--no-browser"]) == 1
    assert capsys.readouterr().err.count("\n") == 1
    assert main(["ruler", str(tmp_path), "--host", "999.1.1.1", "--no-browser"]) == 1
    assert capsys.readouterr().err.endswith("; give another --host\n")


@pytest.mark.parametrize("port", ["70000", "-1", "http", "²", "9" * 5000])
def test_what_is_no_port_is_wrong_usage(capsys: pytest.CaptureFixture[str], port: str) -> None:
    assert main(["ruler", f"--port={port}", "--no-browser"]) == 2
    assert "a port is a number from 0 to 65535, not " in capsys.readouterr().err

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a newcomer does by the words of a page alone, from an empty folder.

Two more such paths have tests of their own: a rule that is written, checked and replayed
(``tests/docs/test_documents.py`` follows docs/tutorials/first-rules.md), and a live relay (README.md, in
``test_installations.py``).
"""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from docs.code_blocks import Mark, blocks_of
from installations.conftest import MakeEnvironment
from installations.environments import LIMIT_S, clean_variables, does
from link.foxglove.foxglove_client import decoded_by_foxglove
from link.zenoh.ends import free_endpoint, until

START = "docs/index.md"
CAMERA = "docs/tutorials/camera-over-lte.md"
IMAGE = "/camera/image_raw/compressed"
SMALL_FRAME_BYTES = 50_000


def lines_of(page: str) -> list[str]:
    """The command lines of a page that this file runs, from top to bottom."""
    shell = [block for block in blocks_of(page) if block.language == "sh" and block.mark is Mark.RUN_BY]
    return [line for block in shell for line in block.commands]


def moved(line: str, places: dict[str, str]) -> str:
    """The same with other ports, since tests run beside each other."""
    for written, here in places.items():
        line = line.replace(written, here)
    return line


@contextmanager
def shell_of(lines: list[str], folder: Path, domain: int) -> Iterator[None]:
    """A shell that runs ``lines``, and all that it started, until the block ends."""
    variables = {
        **clean_variables(),
        "PYTHONUNBUFFERED": "1",
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    script = "\n".join([*lines, "wait"])
    with subprocess.Popen(["sh", "-ec", script], cwd=folder, env=variables, start_new_session=True) as shell:
        try:
            yield
        finally:
            # What a shell starts in its background is not interrupted by Ctrl-C.
            os.killpg(shell.pid, signal.SIGTERM)


def test_the_start_page_leads_to_the_report_of_the_demo(checkout_with_studio: Path) -> None:
    does(["sh", "-ec", lines_of(START)[-1]], cwd=checkout_with_studio)
    report = (checkout_with_studio / "demo-out" / "report.html").read_text(encoding="utf-8")
    assert "Warehouse Corridor" in report


def test_without_ros_an_operator_sees_a_camera_robot_in_foxglove_and_gets_what_it_recorded(
    environment: MakeEnvironment, wheel: str, domain: int, tmp_path: Path
) -> None:
    make, install, *lines = lines_of(CAMERA)
    assert (make, install) == ("python3 -m venv testudo-venv", "testudo-venv/bin/pip install '.[ros,link]'")
    (tmp_path / "testudo-venv").symlink_to(environment("ros-link", f"{wheel}[ros,link]").folder)
    (rules,) = (block for block in blocks_of(CAMERA) if block.title == "camera.adirf")
    (tmp_path / "camera.adirf").write_text(rules.text, encoding="utf-8")
    port, foxglove = (free_endpoint().rpartition(":")[2] for _ in range(2))
    places = {":7447": f":{port}", "8765": foxglove}
    receive, simulate, relay, top, listed_there, listed_here = (moved(line, places) for line in lines)
    # The default of --listen is the port that other tests have, too.
    receive = receive.replace("--no-ros", f"--listen tcp/127.0.0.1:{port} --no-ros")
    said = tmp_path / "receive.txt"

    def is_said(words: str) -> bool:
        return said.is_file() and words in said.read_text(encoding="utf-8", errors="replace")

    with shell_of([receive, simulate, relay, f"{top} > top.txt"], tmp_path, domain):
        until(lambda: is_said("Foxglove: open the connection"), within_s=LIMIT_S)
        shown = decoded_by_foxglove(int(foxglove), "/odom", IMAGE)
        assert shown["/odom"]["schemaName"] == "nav_msgs/msg/Odometry"
        assert len(shown[IMAGE]["message"]["data"]) > SMALL_FRAME_BYTES
        until(lambda: is_said("ada: incident incidents/ada/"), within_s=LIMIT_S)
        assert "close_call" in does(["sh", "-ec", listed_there], cwd=tmp_path)
        assert IMAGE in (tmp_path / "top.txt").read_text(encoding="utf-8")
    assert "Close call" in does(["sh", "-ec", listed_here], cwd=tmp_path)

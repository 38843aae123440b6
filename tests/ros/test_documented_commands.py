# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The commands of the pages that a reader follows, each page from top to bottom, beside one robot."""

from __future__ import annotations

import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from docs.code_blocks import ROOT, blocks_of, followed_pages, shell_blocks_run_of
from link.zenoh.ends import free_endpoint
from made_demos import made_demo, run_testudo_in
from made_once import made_once
from ros.ros_processes import TESTUDO, Process, SmallRobot

SECURED = "docs/how-to/secure-link.md"
PAGES = [page for page in followed_pages() if shell_blocks_run_of(page)]
ODOM = {"type": "nav_msgs/msg/Odometry", "hz": 20}
CLOCK = {"type": "rosgraph_msgs/msg/Clock", "hz": 20, "from_s": 1, "step_ms": 50}
RULES = """begin
    SetFrequency /odom 10

    Rule "Far"
    If (CheckValue /odom pose_x > 100)
    Then
        Record "far" Before 1 s After 1 s
    EndIf
end
"""
SAYS = {
    "run": "Relaying",
    "receive": "Receiving",
    "ruler": "http://",
    "top": "/odom",
    "echo": " Hz ",
    "simulate": "Driving",
}
"""What a command that goes on until Ctrl-C says once it does what it is for."""
ENDED_BY_CTRL_C = (0, 130)
OPERATOR, ROBOT = (
    "testudo receive --listen tls/192.168.1.5:7447 --zenoh-config operator.json5",
    "testudo run --rules rules.adirf --link tls/192.168.1.5:7447 --robot ada --zenoh-config robot.json5",
)
BESIDE = {
    "docs/how-to/change-rules.md": ("testudo run --rules rules.adirf --allow-writing-rules",),
    "docs/how-to/dead-reckoning.md": (ROBOT,),
    "docs/how-to/fetch-incidents.md": (OPERATOR, f"{ROBOT} --incidents kept"),
    "docs/how-to/operators-end.md": (
        "testudo run --rules rules.adirf --link tcp/127.0.0.1:7447 --robot ada",
    ),
    "docs/how-to/watch-without-ros.md": (OPERATOR, ROBOT),
    "docs/how-to/why-this-rate.md": ("testudo run --rules warehouse.adirf",),
}
"""What goes on already where a page begins, by its own words."""


class Reader:
    """Follows pages in a folder with two machines: a robot, and an operator's beyond a link."""

    def __init__(self, folder: Path, robot: SmallRobot, operators: SmallRobot) -> None:
        self._robot, self._operators = robot, operators
        self._going_on: dict[str, Process] = {}
        port = free_endpoint().rpartition(":")[2]
        self._here = {
            "192.168.1.5": "127.0.0.1",
            ":7447": f":{port}",
            "testudo receive --no-ros": f"testudo receive --listen tcp/127.0.0.1:{port} --no-ros",
            "--foxglove 8765": "--foxglove 0",
            "--openmetrics 9464": "--openmetrics 0",
            "--host 0.0.0.0": "--host 127.0.0.2",
            "testudo ruler": "testudo ruler --port 0",
            "/var/tmp/": f"{folder}/",
            "--seconds 10": "--seconds 1 --timeout 60",
        }

    def does(self, line: str) -> None:
        """One line: a command that ends must succeed; one that goes on ends where its like begins."""
        if line == "testudo receive":
            line = "testudo receive --listen tcp/127.0.0.1:7447"
        for written, here in self._here.items():
            line = line.replace(written, here)
        program, *arguments = shlex.split(line)
        if program != "testudo":
            subprocess.run(["sh", "-ec", line], check=True, capture_output=True, text=True)
            return
        kind = arguments[0]
        machine = self._operators if kind == "receive" or "--connect" in arguments else self._robot
        if kind not in SAYS:
            assert self._until_done(machine, arguments) == 0
            return
        self.ends(kind)
        started = machine.command(sys.executable, "-c", TESTUDO, *arguments, BROWSER="true")
        started.line_with(SAYS[kind])
        self._going_on[kind] = started

    def ends(self, kind: str) -> None:
        """Ctrl-C in the terminal of this command, if there is one."""
        if (going_on := self._going_on.pop(kind, None)) is not None:
            going_on.signal(signal.SIGINT)
            assert going_on.exit_code() in ENDED_BY_CTRL_C, "".join(going_on.output)

    def ends_all(self) -> None:
        for kind in list(self._going_on):
            self.ends(kind)

    def _until_done(self, machine: SmallRobot, arguments: list[str]) -> int:
        """The exit code of a command that ends; a robot is not heard at once over a link."""
        for _ in range(10):
            process = machine.testudo(*arguments)
            code = process.exit_code()
            if code == 0 or "--connect" not in arguments:
                break
        assert code == 0, "".join(process.output)
        return code


def make_desk(factory: pytest.TempPathFactory, desk: Path) -> None:
    """The files that the pages speak of: those that they show, of the checkout, or of a reader's own."""
    for name in ("examples", "extras", "src/smarttestudo/rules/presets"):
        shutil.copytree(ROOT / name, desk / name)
    # A file of a later page replaces the one of an earlier page: the access control that of the first link.
    for block in (block for page in PAGES for block in blocks_of(page) if block.title is not None):
        (desk / str(block.title)).write_text(block.text, encoding="utf-8")
    (desk / "rules").mkdir()
    for path in ("rules.adirf", "rules/rules.adirf"):
        (desk / path).write_text(RULES, encoding="utf-8")
    shutil.copy(ROOT / "examples" / "warehouse.adirf", desk)
    shutil.copy(ROOT / "src/smarttestudo/rules/presets/turtlebot3.toml", desk / "robot.toml")
    demo, _ = made_demo(factory, "--seconds", "20")
    shutil.copytree(demo / "baseline", desk / "yesterday")
    rules = ("--rules", "examples/near_miss.adirf", "--output", "received", "--incidents", "kept")
    assert run_testudo_in(desk, "replay", "yesterday", *rules).code == 0
    for line in shell_blocks_run_of(SECURED)[0].commands:
        here = line.replace("192.168.1.5", "127.0.0.1")
        subprocess.run(["sh", "-ec", here], cwd=desk, check=True, capture_output=True)


@pytest.fixture
def desk(tmp_path_factory: pytest.TempPathFactory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of this reader's own with all files."""
    made = made_once(tmp_path_factory, "desk", lambda folder: make_desk(tmp_path_factory, folder))
    shutil.copytree(made, tmp_path / "desk")
    monkeypatch.chdir(tmp_path / "desk")
    return tmp_path / "desk"


@pytest.fixture(scope="module")
def source(domain: int, tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """The robot's own node, for all pages."""
    robot = SmallRobot(domain, tmp_path_factory.mktemp("source"))
    robot.source(odom=ODOM, clock=CLOCK)
    yield
    robot.end()


@pytest.mark.parametrize("page", PAGES)
@pytest.mark.usefixtures("source")
def test_the_commands_of_a_page_do_what_it_says(
    page: str, desk: Path, robot: SmallRobot, operators: SmallRobot
) -> None:
    reader = Reader(desk, robot, operators)
    for line in BESIDE.get(page, ()):
        reader.does(line)
    for block in shell_blocks_run_of(page):
        for line in block.commands:
            reader.does(line)
    reader.ends_all()

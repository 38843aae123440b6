# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names and texts of others, in recordings, rules and peers, do not command a terminal."""

from __future__ import annotations

import ast
import io
import os
import pty
import re
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from unittest.mock import patch

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import Writer

import smarttestudo
from bags.bag_factory import ODOM, START_NS, TYPES, cdr, message_of
from smarttestudo.cli.link_options import warn
from smarttestudo.cli.main import main
from smarttestudo.cli.output import write_file_text, write_lines

BLINKING = "\x1b[5;7m"
HOSTILE = f"\x1b]0;x\x07{BLINKING}\x1b[2J\x9b2J\x85\n\r\x08\x7f\u202e\u2028"
"""An operating system command, a bell, blinking, an erased screen, C1, line ends and text turned round."""
OWN_SEQUENCE = re.compile(r"\x1b\[(?:\?25[hl]|\d*[AK]|[\d;]*m)")
"""Colours, the cursor, and a row that is written anew."""
TEXTS = st.text(st.characters() | st.sampled_from(HOSTILE))


def hostile_recording(folder: Path) -> Path:
    """A pose and one topic of each kind that is left out of something, all by names of an attacker."""
    path = folder / f"drive{HOSTILE}.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2", "test")
        text, _ = TYPES.generate_msgdef(ODOM.type_name, ros_version=2)
        odometry = writer.register_schema(ODOM.type_name, "ros2msg", text.encode())
        broken = writer.register_schema(f"demo/msg/X{HOSTILE}", "ros2msg", f"{HOSTILE} {HOSTILE}".encode())
        qos = {"offered_qos_profiles": f"- history: [{HOSTILE}"}
        odom = writer.register_channel("/odom", "cdr", odometry, {"offered_qos_profiles": ""})
        for schema, encoding in ((odometry, "cdr"), (broken, "cdr"), (0, f"own{HOSTILE}")):
            channel = writer.register_channel(f"/{encoding}{schema}{HOSTILE}", encoding, schema, qos)
            for number in range(40):
                stamp_ns = START_NS + number * 100_000_000
                message = message_of(ODOM.type_name, child_frame_id=HOSTILE)
                message.header.frame_id = HOSTILE
                message.pose.pose.position.x = float(number)
                writer.add_message(channel, stamp_ns, cdr(ODOM.type_name, message), stamp_ns)
                if channel == odom + 1:
                    writer.add_message(odom, stamp_ns, cdr(ODOM.type_name, message), stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]
    with path.open("r+b") as file:
        file.truncate(path.stat().st_size - 40)
    return path


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("hostile")
    recording = hostile_recording(folder)
    name = HOSTILE.replace("\n", "").replace("\r", "")
    (folder / f"r{name}.adirf").write_text(
        f'begin\nSetFrequency /odom 2\nSetFrequency "/{name}" 2\n# {HOSTILE}\nRule "{name}" '
        f'If CheckValue /odom pose_x > "{name}" Then SetFrequency /odom Full EndIf\nend\n'
    )
    (folder / "good.adirf").write_text(
        "begin\nSetFrequency /odom 2\nKeepWithin /odom position 0.5\n"
        'Rule "far" If CheckValue /odom pose_x > 5 Then SetFrequency /odom Full EndIf\nend\n'
    )
    (folder / "p.toml").write_text(f'[topics."/odom"]\n{"source_hz"} = 10\n[topics."{name}]\n')
    return recording


COMMANDS: dict[str, Callable[[Path], list[object]]] = {
    "info": lambda bag: ["bag", "info", bag],
    "rates": lambda bag: ["bag", "rates", bag, "--latency"],
    "rates as JSON": lambda bag: ["bag", "rates", bag, "--json"],
    "rates as CSV": lambda bag: ["bag", "rates", bag, "--csv"],
    "bandwidth": lambda bag: ["bag", "bandwidth", bag],
    "compare": lambda bag: ["bag", "compare", bag, bag],
    "loss": lambda bag: ["bag", "loss", bag],
    "loss of two": lambda bag: ["bag", "loss", bag, bag],
    "accuracy": lambda bag: ["bag", "accuracy", bag, "--rules", bag.parent / "good.adirf"],
    "report": lambda bag: ["bag", "report", bag, "-o", bag.parent / f"r{HOSTILE}.html"],
    "profile": lambda bag: ["profile", "--bag", bag],
    "replay": lambda bag: [
        *("replay", bag, "--rules", bag.parent / "good.adirf"),
        *("--output", bag.parent / f"o{HOSTILE}{len(list(bag.parent.iterdir()))}"),
    ],
    "hostile rules": lambda bag: ["check", *bag.parent.glob("r*.adirf"), "--bag", bag],
    "hostile rules over it": lambda bag: [
        *("replay", bag, "--rules", next(bag.parent.glob("r*.adirf")), "--output", bag.parent / "no"),
    ],
    "hostile profile": lambda bag: ["check", bag.parent / "good.adirf", "--profile", bag.parent / "p.toml"],
    "no such file": lambda bag: ["bag", "info", bag.parent / HOSTILE.replace("\n", "")],
    "no such option": lambda _: ["bag", "info", f"--{HOSTILE}"],
    "no such command": lambda _: [HOSTILE],
    "no such topic": lambda bag: ["bag", "rates", bag, "--topics", HOSTILE],
    "formatting": lambda bag: ["fmt", "--check", *bag.parent.glob("*.adirf")],
}


def on_terminal(run: Callable[[], object]) -> str:
    """What ``run`` writes to a terminal that is its standard output and standard error."""
    controller, terminal = pty.openpty()
    shown = bytearray()

    def read() -> None:
        # The end of what a terminal shows is an error on Linux.
        with os.fdopen(controller, "rb", buffering=0) as screen, suppress(OSError):
            while more := screen.read(4096):
                shown.extend(more)

    reader = threading.Thread(target=read)
    reader.start()
    with (
        os.fdopen(terminal, "w", encoding="utf-8") as stream,
        patch.multiple(sys, stdout=stream, stderr=stream),
        suppress(SystemExit),
    ):
        run()
    reader.join()
    return shown.decode("utf-8")


@pytest.mark.parametrize("name", COMMANDS)
def test_no_command_lets_them_through_to_a_terminal(
    name: str, hostile: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERM", "xterm")
    shown = on_terminal(lambda: main([*map(str, COMMANDS[name](hostile))]))
    text = OWN_SEQUENCE.sub("", shown.replace("\r\n", "\n"))
    if "\x1b[K" in shown or "\x1b[2K" in shown:
        # A line that is written over begins at its first column.
        text = text.replace("\r", "")
    assert text.strip()
    assert BLINKING not in shown
    assert [line for line in text.split("\n") if not line.isprintable()] == []


def test_what_a_peer_is_called_is_one_line_of_the_log(capsys: pytest.CaptureFixture[str]) -> None:
    warn(f"robot ada{HOSTILE}: left")
    line = capsys.readouterr().err
    assert line.startswith(r"testudo: robot ada\u001b]0;x\u0007")
    assert line.endswith("\n")
    assert line[:-1].isprintable()


@given(st.lists(TEXTS), st.sampled_from(["utf-8", "ascii", "latin-1", "cp1252"]))
def test_lines_stay_lines_in_any_encoding(lines: list[str], encoding: str) -> None:
    raw = io.BytesIO()
    stream = io.TextIOWrapper(raw, encoding=encoding, newline="\n")
    write_lines(lines, stream)
    stream.flush()
    written = raw.getvalue().decode(encoding)
    assert written.count("\n") == len(lines)
    assert not re.search(r"[^\P{C}\n]".replace(r"\P{C}", r" -~\xa0-\U0010ffff"), written)


def test_what_a_file_could_hold_goes_into_a_pipe_as_it_is() -> None:
    pipe = io.StringIO()
    write_file_text(f"a\t{HOSTILE}\n", pipe)
    assert pipe.getvalue() == f"a\t{HOSTILE}\n"


def printing_calls(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and re.fullmatch(
            r"print|sys\.(stdout|stderr)\.write(lines)?|stream\.write", ast.unparse(node.func)
        ):
            yield ast.unparse(node.func)


def test_all_that_commands_write_leaves_by_one_module() -> None:
    folder = Path(smarttestudo.__file__).parent / "cli"
    found = {path.name: [*printing_calls(ast.parse(path.read_text()))] for path in folder.glob("*.py")}
    assert {name: calls for name, calls in found.items() if calls} == {"output.py": ["stream.write"]}

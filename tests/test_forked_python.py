# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Forked processes are like started ones, and use the ROS that the test's own process uses."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from forked_python import ForkedPython, inherited

LIBRARIES = {"LD_LIBRARY_PATH": "/opt/ros/humble/lib", "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1", "HOME": "/root"}


def test_the_libraries_of_a_setup_file_are_inherited_and_those_of_wheels_are_not() -> None:
    sourced = {"AMENT_PREFIX_PATH": "/opt/ros/humble", **LIBRARIES}
    assert inherited(LIBRARIES) == {"HOME": "/root"}
    assert inherited(sourced) == {
        "AMENT_PREFIX_PATH": "/opt/ros/humble",
        "LD_LIBRARY_PATH": "/opt/ros/humble/lib",
        "HOME": "/root",
    }


# Prints what a program can see of how it was started.
SEEN = """
import json, os, signal, sys, threading
names = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGCHLD", "SIGPIPE")
print(json.dumps({
    "argv": sys.argv, "path": sys.path[0], "folder": os.getcwd(), "variable": os.environ.get("SEEN"),
    "name": __name__, "threads": threading.active_count(), "files": os.listdir("/proc/self/fd"),
    "signals": [str(signal.getsignal(getattr(signal, name))) for name in names], "read": sys.stdin.read(),
}))
sys.exit(7)
"""


def forked(*arguments: str, said: str = "", **environment: str) -> tuple[int, str]:
    process = ForkedPython(arguments, {**inherited(os.environ), **environment})
    with process.stdin, process.stdout:
        process.stdin.write(said)
        process.stdin.close()
        return process.wait(), process.stdout.read()


def started(*arguments: str, said: str = "", **environment: str) -> tuple[int, str]:
    ran = subprocess.run(
        [sys.executable, *arguments],
        env={**inherited(os.environ), **environment},
        input=said,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        check=False,
    )
    return ran.returncode, ran.stdout


@pytest.mark.parametrize("kind", ["code", "script"])
def test_a_forked_program_sees_what_a_started_one_sees(kind: str, tmp_path: Path) -> None:
    script = tmp_path / "seen.py"
    script.write_text(SEEN)
    arguments = ["-c", SEEN, "a b", "ü"] if kind == "code" else [str(script), "a b", "ü"]
    results = [run(*arguments, said="ä\n", SEEN="yes") for run in (forked, started)]
    assert results[0] == results[1]
    assert json.loads(results[0][1])["variable"] == "yes"


@pytest.mark.parametrize("arguments", [["check", "missing.adirf"], ["--version"], ["top", "--rate"]])
def test_a_forked_command_says_and_returns_what_a_started_one_does(arguments: list[str]) -> None:
    assert forked("-m", "smarttestudo", *arguments) == started("-m", "smarttestudo", *arguments)


# What it does at its end, behind which a forked program leaves without freeing what was imported.
LATE = """
import atexit, threading
atexit.register(print, "at exit")
threading.Thread(target=lambda: (threading.main_thread().join(), print("thread"))).start()
"""


@pytest.mark.parametrize(
    "end", ["", "sys.exit()", "sys.exit(3)", "sys.exit(-1)", "sys.exit(True)", "sys.exit('words')", "1 / 0"]
)
def test_a_forked_program_ends_as_a_started_one_does(end: str) -> None:
    results = [run("-c", f"import sys{LATE}print('said', end=' ')\n{end}") for run in (forked, started)]
    codes, (forked_lines, started_lines) = zip(
        *((code, said.split("\n")) for code, said in results), strict=True
    )
    assert codes[0] == codes[1]
    # Between them stand the places of an error.
    assert (forked_lines[0], forked_lines[-3:]) == (started_lines[0], started_lines[-3:])
    assert "at exit" in started_lines


def test_a_forked_process_is_signalled_and_says_so() -> None:
    process = ForkedPython(["-c", "input()"], inherited(os.environ))
    with process.stdin, process.stdout:
        assert process.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.01)
        process.send_signal(signal.SIGTERM)
        assert process.wait() == process.poll() == -signal.SIGTERM
        process.kill()


class EndsWhenLookedAt(ForkedPython):
    """It goes on when it is looked at, and no longer a moment later."""

    def poll(self) -> int | None:
        code = super().poll()
        self.stdin.close()
        self.wait()
        return code


def test_a_process_that_ends_right_before_it_is_signalled_is_one_that_has_ended() -> None:
    process = EndsWhenLookedAt(["-c", "input()"], inherited(os.environ))
    with process.stdin, process.stdout:
        process.send_signal(signal.SIGINT)
        assert process.returncode == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP, signal.SIGQUIT])
def test_children_have_the_signals_of_a_terminal(number: signal.Signals) -> None:
    """Run under ``nohup`` or in a shell's background, this fails unless ``conftest.py`` sees to it."""
    code = f"import signal; print(signal.getsignal({int(number)}) is signal.SIG_IGN)"
    assert forked("-c", code) == started("-c", code) == (0, "False\n")

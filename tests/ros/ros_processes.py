# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Processes on a ROS domain of their own: a robot's sources, the runtime, an operator who records."""

from __future__ import annotations

import fcntl
import json
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from forked_python import ForkedPython, inherited

FOLDER = Path(__file__).parent
on_every_data_path = pytest.mark.parametrize("data_path", ["auto", "librcl", "rclpy"])
told_apart = pytest.mark.parametrize("data_path", ["auto"])
"""For tests of publishers of one topic, which rclpy does not tell apart."""
LINE_TIMEOUT_S = 120.0
TESTUDO = "import sys; from smarttestudo.cli.main import main; sys.exit(main())"


def threads_of(pid: int) -> set[str]:
    """The threads of a process."""
    return {task.name for task in Path(f"/proc/{pid}/task").iterdir()}


def shared_memory_of(pid: int) -> set[Path]:
    """The memory of Fast DDS that a process shares, its own and what it reads of others."""
    try:
        text = Path(f"/proc/{pid}/maps").read_text(encoding="utf-8")
    except (FileNotFoundError, ProcessLookupError):
        return set()
    return {Path(name) for name in re.findall(r"/dev/shm/fast(?:dds|rtps)_[0-9a-f]{16}", text)}


def remove_left(shared: set[Path]) -> None:
    """Remove the memory of processes that were killed, 16 MB of a run's: nobody has the lock beside it."""
    for path in shared:
        lock = path.with_name(f"{path.name}_el")
        try:
            with lock.open("rb") as opened:
                fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
                path.unlink()
                lock.unlink()
        except (BlockingIOError, FileNotFoundError):
            continue


class Process:
    """A process whose output, stderr included, is read line by line; it never outlives the block."""

    def __init__(self, command: list[str], environment: dict[str, str]) -> None:
        self.output: list[str] = []
        self._shared: set[Path] = set()
        self._process = started(command, environment)
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def line_with(self, text: str, *, within_s: float = LINE_TIMEOUT_S) -> str:
        """The next line that holds ``text``; each takes ``within_s`` at most."""
        while (line := self._next_line(within_s)) is not None:
            if text in line:
                return line
        raise AssertionError(f"ended without {text!r}:\n" + "".join(self.output))

    def say(self, line: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{line}\n")
        self._process.stdin.flush()

    def result(self, line: str = "stop") -> Any:
        """What an operator station received so far; another line than ``stop`` lets it go on."""
        self.say(line)
        received = json.loads(self.line_with("result ").removeprefix("result "))
        if line == "stop":
            # Killed while it closes, it can crash other processes of its domain (Fast DDS 3.2).
            self.exit_code()
        return received

    def topics(self) -> set[str]:
        """All topics that an operator station sees."""
        self.say("graph")
        return set(json.loads(self.line_with("graph ").removeprefix("graph ")))

    def ask(self, *request: Any) -> Any:
        """What ``remote_control.py`` answers."""
        self.say(json.dumps(request))
        return json.loads(self.line_with("reply ").removeprefix("reply "))

    def hears_more(self) -> None:
        """Wait until a recorder has heard all its topics for a second from now on."""
        self.say("more")
        self.line_with("more")

    @property
    def pid(self) -> int:
        return self._process.pid

    def signal(self, number: int) -> None:
        if number == signal.SIGKILL:
            self._shared = shared_memory_of(self.pid)
        self._process.send_signal(number)

    def exit_code(self, *, within_s: float = LINE_TIMEOUT_S) -> int:
        code = self._process.wait(within_s)
        self._reader.join()
        return code

    def end(self) -> None:
        self._shared |= shared_memory_of(self.pid)
        self._process.kill()
        self._process.wait()
        remove_left(self._shared)
        self._reader.join()
        for stream in (self._process.stdin, self._process.stdout):
            assert stream is not None
            try:
                stream.close()
            except BrokenPipeError:
                continue

    def _next_line(self, within_s: float) -> str | None:
        try:
            return self._lines.get(timeout=within_s)
        except queue.Empty:
            raise AssertionError(f"nothing in {within_s} s:\n" + "".join(self.output)) from None

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self.output.append(line)
            self._lines.put(line)
        self._lines.put(None)


def started(command: list[str], environment: dict[str, str]) -> ForkedPython | subprocess.Popen[str]:
    """A process whose output is one with its errors; what this Python would run has imported us already."""
    program, *arguments = command
    if program == sys.executable:
        return ForkedPython(arguments, environment)
    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        encoding="utf-8",
        env=environment,
    )


class SmallRobot:
    """Starts processes on one ROS domain and ends them; ``data_path`` is that of runtimes that name none.

    ``variables`` are those of all its processes.
    """

    def __init__(
        self,
        domain: int,
        folder: Path,
        *,
        data_path: str = "auto",
        variables: Mapping[str, str] | None = None,
    ) -> None:
        self.folder = folder
        self._data_path = data_path
        self._environment = {
            **inherited(os.environ),
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": str(folder / "log"),
            "PYTHONUNBUFFERED": "1",
            **(variables or {}),
        }
        self._processes: list[Process] = []

    def source(self, **topics: dict[str, Any]) -> Process:
        """A process that publishes; topics as ``source.py`` wants them, by name without the slash."""
        return self._start([str(FOLDER / "source.py"), json.dumps(topics)])

    def operator(
        self, *, span_s: float = 0.0, domain: int | None = None, **topics: dict[str, Any]
    ) -> Process:
        """A process that records what ``/testudo`` has of the topics; see ``operator_station.py``."""
        script = [str(FOLDER / "operator_station.py"), str(span_s), json.dumps(topics)]
        elsewhere = {} if domain is None else {"ROS_DOMAIN_ID": str(domain)}
        process = self._start(script, **elsewhere)
        process.line_with("ready")
        return process

    def watcher(self) -> Process:
        """A process that hears a source beside what is relayed of it; see ``picture_watcher.py``."""
        process = self._start([str(FOLDER / "picture_watcher.py")])
        process.line_with("ready")
        return process

    def counter(self, path: Path, texts: list[str], count: int) -> Process:
        """A process that counts through a runtime while its rules are reloaded; see ``echo_counter.py``."""
        return self._start([str(FOLDER / "echo_counter.py"), str(path), json.dumps(texts), str(count)])

    def remote(self) -> Process:
        """A process that sets parameters and calls services; see ``remote_control.py``."""
        return self._start([str(FOLDER / "remote_control.py")])

    def acted(self) -> Process:
        """A process with a node that rules act on; see ``acted_node.py``."""
        return self._start([str(FOLDER / "acted_node.py")])

    def node_of_modes(self, role: str, *names: str) -> Process:
        """A process of a robot with modes; see ``node_of_modes.py``."""
        return self._start([str(FOLDER / "node_of_modes.py"), role, *names])

    def testudo_run(self, *arguments: str) -> Process:
        """``testudo run``."""
        return self._start(["-c", TESTUDO, "run", *self._on_path(arguments)])

    def runtime(self, rules: str, *arguments: str) -> Process:
        """``testudo run`` by the rules given as text."""
        return self.testudo_run("--rules", self.rule_file(rules), *arguments)

    def runtime_lacking(self, lack: str, rules: str, *arguments: str) -> Process:
        """``testudo run`` on an rclpy that lacks something; see ``other_rclpy.py``."""
        path = self.rule_file(rules)
        return self._start([str(FOLDER / "other_rclpy.py"), lack, "run", "--rules", path, *arguments])

    def runtime_with_own_part(self, *arguments: str) -> Process:
        """``testudo run`` with a part of a test; see ``own_part.py``."""
        return self._start([str(FOLDER / "own_part.py"), *self._on_path(arguments)])

    def nodes_told(self, holds: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The statuses that ``top --once`` shows, by node, once this holds.

        Who comes late is told the last one of each node, which may be of before a change.
        """
        end_s = time.monotonic() + LINE_TIMEOUT_S
        while True:
            top = self.testudo("top", "--once", "--json", "--timeout", "60")
            assert top.exit_code() == 0
            nodes: dict[str, Any] = json.loads("".join(top.output))["nodes"]
            if holds(nodes):
                return nodes
            assert time.monotonic() < end_s, nodes

    def receiver(self, endpoint: str, *arguments: str) -> Process:
        """``testudo receive`` that listens at ``endpoint``."""
        process = self.testudo("receive", "--listen", endpoint, *arguments)
        process.line_with("Receiving")
        return process

    def recorder(self, folder: Path, **topics: dict[str, Any]) -> Process:
        """A process that records the topics into ``folder``; see ``recorder.py``."""
        process = self._start([str(FOLDER / "recorder.py"), str(folder), json.dumps(topics)])
        process.line_with("ready")
        return process

    def player(self, bag: Path) -> Process:
        """A process that plays a recording; see ``player.py``."""
        process = self._start([str(FOLDER / "player.py"), str(bag)])
        process.line_with("ready")
        return process

    def testudo(self, *arguments: str) -> Process:
        """``testudo`` with ``arguments``."""
        return self._start(["-c", TESTUDO, *arguments])

    def command(self, *words: str, **environment: str) -> Process:
        """Any command, with variables of its own."""
        process = Process(list(words), {**self._environment, **environment})
        self._processes.append(process)
        return process

    def diagnostics(self) -> Process:
        """A process that prints each message on /diagnostics; see ``diagnostics_listener.py``."""
        return self._start([str(FOLDER / "diagnostics_listener.py")])

    def end(self) -> None:
        for process in self._processes:
            process.end()

    def rule_file(self, rules: str) -> str:
        path = self.folder / f"rules{len(self._processes)}.adirf"
        path.write_text(rules, encoding="utf-8")
        return str(path)

    def _on_path(self, arguments: Sequence[str]) -> Sequence[str]:
        # Where nothing is asked for, the default is what a user gets.
        if self._data_path == "auto" or "--data-path" in arguments:
            return arguments
        return ["--data-path", self._data_path, *arguments]

    def _start(self, arguments: list[str], **environment: str) -> Process:
        return self.command(sys.executable, *arguments, **environment)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Processes that answer questions and can be measured from outside."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

# A parent of another environment leaves these, and then the ROS of this one does not load.
NOT_INHERITED = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH")


LARGE_MESSAGES = (
    Path(__file__).parents[2] / "src" / "smarttestudo" / "robot" / "ros" / "fastdds_large_messages.xml"
)


def environment(domain: int, *, large_messages: bool) -> dict[str, str]:
    """The environment of a process on that ROS domain, of this machine only."""
    settings = {name: value for name, value in os.environ.items() if name not in NOT_INHERITED}
    # A setup file that was sourced means its LD_LIBRARY_PATH; ROS 2 from PyPI is none that could be.
    if "AMENT_PREFIX_PATH" in os.environ and "LD_LIBRARY_PATH" in os.environ:
        settings["LD_LIBRARY_PATH"] = os.environ["LD_LIBRARY_PATH"]
    settings |= {"ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    if large_messages:
        # The second is the name before Kilted.
        for name in ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE"):
            settings[name] = str(LARGE_MESSAGES)
    return settings


class Process:
    """A process of one role, which answers questions."""

    def __init__(
        self, arguments: Sequence[str], environment: dict[str, str], pass_fds: Sequence[int] = ()
    ) -> None:
        self._process = subprocess.Popen(
            arguments,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env=environment,
            pass_fds=pass_fds,
        )

    def ask(self, question: str) -> Any:
        """The answer to a line."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{question}\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def line(self) -> str:
        """The next line that it says."""
        assert self._process.stdout is not None
        return self._process.stdout.readline()

    @property
    def cpu_s(self) -> float:
        """CPU time so far, ended threads included: the clock that clock_getcpuclockid(3) names."""
        return time.clock_gettime((~self._process.pid << 3) | 2)

    @property
    def main_thread_cpu_s(self) -> float:
        """CPU time of its first thread so far, which is Python's."""
        pid = self._process.pid
        return int(Path(f"/proc/{pid}/task/{pid}/schedstat").read_text().split()[0]) / 1e9

    @property
    def resident_mb(self) -> float:
        """Resident memory."""
        status = Path(f"/proc/{self._process.pid}/status").read_text()
        line = next(line for line in status.splitlines() if line.startswith("VmRSS"))
        return int(line.split()[1]) * 1024 / 1e6

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def end(self) -> str:
        """End it; what it said at last."""
        self._process.terminate()
        return str(self._process.communicate()[0])


@contextmanager
def processes(commands: Sequence[Sequence[str]], environment: dict[str, str]) -> Iterator[list[Process]]:
    """The processes of some commands, ended at the end."""
    started = [Process(command, environment) for command in commands]
    try:
        yield started
    finally:
        for process in started:
            process.end()


def cpu_us_a_message(source: Process, relays: Sequence[Process], seconds: float) -> list[float]:
    """The CPU of each relay for a message of the source in a window, in µs."""
    sent, before_s = source.ask("sent"), [relay.cpu_s for relay in relays]
    time.sleep(seconds)
    used_s = [relay.cpu_s - since_s for relay, since_s in zip(relays, before_s, strict=True)]
    messages = max(source.ask("sent") - sent, 1)
    return [used * 1e6 / messages for used in used_s]


def p99(ages: Sequence[float]) -> float:
    """The 99th percentile; 0 of none."""
    return sorted(ages)[len(ages) * 99 // 100] if ages else 0.0


def growth_mb_an_hour(readings: Sequence[tuple[float, float]]) -> float:
    """The slope of a straight line through readings of memory: seconds, MB."""
    slope, _ = statistics.linear_regression(*zip(*readings, strict=True))
    return slope * 3600

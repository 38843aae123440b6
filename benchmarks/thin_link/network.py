# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A thin link between two network namespaces of this machine, which can change its rate and fail."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

ROBOT_ADDRESS, OPERATOR_ADDRESS = "10.99.0.1", "10.99.0.2"
_DEVICE = "link0"
_QUEUE = ("burst", "16kb", "latency", "400ms")


class NetworkError(Exception):
    """The network for the measurement cannot be made, or is not used; says in one line why."""


class ThinLink:
    """A veth pair between the namespaces of robot and operator, with a token bucket at both ends."""

    def __init__(self, robot: str, operator: str) -> None:
        self.robot = robot
        self.operator = operator

    def set_rate(self, mbit_per_s: float) -> None:
        """Let both directions carry so much from now on."""
        for namespace in (self.robot, self.operator):
            rate = f"{mbit_per_s * 1000:.0f}kbit"
            _run(
                "tc",
                "-n",
                namespace,
                "qdisc",
                "replace",
                "dev",
                _DEVICE,
                "root",
                "tbf",
                "rate",
                rate,
                *_QUEUE,
            )

    def cut(self) -> None:
        """Carry nothing."""
        _run("ip", "-n", self.robot, "link", "set", _DEVICE, "down")

    def mend(self) -> None:
        """Carry again."""
        _run("ip", "-n", self.robot, "link", "set", _DEVICE, "up")

    def carried_bytes(self) -> int:
        """What has arrived at the operator's end so far, headers included."""
        counter = f"/sys/class/net/{_DEVICE}/statistics/rx_bytes"
        return int(_run("ip", "netns", "exec", self.operator, "cat", counter))


def can_make_links() -> bool:
    """Whether this user may make network namespaces, and has what it takes."""
    return os.geteuid() == 0 and all(shutil.which(tool) for tool in ("ip", "tc"))


@contextmanager
def thin_link() -> Iterator[ThinLink]:
    """A link of its own, removed at the end. Raises ``NetworkError``."""
    if os.geteuid() != 0 or not (shutil.which("ip") and shutil.which("tc")):
        raise NetworkError(
            "this benchmark makes network namespaces: run it as root, with iproute2 (ip and tc)"
        )
    names = [f"testudo-{side}-{os.getpid()}" for side in ("robot", "operator")]
    try:
        for name in names:
            _run("ip", "netns", "add", name)
        _run(
            "ip",
            "-n",
            names[0],
            "link",
            "add",
            _DEVICE,
            "type",
            "veth",
            "peer",
            "name",
            _DEVICE,
            "netns",
            names[1],
        )
        for name, address in zip(names, (ROBOT_ADDRESS, OPERATOR_ADDRESS), strict=True):
            _run("ip", "-n", name, "address", "add", f"{address}/24", "dev", _DEVICE)
            for device in ("lo", _DEVICE):
                _run("ip", "-n", name, "link", "set", device, "up")
        yield ThinLink(*names)
    finally:
        for name in names:
            subprocess.run(["ip", "netns", "del", name], capture_output=True, check=False)


def _run(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise NetworkError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout

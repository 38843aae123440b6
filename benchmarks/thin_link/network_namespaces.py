# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A thin link between two network namespaces of this machine, which can change its rate and fail."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.units import grouped

ROBOT_ADDRESS, OPERATOR_ADDRESS = "10.99.0.1", "10.99.0.2"
_DEVICE = "link0"
_QUEUE = ("burst", "16kb", "latency", "400ms")
_TOOLS = ("ip", "tc")
_UP_TIMEOUT_S = 10.0
_POLL_S = 0.02


class NetworkError(TestudoError):
    """A network of this machine that cannot be made, or that did not carry what it should."""


class ThinLink:
    """A veth pair between the namespaces of robot and operator, with a token bucket at both ends.

    The buckets have a queue of 400 ms. All methods raise ``NetworkError``.
    """

    def __init__(self, robot: str, operator: str) -> None:
        self.robot = robot
        self.operator = operator

    def set_rate(self, bits_per_s: float) -> None:
        """Let both directions carry so much from now on, headers included."""
        rate = ("rate", f"{bits_per_s:.0f}bit")
        for namespace in (self.robot, self.operator):
            _run("tc", "-n", namespace, "qdisc", "replace", "dev", _DEVICE, "root", "tbf", *rate, *_QUEUE)

    def cut(self) -> None:
        """Carry nothing."""
        _run("ip", "-n", self.robot, "link", "set", _DEVICE, "down")

    def mend(self) -> None:
        """Carry again."""
        _run("ip", "-n", self.robot, "link", "set", _DEVICE, "up")

    def carried_bytes(self) -> int:
        """The bytes that arrived at the operator's end so far, headers included."""
        counter = f"/sys/class/net/{_DEVICE}/statistics/rx_bytes"
        return int(_run("ip", "netns", "exec", self.operator, "cat", counter))

    def require_carried(self, least_bytes: float, since_bytes: int) -> None:
        """Raise ``NetworkError`` if it has carried less than that since it had carried ``since_bytes``.

        Processes of one machine also meet in its memory; then the link showed nothing.
        """
        carried_bytes = self.carried_bytes() - since_bytes
        if carried_bytes < least_bytes:
            raise NetworkError(
                f"{grouped(least_bytes)} bytes arrived, but the link carried only {grouped(carried_bytes)}",
                remedy="nothing was measured; try again where no other ROS graph runs",
            )


def in_namespace(namespace: str, command: Sequence[str]) -> list[str]:
    """The command that runs ``command`` in a namespace, as the same process."""
    return ["ip", "netns", "exec", namespace, *command]


def require_links() -> None:
    """Raise ``NetworkError`` where this user cannot make network namespaces."""
    if os.name != "posix" or os.geteuid() != 0:
        raise NetworkError("making a link needs root on Linux", remedy="run it with sudo")
    missing = [tool for tool in _TOOLS if shutil.which(tool) is None]
    if missing:
        raise NetworkError(
            f"making a link needs {' and '.join(missing)}", remedy="install them: apt install iproute2"
        )


@contextmanager
def thin_link() -> Iterator[ThinLink]:
    """A link, one at a time in a process, removed at the end with its namespaces. Raises ``NetworkError``."""
    require_links()
    names = [f"testudo-{side}-{os.getpid()}" for side in ("robot", "operator")]
    try:
        for name in names:
            _run("ip", "netns", "add", name)
        pair = ("type", "veth", "peer", "name", _DEVICE, "netns", names[1])
        _run("ip", "-n", names[0], "link", "add", _DEVICE, *pair)
        for name, address in zip(names, (ROBOT_ADDRESS, OPERATOR_ADDRESS), strict=True):
            _run("ip", "-n", name, "address", "add", f"{address}/24", "dev", _DEVICE)
            for device in ("lo", _DEVICE):
                _run("ip", "-n", name, "link", "set", device, "up")
        _await_up(names)
        yield ThinLink(*names)
    finally:
        for name in names:
            subprocess.run(["ip", "netns", "del", name], capture_output=True, check=False)


def _await_up(namespaces: Sequence[str]) -> None:
    """Return once both ends say that they are up: Fast DDS never takes an interface that did not."""
    end_s = time.monotonic() + _UP_TIMEOUT_S
    while not all("state UP" in _run("ip", "-n", name, "link", "show", _DEVICE) for name in namespaces):
        if time.monotonic() > end_s:
            raise NetworkError(f"the link did not come up in {_UP_TIMEOUT_S:g} s")
        time.sleep(_POLL_S)


def _run(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = " ".join(done.stderr.split()) or f"exit code {done.returncode}"
        raise NetworkError(
            f"{' '.join(command)}: {said}",
            remedy="a container may not make network namespaces unless it is privileged",
        )
    return done.stdout

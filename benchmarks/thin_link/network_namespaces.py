# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Links between network namespaces of this machine, whose packets a process carries as a radio would."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import struct
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from live.processes import Process
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.units import grouped
from thin_link.emulated_path import PathConditions, PathCounts

ROBOT_ADDRESS, OPERATOR_ADDRESS = "10.99.0.1", "10.99.0.2"
INSIDE_ADDRESS = "192.168.99.1"
"""The robot's own, where a router is before it; others see the one above."""
ROBOT_ADDRESS_V6, OPERATOR_ADDRESS_V6 = "fd99::1", "fd99::2"
_DEVICE = "link0"
_TUN = Path("/dev/net/tun")
_TUNSETIFF, _IFF_TUN, _IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
_UP_TIMEOUT_S = 10.0
_POLL_S = 0.02


class NetworkError(TestudoError):
    """A network of this machine that cannot be made, or that did not carry what it should."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Interface:
    """The end of a link: a device in a namespace, and its addresses with the lengths of their prefixes."""

    namespace: str
    device: str
    addresses: Sequence[str]

    def ip(self, *arguments: str) -> str:
        """The output of ``ip`` in its namespace. Raises ``NetworkError``."""
        return _run("ip", "-n", self.namespace, *arguments)


class ThinLink:
    """A link between the namespaces of robot and operator, alike both ways.

    All methods raise ``NetworkError``.
    """

    def __init__(
        self, first: Interface, second: Interface, emulator: Process, conditions: PathConditions
    ) -> None:
        self.first = first
        self.second = second
        self.conditions = conditions
        self._emulator = emulator

    @property
    def robot(self) -> str:
        """The namespace of the robot."""
        return self.first.namespace

    @property
    def operator(self) -> str:
        """The namespace of the operator."""
        return self.second.namespace

    def change(self, conditions: PathConditions) -> None:
        """Let other conditions hold from now on, also for packets that wait."""
        if conditions.mtu_bytes != self.conditions.mtu_bytes:
            for end in (self.first, self.second):
                end.ip("link", "set", end.device, "mtu", str(conditions.mtu_bytes))
        self.conditions = conditions
        self._ask(json.dumps(asdict(conditions)))

    def counts(self) -> tuple[PathCounts, PathCounts]:
        """The packets so far from the first end to the second, and back."""
        there, back = self._ask("")
        return PathCounts(**there), PathCounts(**back)

    def cut(self) -> None:
        """Have the robot's device go down."""
        self.first.ip("link", "set", self.first.device, "down")

    def mend(self) -> None:
        """Have it come up again."""
        self.first.ip("link", "set", self.first.device, "up")

    def move_robot(self, address: str) -> None:
        """Give the robot another address, with the length of its prefix, in place of its first one."""
        # One of the same network would go with the first.
        self.first.ip("address", "delete", self.first.addresses[0], "dev", self.first.device)
        self.first.ip("address", "add", address, "dev", self.first.device)
        self.first = replace(self.first, addresses=(address, *self.first.addresses[1:]))

    def rebind(self) -> None:
        """Have the router before the robot forget its flows, which get other ports then."""
        self._ask("rebind")

    def carried_bytes(self) -> int:
        """The bytes that arrived at the operator's end so far, headers included."""
        return self.counts()[0].arrived_bytes

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

    def _ask(self, line: str) -> Any:
        try:
            return self._emulator.ask(line)
        except (OSError, ValueError) as error:
            raise NetworkError("the emulator of the link has ended", remedy="try again") from error


def in_namespace(namespace: str, command: Sequence[str]) -> list[str]:
    """The command that runs ``command`` in a namespace, as the same process."""
    return ["ip", "netns", "exec", namespace, *command]


def require_links() -> None:
    """Raise ``NetworkError`` where this user cannot make links between network namespaces."""
    if os.name != "posix" or os.geteuid() != 0:
        raise NetworkError("making a link needs root on Linux", remedy="run it with sudo")
    if shutil.which("ip") is None:
        raise NetworkError("making a link needs ip", remedy="install it: apt install iproute2")
    try:
        os.close(os.open(_TUN, os.O_RDWR))
    except OSError as error:
        raise NetworkError(
            f"making a link needs {_TUN}: {error.strerror}",
            remedy="a container must be privileged",
        ) from error


@contextmanager
def thin_link(
    conditions: PathConditions, seed: int = 1, *, is_behind_nat: bool = False
) -> Iterator[ThinLink]:
    """A link with namespaces of its own, which go with it. Raises ``NetworkError``.

    The robot may be behind a router that translates its address.
    """
    require_links()
    own_address = INSIDE_ADDRESS if is_behind_nat else ROBOT_ADDRESS
    with namespaces("robot", "operator") as (robot, operator):
        first = Interface(
            namespace=robot, device=_DEVICE, addresses=(f"{own_address}/24", f"{ROBOT_ADDRESS_V6}/64")
        )
        second = Interface(
            namespace=operator,
            device=_DEVICE,
            addresses=(f"{OPERATOR_ADDRESS}/24", f"{OPERATOR_ADDRESS_V6}/64"),
        )
        translated = (INSIDE_ADDRESS, ROBOT_ADDRESS) if is_behind_nat else ()
        with emulator(first, second, conditions, seed, translated) as process:
            if is_behind_nat:
                first.ip("route", "add", "default", "dev", _DEVICE)
            yield ThinLink(first, second, process, conditions)


@contextmanager
def namespaces(*names: str) -> Iterator[list[str]]:
    """Network namespaces with a loopback each, by names of this process. Raises ``NetworkError``."""
    made = [f"testudo-{name}-{os.getpid()}" for name in names]
    try:
        for namespace in made:
            _run("ip", "netns", "add", namespace)
            _run("ip", "-n", namespace, "link", "set", "lo", "up")
        yield made
    finally:
        for namespace in made:
            subprocess.run(["ip", "netns", "del", namespace], capture_output=True, check=False)


@contextmanager
def emulator(
    first: Interface,
    second: Interface,
    conditions: PathConditions,
    seed: int = 1,
    translated: Sequence[str] = (),
) -> Iterator[Process]:
    """The process of a link between two interfaces, which it makes. Raises ``NetworkError``.

    A router may translate the address of the first one: the one inside and the one outside.
    """
    with ExitStack() as opened:
        devices = [opened.enter_context(_device(end, conditions.mtu_bytes)) for end in (first, second)]
        command = [sys.executable, "-m", "thin_link.emulator", *map(str, devices)]
        process = Process(
            [*command, json.dumps(asdict(conditions)), str(seed), *translated],
            {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
            pass_fds=devices,
        )
        opened.callback(process.end)
        _await_up((first, second))
        # It answers once it carries packets.
        process.ask("")
        yield process


@contextmanager
def _device(end: Interface, mtu_bytes: int) -> Iterator[int]:
    """The file of a new TUN device, which is in the namespace with its addresses."""
    file = os.open(_TUN, os.O_RDWR | os.O_NONBLOCK)
    try:
        asked = struct.pack("16sH22x", b"testudo%d", _IFF_TUN | _IFF_NO_PI)
        given = fcntl.ioctl(file, _TUNSETIFF, asked)[:16].rstrip(b"\0").decode()
        _run("ip", "link", "set", given, "netns", end.namespace, "name", end.device)
        # Without an address of its own it asks for no router: nothing is carried but what the ends send.
        end.ip("link", "set", end.device, "addrgenmode", "none")
        for address in end.addresses:
            is_v6 = ":" in address
            end.ip("address", "add", address, "dev", end.device, *(("nodad",) if is_v6 else ()))
        end.ip("link", "set", end.device, "mtu", str(mtu_bytes), "up")
        yield file
    finally:
        os.close(file)


def _await_up(ends: Sequence[Interface]) -> None:
    """Return once both ends say that they are up: Fast DDS never takes an interface that did not."""
    end_s = time.monotonic() + _UP_TIMEOUT_S
    while not all("LOWER_UP" in end.ip("link", "show", end.device) for end in ends):
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

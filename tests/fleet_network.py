# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Machines behind mobile networks, and a server that all of them reach: a network namespace each."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from thin_link.network_namespaces import in_namespace

SERVER = "server"
SERVER_ADDRESS = "10.98.0.1"
_DEVICE = "link0"
_RADIO = ("tbf", "rate", "2mbit", "burst", "16kb", "latency", "400ms")


@dataclass(frozen=True, slots=True, kw_only=True)
class Fleet:
    """The namespaces, by the machines' names."""

    namespaces: dict[str, str]

    def on(self, machine: str, command: Sequence[str]) -> list[str]:
        """The command that runs ``command`` on ``machine``."""
        return in_namespace(self.namespaces[machine], command)

    def cut(self, machine: str) -> None:
        """Let a machine leave the coverage of its network."""
        self.run("link", "set", _DEVICE, "down", on=machine)

    def mend(self, machine: str) -> None:
        """Let it come back."""
        self.run("link", "set", _DEVICE, "up", on=machine)
        self.run("route", "replace", SERVER_ADDRESS, "dev", _DEVICE, on=machine)

    def run(self, *arguments: str, on: str) -> None:
        """``ip`` on a machine."""
        subprocess.run(["ip", "-n", self.namespaces[on], *arguments], check=True, capture_output=True)


@contextmanager
def fleet_network(machines: Sequence[str]) -> Iterator[Fleet]:
    """A server and ``machines``, each with 2 Mbit/s to it and no way to one another, gone at the end."""
    fleet = Fleet(namespaces={name: f"fleet-{name}-{os.getpid()}" for name in (SERVER, *machines)})
    try:
        for namespace in fleet.namespaces.values():
            subprocess.run(["ip", "netns", "add", namespace], check=True, capture_output=True)
        fleet.run("link", "set", "lo", "up", on=SERVER)
        fleet.run("address", "add", f"{SERVER_ADDRESS}/32", "dev", "lo", on=SERVER)
        for number, machine in enumerate(machines, start=1):
            _join(fleet, machine, number)
        yield fleet
    finally:
        for namespace in fleet.namespaces.values():
            subprocess.run(["ip", "netns", "del", namespace], check=False, capture_output=True)


def _join(fleet: Fleet, machine: str, number: int) -> None:
    port = f"port{number}"
    peer = ("type", "veth", "peer", "name", port, "netns", fleet.namespaces[SERVER])
    fleet.run("link", "add", _DEVICE, *peer, on=machine)
    fleet.run("address", "add", f"10.98.{number}.2/24", "dev", _DEVICE, on=machine)
    fleet.run("address", "add", f"10.98.{number}.1/24", "dev", port, on=SERVER)
    fleet.run("link", "set", "lo", "up", on=machine)
    fleet.run("link", "set", port, "up", on=SERVER)
    fleet.mend(machine)
    for name, device in ((machine, _DEVICE), (SERVER, port)):
        queue = ["tc", "-n", fleet.namespaces[name], "qdisc", "add", "dev", device, "root", *_RADIO]
        subprocess.run(queue, check=True, capture_output=True)

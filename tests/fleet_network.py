# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Machines behind mobile networks, and a server that all of them reach: a network namespace each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

from thin_link.emulated_path import PathConditions
from thin_link.network_namespaces import Interface, emulator, in_namespace, namespaces

SERVER = "server"
SERVER_ADDRESS = "10.98.0.1"
_RADIO = PathConditions(rate_bits_per_s=2e6, queue_bytes=100_000)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fleet:
    """The namespace of the server, and each machine's device by its name."""

    server: str
    machines: Mapping[str, Interface]

    def on(self, machine: str, command: Sequence[str]) -> list[str]:
        """The command that runs ``command`` on ``machine``."""
        namespace = self.server if machine == SERVER else self.machines[machine].namespace
        return in_namespace(namespace, command)

    def cut(self, machine: str) -> None:
        """Let a machine leave the coverage of its network."""
        end = self.machines[machine]
        end.ip("link", "set", end.device, "down")

    def mend(self, machine: str) -> None:
        """Let it come back."""
        end = self.machines[machine]
        end.ip("link", "set", end.device, "up")
        end.ip("route", "replace", SERVER_ADDRESS, "dev", end.device)


@contextmanager
def fleet_network(machines: Sequence[str]) -> Iterator[Fleet]:
    """A server and ``machines``, each with 2 Mbit/s to it and no way to one another, gone at the end."""
    with ExitStack() as opened:
        server, *others = opened.enter_context(namespaces(SERVER, *machines))
        ends = dict[str, Interface]()
        for number, (name, namespace) in enumerate(zip(machines, others, strict=True), start=1):
            ends[name] = Interface(namespace=namespace, device="link0", addresses=(f"10.98.{number}.2/24",))
            port = Interface(namespace=server, device=f"port{number}", addresses=(f"10.98.{number}.1/24",))
            opened.enter_context(emulator(ends[name], port, _RADIO, seed=number))
        port.ip("address", "add", f"{SERVER_ADDRESS}/32", "dev", "lo")
        fleet = Fleet(server=server, machines=ends)
        for name in machines:
            fleet.mend(name)
        yield fleet

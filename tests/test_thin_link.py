# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link between two network namespaces of this machine."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from thin_link.emulated_path import wire
from thin_link.network_namespaces import (
    OPERATOR_ADDRESS,
    NetworkError,
    ThinLink,
    in_namespace,
    require_links,
    thin_link,
)

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
BITS_PER_S = 4e6
FLOW_BYTES = 400_000
RECEIVE = f"""
import socket
listener = socket.create_server(("{OPERATOR_ADDRESS}", 5000))
print("listening", flush=True)
flow, _ = listener.accept()
total = 0
while data := flow.recv(65536):
    total += len(data)
print(total, flush=True)
"""
SEND = f"""
import socket
with socket.create_connection(("{OPERATOR_ADDRESS}", 5000)) as flow:
    flow.sendall(bytes({FLOW_BYTES}))
"""
# As nobody, after all is imported, because such a user may not read this folder.
AS_NOBODY = """
import os
from thin_link.network_namespaces import NetworkError, require_links
os.seteuid(65534)
try:
    require_links()
except NetworkError as error:
    print(error)
"""


@pytest.fixture
def link(network_namespaces: None) -> Iterator[ThinLink]:
    """One of this process, gone at the end."""
    with thin_link(wire(BITS_PER_S)) as made:
        yield made


def namespaces() -> set[str]:
    """The names of all network namespaces of this machine."""
    listed = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True)
    return {line.split()[0] for line in listed.stdout.splitlines()}


def python(namespace: str, code: str) -> subprocess.Popen[str]:
    command = in_namespace(namespace, [sys.executable, "-c", code])
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


@pytest.mark.contract
def test_a_flow_takes_the_link_s_time_and_shows_on_its_counter(link: ThinLink) -> None:
    before_bytes = link.carried_bytes()
    with python(link.operator, RECEIVE) as receiver:
        assert receiver.stdout is not None
        receiver.stdout.readline()
        start_s = time.monotonic()
        with python(link.robot, SEND):
            assert receiver.stdout.readline() == f"{FLOW_BYTES}\n"
        took_s = time.monotonic() - start_s
    assert took_s > 8 * FLOW_BYTES / BITS_PER_S
    link.require_carried(FLOW_BYTES, before_bytes)


def test_what_did_not_cross_the_link_is_an_error(link: ThinLink) -> None:
    with pytest.raises(NetworkError, match=r"1 000 000 bytes arrived, but the link carried only"):
        link.require_carried(1_000_000, link.carried_bytes())


@pytest.mark.contract
def test_its_namespaces_go_with_it_also_after_an_error(link: ThinLink) -> None:
    assert namespaces() >= {link.robot, link.operator}
    for namespace in (link.robot, link.operator):
        subprocess.run(["ip", "netns", "del", namespace], check=True)
    made: list[str] = []
    with pytest.raises(KeyboardInterrupt), thin_link(wire(BITS_PER_S)) as another:  # noqa: PT012  what is left is the claim
        made += [another.robot, another.operator]
        assert namespaces() >= set(made)
        raise KeyboardInterrupt
    assert not namespaces() & set(made)


def test_without_the_tools_it_says_which_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    if os.geteuid() != 0:
        pytest.skip("only root is told of tools")
    monkeypatch.setenv("PATH", "")
    with pytest.raises(NetworkError, match="needs ip; install it: apt install iproute2"):
        require_links()


def test_whoever_is_not_root_is_told_so() -> None:
    said = subprocess.run(
        [sys.executable, "-c", AS_NOBODY],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(BENCHMARKS)},
    )
    assert said.stdout == "error: making a link needs root on Linux; run it with sudo\n"

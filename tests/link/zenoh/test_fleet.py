# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two robots and an operator that meet at a Zenoh router, with the keys and users of docker/make_fleet.sh."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest
import zenoh

from bags.bag_reading import read_bag
from fleet_network import SERVER, SERVER_ADDRESS, fleet_network
from link.zenoh.ends import free_endpoint, until
from ros.ros_processes import Process

pytestmark = pytest.mark.full
ROOT = Path(__file__).parents[3]
ROBOTS = ("ada", "bob")
ENDPOINT = f"tls/{SERVER_ADDRESS}:7447"
ANSWER_WITHIN_S = 5.0


def make_fleet(folder: Path, address: str) -> None:
    script = str(ROOT / "docker" / "make_fleet.sh")
    subprocess.run(["sh", script, str(folder), address, *ROBOTS], check=True, capture_output=True)


@pytest.fixture
def processes() -> Iterator[ExitStack]:
    """Ends what was started in it, the last first."""
    with ExitStack() as started:
        yield started


@pytest.mark.usefixtures("network_namespaces")
@pytest.mark.contract
def test_two_robots_and_an_operator_meet_at_a_router_over_radios_that_fail(
    tmp_path: Path, processes: ExitStack
) -> None:
    keys = tmp_path / "fleet"
    make_fleet(keys, SERVER_ADDRESS)
    fleet = processes.enter_context(fleet_network([*ROBOTS, "operator"]))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}

    def start(machine: str, member: str, *arguments: str) -> Process:
        # The files of a member name each other by their place in its folder.
        python = ["env", "-C", str(keys / member), *fleet.on(machine, [sys.executable, "-m", *arguments])]
        process = Process(python, environment)
        processes.callback(process.end)
        return process

    end = "link.zenoh.fleet_process"
    start(SERVER, "router", end, "router", "zenoh.json5").line_with("routing")
    link = ("--connect", ENDPOINT, "--zenoh-config", "zenoh.json5")
    drive = tmp_path / "drive"
    receive = ("smarttestudo", "receive", "--no-ros", "--record", str(drive), *link)
    operator = start("operator", "operator", *receive)
    for name in ROBOTS:
        start(name, name, end, "robot", "zenoh.json5", name, ENDPOINT)
    # With the password of ada.
    start("ada", "ada", end, "robot", "zenoh.json5", "bob", ENDPOINT)

    def said(text: str, times: int = 1) -> bool:
        return "".join(operator.output).count(text) >= times

    until(lambda: all(said(f"{name}: sends /odom") for name in ROBOTS))
    fleet.cut("ada")
    until(partial(said, "ada: not connected any more"))
    fleet.mend("ada")
    until(partial(said, "ada: connected", 2))
    operator.signal(signal.SIGINT)
    assert operator.exit_code() == 0
    assert not said("bob: not connected any more")
    assert not said("2 robots are called bob")
    for name in ROBOTS:
        messages = [message.payload for message in read_bag(drive / name).messages]
        assert messages
        assert {payload.split()[0] for payload in messages} == {name.encode()}


def test_a_robot_has_the_keys_of_its_name_alone_and_a_viewer_changes_nothing(
    tmp_path: Path, processes: ExitStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    keys, endpoint = tmp_path / "fleet", free_endpoint("tls")
    make_fleet(keys, "127.0.0.1")

    def opened(member: str) -> zenoh.Session:
        monkeypatch.chdir(keys / member)
        config = zenoh.Config.from_file("zenoh.json5")
        side = "listen" if member == "router" else "connect"
        config.insert_json5(f"{side}/endpoints", json.dumps([endpoint]))
        config.insert_json5("scouting/multicast/enabled", "false")
        if member != "router":
            config.insert_json5("mode", '"client"')
        session: zenoh.Session = zenoh.open(config)
        processes.enter_context(session)
        return session

    opened("router")
    ada, bob, operator, viewer = map(opened, ("ada", "bob", "operator", "viewer"))
    heard, seen = list[bytes](), list[bytes]()
    subscribers = (
        operator.declare_subscriber("testudo/**", lambda one: heard.append(one.payload.to_bytes())),
        viewer.declare_subscriber("testudo/*/*/data", lambda one: seen.append(one.payload.to_bytes())),
    )
    queryables = [
        ada.declare_queryable(f"testudo/ada/1/{kind}", lambda query: query.reply(query.key_expr, b"done"))
        for kind in ("get", "set")
    ]

    def publish() -> None:
        bob.put("testudo/ada/1/data", b"stolen")
        ada.put("testudo/elsewhere", b"stolen")
        viewer.put("testudo/ada/1/data", b"stolen")
        ada.put("testudo/ada/1/data", b"mine")

    until(lambda: len(heard) > 3, publish)
    until(lambda: b"mine" in seen, publish)
    assert set(heard) == {b"mine"}

    def answers(session: zenoh.Session, kind: str) -> int:
        return sum(
            reply.ok is not None for reply in session.get(f"testudo/ada/1/{kind}", timeout=ANSWER_WITHIN_S)
        )

    until(lambda: answers(operator, "set") == 1)
    assert answers(viewer, "get") == 1
    assert answers(viewer, "set") == 0
    assert answers(bob, "get") == 0
    for subscriber in subscribers:
        subscriber.undeclare()
    for queryable in queryables:
        queryable.undeclare()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["new", "203.0.113.7"], "it needs a folder, the router's address and the robots' names"),
        (["new", "203.0.113.7", "operator"], "operator cannot be a robot's name here"),
        (["new", "203.0.113.7", "a/b"], "a/b: use letters, digits, _ and -"),
        (["new", "tls/203.0.113.7", "ada"], "tls/203.0.113.7 is no address"),
        ([".", "203.0.113.7", "ada"], ". is there already; name a new folder"),
    ],
)
def test_a_fleet_that_cannot_be_made_is_refused_in_one_line(
    tmp_path: Path, arguments: list[str], said: str
) -> None:
    command = ["sh", str(ROOT / "docker" / "make_fleet.sh"), *arguments]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    (line,) = done.stderr.splitlines()
    assert (done.returncode, said in line) == (2, True)
    assert list(tmp_path.iterdir()) == []


def test_keys_and_passwords_in_a_checkout_are_not_committed_and_come_into_no_image(tmp_path: Path) -> None:
    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    make_fleet(tmp_path / "fleet", "203.0.113.7")
    status = ["git", "-C", str(tmp_path), "status", "--porcelain", "--untracked-files=all"]
    assert subprocess.run(status, check=True, capture_output=True, text=True).stdout == ""
    made = [path for path in (tmp_path / "fleet").rglob("*.*") if path.name != ".gitignore"]
    kept_out = (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines()
    assert len(made) > 10
    assert [p for p in made if not {f"**/*{p.suffix}", f"**/{p.name}"} & set(kept_out)] == []

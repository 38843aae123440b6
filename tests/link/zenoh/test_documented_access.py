# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who may do what with the certificates that docs/how-to/secure-link.md makes, and by access control."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

import pytest
import zenoh

from docs.code_blocks import blocks_of, shell_blocks_run_of
from link.zenoh.ends import ODOM, Reader, free_endpoint, refuse_warning, until
from link.zenoh.fetched_incidents import write_incident
from link.zenoh.test_watching import NAMES, Robot, answered, step, watching
from made_once import made_once
from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.keys import Boot
from smarttestudo.link.zenoh import open_link_incidents, open_operator_end, open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.link.zenoh.session import open_session

pytestmark = pytest.mark.full
CERTIFICATES = "docs/how-to/secure-link.md"
ACCESS = "docs/how-to/watch-without-ros.md"
OPERATOR, ROBOT, VIEWER = (Path(f"{name}.json5") for name in ("operator", "robot", "viewer"))
ADA = "ada:/smarttestudo"
DENIED = (
    f"{ADA}: error: nobody takes this there; check that `testudo run` is still running, "
    "and that access control lets you ask this"
)
BOOT = Boot("ada", "0123456789abcdef")


def make_files(folder: Path) -> None:
    """What a reader of the first page has, and in ``restricted`` what one of the second has."""
    for line in shell_blocks_run_of(CERTIFICATES)[0].commands:
        here = line.replace("192.168.1.5", "127.0.0.1")
        subprocess.run(["sh", "-ec", here], cwd=folder, check=True, capture_output=True)
    restricted = folder / "restricted"
    restricted.mkdir()
    for path in folder.glob("*.[pk]e[my]"):
        (restricted / path.name).symlink_to(path)
    for page, folders in ((CERTIFICATES, (folder, restricted)), (ACCESS, (restricted,))):
        for block in blocks_of(page):
            if block.language == "json5":
                for place in folders:
                    (place / str(block.title)).write_text(block.text, encoding="utf-8")


@pytest.fixture
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_once(tmp_path_factory, "documented_access", make_files)


@contextmanager
def ada(endpoint: str, *, is_direct: bool) -> Iterator[Robot]:
    """The robot: others connect to it, or to an operator's end to which it connects itself."""
    listens = LinkOptions(listen=(endpoint,), config_file=OPERATOR)
    if is_direct:
        with open_robot_end("ada", listens, refuse_warning) as end:
            yield Robot(end)
        return
    connects = LinkOptions(connect=(endpoint,), config_file=ROBOT)
    with (
        open_operator_end(listens, refuse_warning) as operator,
        open_robot_end("ada", connects, refuse_warning) as end,
    ):
        reader, publisher = Reader(operator), end.advertise(ODOM)
        until(lambda: bool(reader.payloads(robot="ada")), lambda: publisher.publish(b"pose"))
        yield Robot(end)


@pytest.mark.parametrize("is_direct", [True, False])
@pytest.mark.parametrize("is_restricted", [True, False])
def test_a_viewer_sees_and_fetches_and_only_without_access_control_pushes(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, is_direct: bool, is_restricted: bool
) -> None:
    monkeypatch.chdir(files / "restricted" if is_restricted else files)
    endpoint = free_endpoint("tls")
    incident = write_incident(tmp_path / "kept")
    with ada(endpoint, is_direct=is_direct) as robot:
        robot.end.offer_incidents(incident.parent)
        for file, may_push in ((VIEWER, not is_restricted), (OPERATOR, True)):
            with watching(endpoint, file) as robots:
                until(lambda: ADA in robots.heard, lambda: step(robots, robot))
                values = answered(robots, robot, partial(robots.get, ADA, NAMES))
                assert values == {"rules_hash": "value of rules_hash"}
                asked = partial(robots.set, ADA, {"status_hz": 5.0})
                if may_push:
                    assert answered(robots, robot, asked) == {}
                    continue
                # Where the machine stands still meanwhile, the robot is said not to have answered in time.
                until(lambda: str(answered(robots, robot, asked)) == DENIED)  # noqa: B023
        connects = LinkOptions(connect=(endpoint,), config_file=VIEWER)
        with open_link_incidents(connects, refuse_warning) as incidents:
            until(lambda: "ada" in incidents.robots(0))
            (one,) = incidents.list("ada")
            fetched = incidents.fetch("ada", one.name, tmp_path / "here", lambda _: None, lambda: False)
            assert fetched is not None
        assert robot.set == [{"status_hz": 5.0}] * (1 if is_restricted else 2)


def test_incidents_are_closed_to_a_viewer_whose_rule_does_not_name_them(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(files / "restricted")
    text = OPERATOR.read_text(encoding="utf-8")
    assert text.count(', "testudo/*/*/incidents"') == 1
    closed = tmp_path / "closed.json5"
    closed.write_text(text.replace(', "testudo/*/*/incidents"', ""), encoding="utf-8")
    endpoint = free_endpoint("tls")
    listens = LinkOptions(listen=(endpoint,), config_file=closed)
    connects = LinkOptions(connect=(endpoint,), config_file=VIEWER)
    with (
        open_robot_end("ada", listens, refuse_warning) as end,
        open_link_incidents(connects, refuse_warning) as incidents,
    ):
        end.offer_incidents(write_incident(tmp_path / "kept").parent)
        until(lambda: "ada" in incidents.robots(0))
        with pytest.raises(LinkError, match="ada does not answer this"):
            incidents.list("ada")


def test_a_viewer_neither_drives_nor_hears_topics_nor_speaks_for_the_robot(
    files: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(files / "restricted")
    endpoint = free_endpoint("tls")
    at_robot, at_operator, at_viewer = set[bytes](), set[bytes](), set[bytes]()
    with ExitStack() as opened:

        def session(mode: str, file: Path, **options: tuple[str, ...]) -> zenoh.Session:
            linked = LinkOptions(config_file=file, **options)  # type: ignore[arg-type]
            return opened.enter_context(open_session(linked, mode, refuse_warning)).session

        def note(place: set[bytes]) -> Callable[[zenoh.Sample], None]:
            return lambda sample: place.add(sample.payload.to_bytes())

        operator = session("router", OPERATOR, listen=(endpoint,))
        robot = session("peer", ROBOT, connect=(endpoint,))
        viewer, listener = (session("client", VIEWER, connect=(endpoint,)) for _ in range(2))
        pusher = session("client", OPERATOR, connect=(endpoint,))
        robot_keys = (BOOT.command_key, BOOT.report_key)
        kept = [
            *(robot.declare_subscriber(key, note(at_robot)) for key in robot_keys),
            operator.declare_subscriber("testudo/**", note(at_operator)),
            *(
                listener.declare_subscriber(key, note(at_viewer))
                for key in ("testudo/**", "**", BOOT.data_key, "testudo/*/*/status")
            ),
        ]
        wild = ("testudo/**", f"{BOOT.key}/*", "testudo/*/*/command", "testudo/ada/**")

        def put_all() -> None:
            for key in (*robot_keys, BOOT.data_key, BOOT.status_key, BOOT.accepts_key, *wild):
                viewer.put(key, b"by the viewer")
            # A robot of another name.
            robot.put("testudo/bob/0123456789abcdef/data", b"by another robot")
            robot.put(BOOT.data_key, b"data")
            robot.put(BOOT.status_key, b"status")
            pusher.put(BOOT.command_key, b"command")

        until(lambda: bool(at_robot and at_viewer) and b"data" in at_operator, put_all)
        for _ in range(5):
            put_all()
        until(lambda: {b"data", b"status", b"command"} <= at_operator, put_all)
        for one in kept:
            one.undeclare()
    assert at_robot == {b"command"}
    assert at_operator == {b"data", b"status", b"command"}
    assert at_viewer == {b"status"}

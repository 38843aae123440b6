# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who is let in by certificates, or by user and password, and what the others are told."""

from __future__ import annotations

import json
import subprocess
from contextlib import ExitStack
from pathlib import Path

import pytest

from link.zenoh.ends import ODOM, Reader, free_endpoint, quick_watch, refuse_warning, until
from made_once import made_once
from smarttestudo.domain.errors import LinkError
from smarttestudo.link.zenoh import open_link_robots, open_operator_end, open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions

__all__ = ["quick_watch"]
pytestmark = [pytest.mark.full, pytest.mark.usefixtures("quick_watch")]


def make_certificates(folder: Path) -> None:
    """Two authorities, ``ours`` and ``theirs``; one of ours certifies two ends, the other a stranger."""

    def openssl(name: str, *arguments: str) -> None:
        made = [
            "-keyout",
            f"{name}.key",
            "-out",
            f"{name}.pem",
            "-subj",
            f"/CN={name}",
            "-days",
            "2",
            "-nodes",
        ]
        key = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"]
        command = ["openssl", "req", "-x509", *key, *made, *arguments]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)

    for authority in ("ours", "theirs"):
        openssl(authority)
    for name, authority in (("operator", "ours"), ("robot", "ours"), ("stranger", "theirs")):
        signed = ["-CA", f"{authority}.pem", "-CAkey", f"{authority}.key"]
        names = ["-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1"]
        openssl(name, *signed, *names, "-addext", "basicConstraints=critical,CA:FALSE")


@pytest.fixture
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the certificates."""
    return made_once(tmp_path_factory, "link_certificates", make_certificates)


def at_operator(folder: Path, endpoint: str) -> LinkOptions:
    """The operator listens with its certificate and asks for one of ours."""
    tls = settings(folder, "listen", "operator", "ours")
    return LinkOptions(listen=(endpoint,), config_file=written(folder, "operator", tls))


def settings(folder: Path, side: str, name: str, authority: str) -> dict[str, object]:
    """TLS settings of one side."""
    return {
        "root_ca_certificate": f"{folder / authority}.pem",
        f"{side}_certificate": f"{folder / name}.pem",
        f"{side}_private_key": f"{folder / name}.key",
        "enable_mtls": True,
    }


def written(folder: Path, name: str, tls: dict[str, object]) -> Path:
    """A configuration with these TLS settings."""
    path = folder / f"{name}.json5"
    path.write_text(json.dumps({"transport": {"link": {"tls": tls}}}))
    return path


@pytest.mark.parametrize("protocol", ["tls", "quic"])
@pytest.mark.contract
def test_an_end_with_our_certificate_is_let_in(certificates: Path, protocol: str) -> None:
    endpoint = free_endpoint(protocol)
    tls = settings(certificates, "connect", "robot", "ours")
    options = LinkOptions(connect=(endpoint,), config_file=written(certificates, "robot", tls))
    with (
        open_operator_end(at_operator(certificates, endpoint), refuse_warning) as operator,
        open_robot_end("r1", options, refuse_warning) as robot,
    ):
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        until(lambda: bool(reader.payloads()), lambda: publisher.publish(b"pose"))


@pytest.mark.parametrize(
    ("name", "authority", "cause"),
    [
        ("stranger", "ours", "does not accept our certificate"),
        ("robot", "theirs", "is not accepted here"),
        (None, "ours", "does not accept our certificate"),
    ],
)
def test_others_are_not_let_in_and_are_told_why(
    certificates: Path, name: str | None, authority: str, cause: str
) -> None:
    endpoint, warnings = free_endpoint("tls"), list[str]()
    tls = settings(certificates, "connect", name or "", authority)
    if name is None:
        tls = {"root_ca_certificate": tls["root_ca_certificate"]}
    config_file = written(certificates, f"{name}_{authority}", tls)
    options = LinkOptions(connect=(endpoint,), config_file=config_file, insecure=True)
    with (
        open_operator_end(at_operator(certificates, endpoint), refuse_warning) as operator,
        open_robot_end("r1", options, warnings.append) as robot,
    ):
        robot.advertise(ODOM).publish(b"pose")
        until(lambda: any(cause in warning for warning in warnings))
        assert operator.wait(0) == []
        assert not robot.state.is_connected
        assert max(map(len, warnings)) < 300
        assert len([warning for warning in warnings if "--insecure" not in warning]) == 1


@pytest.mark.parametrize(
    ("name", "cause", "remedy"),
    [
        ("stranger", "does not accept our certificate", "check certificates, user and password"),
        (None, "it cannot be reached", "start `testudo run --link` on the robot"),
    ],
)
def test_who_hears_no_robot_is_told_what_to_do_about_the_cause(
    certificates: Path, name: str | None, cause: str, remedy: str
) -> None:
    endpoint = free_endpoint("tls")
    config_file = written(certificates, "watcher", settings(certificates, "connect", name or "robot", "ours"))
    watcher = LinkOptions(connect=(endpoint,), config_file=config_file, insecure=True)
    with ExitStack() as opened:
        if name is not None:
            at = at_operator(certificates, endpoint)
            opened.enter_context(open_operator_end(at, refuse_warning))
        robots = opened.enter_context(open_link_robots(watcher, lambda _: None))
        until(lambda: cause in (robots.problem or ""))
        assert robots.remedy.startswith(remedy)


@pytest.mark.parametrize("protocol", ["tcp", "tls"])
@pytest.mark.parametrize(("password", "is_right"), [("right", True), ("wrong", False)])
def test_a_user_is_let_in_by_the_password(
    certificates: Path, tmp_path: Path, protocol: str, password: str, *, is_right: bool
) -> None:
    endpoint, warnings = free_endpoint(protocol), list[str]()
    users = tmp_path / "users.txt"
    users.write_text("r1:right\n")
    at_listener = settings(certificates, "listen", "operator", "ours") | {"enable_mtls": False}
    at_connector = {"root_ca_certificate": at_listener["root_ca_certificate"]}
    files = [tmp_path / "operator.json5", tmp_path / "robot.json5"]
    for path, tls, known in zip(
        files,
        (at_listener, at_connector),
        ({"dictionary_file": str(users)}, {"user": "r1", "password": password}),
        strict=True,
    ):
        path.write_text(json.dumps({"transport": {"link": {"tls": tls}, "auth": {"usrpwd": known}}}))
    with (
        open_operator_end(LinkOptions(listen=(endpoint,), config_file=files[0]), refuse_warning) as operator,
        open_robot_end(
            "r1", LinkOptions(connect=(endpoint,), config_file=files[1]), warnings.append
        ) as robot,
    ):
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        until(lambda: bool(reader.payloads() if is_right else warnings), lambda: publisher.publish(b"pose"))
        assert bool(reader.payloads()) == is_right
        assert all("user or password" in warning for warning in warnings)


def test_certificates_that_cannot_be_used_are_said_in_one_line(certificates: Path, tmp_path: Path) -> None:
    good = settings(certificates, "listen", "operator", "ours")
    text = tmp_path / "text.pem"
    text.write_text("no certificate")
    for change, named in (
        ({"listen_certificate": str(tmp_path / "none.pem")}, "none.pem"),
        ({"listen_private_key": str(tmp_path)}, str(tmp_path)),
        ({"root_ca_certificate": str(text)}, "text.pem"),
        ({"listen_private_key": f"{certificates / 'robot'}.key"}, "robot.key"),
    ):
        config_file = written(tmp_path, "operator", good | change)
        options = LinkOptions(listen=(free_endpoint("tls"),), config_file=config_file)
        with (
            pytest.raises(LinkError, match="certificate") as refused,
            open_operator_end(options, refuse_warning),
        ):
            pass
        assert named in str(refused.value)
        assert "\n" not in str(refused.value)


def test_an_end_that_nobody_answers_says_so_once() -> None:
    endpoint, warnings = free_endpoint(), list[str]()
    with open_robot_end("r1", LinkOptions(connect=(endpoint,)), warnings.append) as robot:
        until(lambda: bool(warnings))
        assert endpoint in warnings[0]
        assert "refused" in warnings[0]
        with open_operator_end(LinkOptions(listen=(endpoint,)), refuse_warning):
            until(lambda: robot.state.is_connected)
        assert len([warning for warning in warnings if "refused" in warning]) == 1

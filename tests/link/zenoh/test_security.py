# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who may reach an end of a link."""

from __future__ import annotations

import pytest

from smarttestudo.domain.errors import LinkError, UsageError
from smarttestudo.link.zenoh.security import LinkOptions, admit

TLS = {"root_ca_certificate": "ca.pem", "enable_mtls": True}
AT_LISTENER = {"listen_certificate": "cert.pem", "listen_private_key": "key.pem"}
AT_CONNECTOR = {"connect_certificate": "cert.pem", "connect_private_key": "key.pem"}


def tls(**settings: object) -> dict[str, object]:
    """A Zenoh configuration with these TLS settings, as Zenoh writes it: all names are there."""
    unset = dict.fromkeys(("root_ca_certificate", "enable_mtls", "listen_certificate", "connect_certificate"))
    return {"transport": {"link": {"tls": {**unset, **settings}}, "auth": {"usrpwd": {"user": None}}}}


def user(tls: dict[str, object], **settings: object) -> dict[str, object]:
    """A Zenoh configuration with these settings of TLS, users and passwords."""
    return {"transport": {"link": {"tls": tls}, "auth": {"usrpwd": settings}}}


@pytest.mark.parametrize(
    "endpoint",
    [
        "tcp/127.0.0.1:7447",
        "tcp/127.8.9.10:7447",
        "tcp/[::1]:7447",
        "tcp/localhost:7447",
        "udp/127.0.0.1:7447?rel=1",
        "tcp/127.0.0.1:7447#so_sndbuf=65000",
        "unixsock-stream//tmp/robot.sock",
    ],
)
def test_programs_of_this_machine_may_freely(endpoint: str) -> None:
    assert admit(LinkOptions(listen=(endpoint,), connect=(endpoint,)), {}) is None


@pytest.mark.parametrize(
    "endpoint",
    [
        "tcp/0.0.0.0:7447",
        "tcp/[::]:7447",
        "tcp/[::ffff:127.0.0.1]:7447",
        "tcp/192.168.1.5:7447",
        "tcp/127.0.0.1.example.com:7447",
        "tcp/localhost.example.com:7447",
        "tcp/robot:7447",
        "udp/10.0.0.1:7447",
        "ws/robot:80",
        "serial//dev/ttyUSB0",
        "tcp/robot:7447#host=127.0.0.1",
    ],
)
def test_others_may_not_unless_it_is_asked_for_and_said(endpoint: str) -> None:
    for options in ({"listen": (endpoint,)}, {"connect": (endpoint,)}):
        with pytest.raises(LinkError, match="--insecure") as refused:
            admit(LinkOptions(**options), tls(**TLS, **AT_LISTENER, **AT_CONNECTOR))  # type: ignore[arg-type]
        assert refused.value.place == endpoint
        warning = admit(LinkOptions(**options, insecure=True), {})  # type: ignore[arg-type]
        assert warning is not None
        assert endpoint in warning


@pytest.mark.parametrize("protocol", ["tls", "quic"])
def test_client_certificates_let_others_in(protocol: str) -> None:
    endpoint = f"{protocol}/192.168.1.5:7447"
    listens, connects = LinkOptions(listen=(endpoint,)), LinkOptions(connect=(endpoint,))
    assert admit(listens, tls(**TLS, **AT_LISTENER)) is None
    assert admit(connects, tls(**TLS, **AT_CONNECTOR)) is None
    assert admit(LinkOptions(listen=(f"{endpoint}#iface=eth0",)), tls(**TLS, **AT_LISTENER)) is None
    for options, config in (
        (listens, tls(**TLS, **AT_CONNECTOR)),
        (connects, tls(**TLS, **AT_LISTENER)),
        (listens, tls(**AT_LISTENER, root_ca_certificate="ca.pem")),
        (listens, tls(**AT_LISTENER, root_ca_certificate="ca.pem", enable_mtls=False)),
        (listens, tls(**AT_LISTENER, enable_mtls=True)),
        (LinkOptions(listen=(f"{endpoint}#enable_mtls=false",)), tls(**TLS, **AT_LISTENER)),
    ):
        with pytest.raises(LinkError, match="others could read"):
            admit(options, config)


def test_tls_without_any_certificate_is_refused_even_where_anybody_may() -> None:
    with pytest.raises(LinkError, match="certificates"):
        admit(LinkOptions(listen=("tls/robot:7447",), insecure=True), {})


AUTHORITY: dict[str, object] = {"root_ca_certificate": "ca.pem"}


@pytest.mark.parametrize("protocol", ["tls", "quic"])
def test_user_and_password_let_others_in_over_tls(protocol: str) -> None:
    endpoint = f"{protocol}/192.168.1.5:7447"
    listens, connects = LinkOptions(listen=(endpoint,)), LinkOptions(connect=(endpoint,))
    assert admit(listens, user(dict(AT_LISTENER), dictionary_file="users.txt")) is None
    assert admit(connects, user(AUTHORITY, user="r1", password="secret")) is None
    for options, config in (
        (listens, user(dict(AT_LISTENER), user="r1", password="secret")),
        (listens, user(AUTHORITY, dictionary_file="users.txt")),
        (connects, user(AUTHORITY, dictionary_file="users.txt")),
        (connects, user(AUTHORITY, user="r1", password=None)),
        (connects, user(dict(AT_CONNECTOR), user="r1", password="secret")),
    ):
        with pytest.raises(LinkError, match="send what they like"):
            admit(options, config)


@pytest.mark.parametrize("protocol", ["tcp", "udp", "ws"])
def test_user_and_password_alone_encrypt_nothing_and_are_not_enough(protocol: str) -> None:
    endpoint = f"{protocol}/192.168.1.5:7447"
    for options, config in (
        ({"listen": (endpoint,)}, user(dict(AT_LISTENER), dictionary_file="users.txt")),
        ({"connect": (endpoint,)}, user(AUTHORITY, user="r1", password="secret")),
    ):
        with pytest.raises(LinkError) as refused:
            admit(LinkOptions(**options), config)  # type: ignore[arg-type]
        assert str(refused.value).startswith(
            f"{endpoint}: error: others could read what is sent there: user and password encrypt nothing; "
            "use an endpoint tls/…"
        )
        assert admit(LinkOptions(**options, insecure=True), config) == (  # type: ignore[arg-type]
            f"--insecure: whoever is between both ends of {endpoint} can read and change all that is sent, "
            "as user and password encrypt nothing"
        )
        with pytest.raises(UsageError, match="could drive the robot with /joy"):
            admit(LinkOptions(**options, insecure=True, commands=("/joy",)), config)  # type: ignore[arg-type]


def test_one_open_endpoint_among_protected_ones_is_refused() -> None:
    with pytest.raises(LinkError) as refused:
        admit(LinkOptions(listen=("tcp/127.0.0.1:1", "tcp/0.0.0.0:2"), connect=("tcp/127.0.0.1:3",)), {})
    assert refused.value.place == "tcp/0.0.0.0:2"


@pytest.mark.parametrize("endpoint", ["", "tcp", "tcp/", "127.0.0.1:7447", "/x", "#a=b"])
def test_what_is_no_endpoint_is_said_in_one_line(endpoint: str) -> None:
    with pytest.raises(LinkError, match="no endpoint"):
        admit(LinkOptions(connect=(endpoint,)), {})

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Admission to an end of a link."""

from __future__ import annotations

import ipaddress
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.domain.errors import LinkError, UsageError

_LOCAL_PROTOCOLS = ("unixsock-stream", "unixpipe")
_TLS_PROTOCOLS = ("tls", "quic")
_UDP_PROTOCOLS = ("quic", "udp")
_PORT_PROTOCOLS = (*_TLS_PROTOCOLS, "tcp", "udp", "ws")
_LAST_PORT = 65_535
_EXPECTED = "write it as in tls/192.168.1.5:7447"


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkOptions:
    """Where a link listens and connects to, as Zenoh endpoints: ``tcp/127.0.0.1:7447``.

    ``config_file`` is a Zenoh configuration (JSON5) for certificates, users and access control; what is
    needed for a link goes before what it says. ``insecure`` allows what others can read and change.
    ``commands`` are the topics whose messages go from operators to robots. What operators fetch of incidents
    and gaps takes at most ``fetch_budget_kb_per_s`` of a robot's end.

    Unless it ``has_datagrams`` not, these go beside it, at ``datagrams_port`` or the port of the endpoint,
    in the class ``dscp``; between programs of this machine only if that port is given. A link that
    ``needs_datagrams`` is not opened where there can be none, and uses them though nothing is lost.
    """

    listen: tuple[str, ...] = ()
    connect: tuple[str, ...] = ()
    config_file: Path | None = None
    insecure: bool = False
    commands: tuple[str, ...] = ()
    fetch_budget_kb_per_s: float = math.inf
    has_datagrams: bool = True
    needs_datagrams: bool = False
    datagrams_port: int | None = None
    dscp: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Locator:
    """A Zenoh endpoint in parts; ``settings`` are those that it brings for itself (``#name=value;…``)."""

    protocol: str
    address: str
    settings: Mapping[str, str]

    @staticmethod
    def of(endpoint: str) -> Locator:
        """The parts of ``endpoint``. Raises ``LinkError``."""
        place, _, settings = endpoint.partition("#")
        protocol, _, address = place.partition("?")[0].partition("/")
        if not protocol or not address:
            raise LinkError("this is no endpoint", place=endpoint[:200], remedy=_EXPECTED)
        pairs = (setting.partition("=") for setting in settings.split(";") if setting)
        found = Locator(
            protocol=protocol, address=address, settings={name: value for name, _, value in pairs}
        )
        port = found.port
        has_port = port.isascii() and port.isdecimal() and int(port) <= _LAST_PORT
        if protocol in _PORT_PROTOCOLS and not has_port:
            cause = f"{port[:80]!r} is not a port from 0 to {_LAST_PORT}" if port else "it has no port"
            raise LinkError(cause, place=endpoint[:200], remedy=_EXPECTED)
        return found

    @property
    def host(self) -> str:
        """The host, or the whole address where it has none."""
        return self.address.rpartition(":")[0].strip("[]") or self.address

    @property
    def port(self) -> str:
        """The port; empty where there is none."""
        return self.address.rpartition(":")[2] if ":" in self.address else ""

    @property
    def is_loopback(self) -> bool:
        """Whether only programs of the same machine reach it."""
        if self.protocol in _LOCAL_PROTOCOLS or self.host == "localhost":
            return True
        try:
            address = ipaddress.ip_address(self.host)
        except ValueError:
            return False
        is_mapped = isinstance(address, ipaddress.IPv6Address) and address.ipv4_mapped is not None
        return address.is_loopback and not is_mapped


def datagram_locators(options: LinkOptions, endpoints: Sequence[str]) -> list[Locator]:
    """The places of ``endpoints`` beside which datagrams go.

    None goes between programs of one machine, where nothing is lost, nor where Zenoh has the UDP port itself,
    unless a port is given for that.
    """
    locators = [Locator.of(endpoint) for endpoint in endpoints]
    return [
        one
        for one in locators
        if one.protocol in _PORT_PROTOCOLS
        and (options.datagrams_port is not None or not (one.is_loopback or one.protocol in _UDP_PROTOCOLS))
    ]


def has_datagrams(options: LinkOptions) -> bool:
    """Whether datagrams are to go beside a link."""
    endpoints = (*options.listen, *options.connect)
    return options.has_datagrams and bool(datagram_locators(options, endpoints))


def admit(options: LinkOptions, config: Mapping[str, object]) -> str | None:
    """A warning of endpoints where others can listen in, for a Zenoh ``config``; ``None`` without any.

    Endpoints that only programs of this machine reach are free. Others need TLS, with client certificates or
    with user and password: without TLS, these keep others from connecting, but all messages are in clear.

    Raises ``LinkError`` for an endpoint that lacks that, unless it is asked for; ``UsageError`` where it is
    asked for and robots would be driven.
    """
    endpoints = [(endpoint, "listen") for endpoint in options.listen]
    endpoints += [(endpoint, "connect") for endpoint in options.connect]
    open_to_all, in_clear = list[str](), list[str]()
    for endpoint, side in endpoints:
        locator = Locator.of(endpoint)
        settings = tls_settings(locator, config)
        if not (locator.is_loopback or _is_protected(settings, config, side)):
            is_in_clear = locator.protocol not in _TLS_PROTOCOLS and _has_user(config, side)
            (in_clear if is_in_clear else open_to_all).append(endpoint)
        if locator.protocol in _TLS_PROTOCOLS and not settings:
            raise LinkError(
                "it needs certificates", place=endpoint, remedy="name them in --zenoh-config FILE"
            )
    unprotected = open_to_all + in_clear
    if not unprotected:
        return None
    if options.insecure and options.commands:
        raise UsageError(
            f"whoever reaches it could drive the robot with {' '.join(options.commands)}",
            place=unprotected[0],
            remedy="protect it with --zenoh-config FILE, not --insecure, or leave out --accept and --send",
        )
    if options.insecure:
        return "; ".join(_insecure(open_to_all, in_clear))
    raise LinkError(
        "others could read what is sent there, and send what they like"
        if open_to_all
        else "others could read what is sent there: user and password encrypt nothing",
        place=unprotected[0],
        remedy="use an endpoint tls/… or quic/… and --zenoh-config FILE with client certificates "
        "(enable_mtls) or with a certificate, user and password, or accept it with --insecure",
    )


def _insecure(open_to_all: Sequence[str], in_clear: Sequence[str]) -> Iterator[str]:
    if open_to_all:
        places = " or ".join(open_to_all)
        yield f"--insecure: whoever reaches {places} can read all that is sent and send what they like"
    if in_clear:
        places = " or ".join(in_clear)
        yield (
            f"--insecure: whoever is between both ends of {places} can read and change all that is sent, "
            "as user and password encrypt nothing"
        )


def tls_settings(locator: Locator, config: Mapping[str, object]) -> dict[str, str]:
    """The TLS settings that hold for an endpoint, of those that are set; none where it has no TLS."""
    if locator.protocol not in _TLS_PROTOCOLS:
        return {}
    of_all = _at(config, "transport", "link", "tls")
    settings = {name: _text(value) for name, value in of_all.items() if value is not None}
    own = {name.removesuffix("_file"): value for name, value in locator.settings.items()}
    return settings | own


def key_files(settings: Mapping[str, str], side: str) -> tuple[str | None, str | None, str | None]:
    """The files of authority, certificate and key of ``listen`` or ``connect``, as far as they are set."""
    names = ("root_ca_certificate", f"{side}_certificate", f"{side}_private_key")
    authority, certificate, key = (settings.get(name) or None for name in names)
    return authority, certificate, key


def _is_protected(settings: Mapping[str, str], config: Mapping[str, object], side: str) -> bool:
    authority, certificate, key = key_files(settings, side)
    if settings.get("enable_mtls") == "true" and authority and certificate and key:
        return True
    is_encrypted = bool(certificate and key) if side == "listen" else authority is not None
    return is_encrypted and _has_user(config, side)


def _has_user(config: Mapping[str, object], side: str) -> bool:
    given = _at(config, "transport", "auth", "usrpwd")
    needed = ("dictionary_file",) if side == "listen" else ("user", "password")
    return all(given.get(name) for name in needed)


def _at(config: Mapping[str, object], *path: str) -> Mapping[str, object]:
    found: object = config
    for name in path:
        found = found.get(name) if isinstance(found, Mapping) else None
    return found if isinstance(found, Mapping) else {}


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who may reach an end of a link."""

from __future__ import annotations

import ipaddress
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.domain.errors import LinkError, UsageError

_LOCAL_PROTOCOLS = ("unixsock-stream", "unixpipe")
_TLS_PROTOCOLS = ("tls", "quic")
_TLS_SETTINGS = ("root_ca_certificate", "enable_mtls")


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkOptions:
    """Where a link listens and connects to, as Zenoh endpoints: ``tcp/127.0.0.1:7447``.

    ``config_file`` is a Zenoh configuration (JSON5) for certificates, users and access control; what is
    needed for a link goes before what it says. ``insecure`` lets anybody in. ``commands`` are the topics
    whose messages go from operators to robots.
    """

    listen: tuple[str, ...] = ()
    connect: tuple[str, ...] = ()
    config_file: Path | None = None
    insecure: bool = False
    commands: tuple[str, ...] = ()


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
            raise LinkError(
                "this is no endpoint", place=endpoint[:200], remedy="write it as in tcp/192.168.1.5:7447"
            )
        pairs = (setting.partition("=") for setting in settings.split(";") if setting)
        return Locator(protocol=protocol, address=address, settings={name: value for name, _, value in pairs})

    @property
    def host(self) -> str:
        """Its host, or the whole address where it has none."""
        return self.address.rpartition(":")[0].strip("[]") or self.address

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


def admit(options: LinkOptions, config: Mapping[str, object]) -> str | None:
    """A warning of endpoints that let anybody in, for a Zenoh ``config``; ``None`` where there are none.

    Raises ``LinkError`` for an endpoint that others than programs of this machine reach and that neither
    TLS with client certificates nor user and password protect, unless that is asked for; ``UsageError``
    where it is asked for and robots would be driven.
    """
    endpoints = [(endpoint, "listen") for endpoint in options.listen]
    endpoints += [(endpoint, "connect") for endpoint in options.connect]
    has_user = {side: _has_user(config, side) for side in ("listen", "connect")}
    unprotected = []
    for endpoint, side in endpoints:
        locator = Locator.of(endpoint)
        if not (locator.is_loopback or has_user[side] or _is_mutual(tls_settings(locator, config), side)):
            unprotected.append(endpoint)
        if locator.protocol in _TLS_PROTOCOLS and not tls_settings(locator, config):
            raise LinkError(
                "it needs certificates", place=endpoint, remedy="name them in --zenoh-config FILE"
            )
    if not unprotected:
        return None
    if options.insecure and options.commands:
        raise UsageError(
            f"whoever reaches it could drive the robot with {' '.join(options.commands)}",
            place=unprotected[0],
            remedy="protect it with --zenoh-config FILE, not --insecure, or leave out --accept and --send",
        )
    if options.insecure:
        return (
            f"--insecure: whoever reaches {' or '.join(unprotected)} can read all that is sent "
            "and send what they like"
        )
    raise LinkError(
        "others could read what is sent there, and send what they like",
        place=unprotected[0],
        remedy="give --zenoh-config FILE with TLS and client certificates (enable_mtls) or with user and "
        "password, or accept it with --insecure",
    )


def tls_settings(locator: Locator, config: Mapping[str, object]) -> dict[str, str]:
    """The TLS settings that hold for an endpoint, of those that are set; none where it has no TLS."""
    if locator.protocol not in _TLS_PROTOCOLS:
        return {}
    of_all = _at(config, "transport", "link", "tls")
    settings = {name: _text(value) for name, value in of_all.items() if value is not None}
    own = {name.removesuffix("_file"): value for name, value in locator.settings.items()}
    return settings | own


def key_files(settings: Mapping[str, str], side: str) -> tuple[str, str, str] | None:
    """The files of authority, certificate and key of ``listen`` or ``connect``; ``None`` if one lacks."""
    names = ("root_ca_certificate", f"{side}_certificate", f"{side}_private_key")
    authority, certificate, key = (settings.get(name, "") for name in names)
    return (authority, certificate, key) if authority and certificate and key else None


def _is_mutual(settings: Mapping[str, str], side: str) -> bool:
    return settings.get("enable_mtls") == "true" and key_files(settings, side) is not None


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

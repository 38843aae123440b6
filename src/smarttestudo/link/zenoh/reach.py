# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Why the other end of a link cannot be reached, which Zenoh itself does not tell."""

from __future__ import annotations

import socket
import ssl
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.zenoh.security import LinkOptions, Locator, key_files, tls_settings

_ANSWER_WITHIN_S = 3.0
_REFUSED_WITHIN_S = 1.0
"""How long after its handshake the other end may still refuse a certificate (TLS 1.3)."""


def check_certificates(options: LinkOptions, config: Mapping[str, object]) -> None:
    """Raise ``LinkError`` where the certificates of an endpoint cannot be read or do not belong together."""
    for side, endpoints in (("listen", options.listen), ("connect", options.connect)):
        for endpoint in endpoints:
            authority, certificate, key = key_files(tls_settings(Locator.of(endpoint), config), side)
            if certificate and key:
                _context(authority, certificate, key)
            elif authority:
                _context(authority)


@dataclass(frozen=True, slots=True, kw_only=True)
class Unreachable:
    """Why there is no link to an endpoint, in one line, and whether somebody there does not let us in."""

    why: str
    is_refused: bool = False


def why_unreachable(endpoint: str, config: Mapping[str, object]) -> Unreachable:
    """Why there is no link to ``endpoint``, from a look at it where it is TCP or TLS."""
    locator = Locator.of(endpoint)
    if locator.protocol not in ("tcp", "tls"):
        return Unreachable(why=f"{endpoint}: it cannot be reached, or does not let us in")
    try:
        with socket.create_connection((locator.host, int(locator.port)), _ANSWER_WITHIN_S) as connection:
            if locator.protocol == "tls":
                _shake_hands(connection, locator, config)
    except ssl.SSLCertVerificationError as error:
        why = f"its certificate is not accepted here: {error.verify_message}"
    except ssl.SSLError as error:
        reason = (error.reason or str(error)).replace("_", " ").lower()
        why = f"it does not accept our certificate: {reason}"
    except (OSError, LinkError) as error:
        cause = getattr(error, "strerror", None) or error
        return Unreachable(why=f"{endpoint}: it cannot be reached: {cause}")
    else:
        why = (
            "a process listens there, but no link comes about: "
            "user or password in --zenoh-config are not accepted, or that process stands still"
        )
    return Unreachable(why=f"{endpoint}: {why}", is_refused=True)


def _shake_hands(connection: socket.socket, locator: Locator, config: Mapping[str, object]) -> None:
    settings = tls_settings(locator, config)
    authority, certificate, key = key_files(settings, "connect")
    context = _context(authority, certificate, key) if certificate and key else _context(authority)
    context.check_hostname = settings.get("verify_name_on_connect", "true") == "true"
    with context.wrap_socket(connection, server_hostname=locator.host) as secured:
        secured.settimeout(_REFUSED_WITHIN_S)
        try:
            secured.recv(1)
        except TimeoutError:
            # It waits for Zenoh's first word.
            return


def _context(authority: str | None, certificate: str | None = None, key: str | None = None) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    path = ""
    try:
        for path in filter(None, (authority, certificate, key)):
            Path(path).open("rb").close()
        if authority:
            path = authority
            context.load_verify_locations(path)
        else:
            context.load_default_certs()
        if certificate:
            path = f"{certificate} or {key}"
            # Without a password, one would be asked for in the terminal.
            context.load_cert_chain(certificate, key, password="")
    except OSError as error:
        raise _unusable(path, error) from error
    return context


def _unusable(path: str, error: OSError) -> LinkError:
    cause = (
        (error.reason or "").replace("_", " ").lower() if isinstance(error, ssl.SSLError) else error.strerror
    )
    return LinkError(
        f"it cannot be used as a certificate: {cause or error}", place=path, remedy="check --zenoh-config"
    )

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Zenoh session for a link: no discovery, soon aware of a dead link, connected again without a hand."""

from __future__ import annotations

import atexit
import json
import re
import socket
import ssl
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.files.input_file import read_input
from smarttestudo.link.protocol.keys import Boot
from smarttestudo.link.protocol.wire import other_version, version_sentence
from smarttestudo.link.zenoh.security import LinkOptions, Locator, admit, key_files, tls_settings

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


_MOST_CONFIG_BYTES = 1_000_000
_MOST_CONFIG_DEPTH = 100
"""Zenoh's own settings lie some eight deep; its parser, which recurses, dies of thousands."""
_TEXTS_AND_COMMENTS = re.compile(
    r""""(?:\\.|[^"\\])*(?:"|\Z)|'(?:\\.|[^'\\])*(?:'|\Z)|//[^\n\r\u2028\u2029]*|/\*.*?(?:\*/|\Z)""",
    re.DOTALL,
)
_MOST_CAUSE = 300
POLL_PERIOD_S = 2.0
_END_WITHIN_S = 5.0
_OF_ZENOH = "pyo3"
"""In the names of the threads that Zenoh's Python package starts for callbacks."""
_SOURCE_LINE = re.compile(r"\s+at \S+\.rs:\d+\.?")

OPERATOR = "an operator's end"
_MOST_SAID = 1_000

_SETTINGS: Mapping[str, object] = {
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "transport/shared_memory/enabled": False,
    # A link that is silent for so long is dead; each end sends something four times in it.
    "transport/link/tx/lease": 2_500,
    "transport/link/tx/keep_alive": 4,
    # The largest that either end sends is a report; nothing larger is put together in memory.
    "transport/link/rx/max_message_size": 1_000_000,
    "connect/timeout_ms": -1,
    "connect/exit_on_failure": False,
    "connect/retry": {"period_init_ms": 500, "period_max_ms": 1_000, "period_increase_factor": 1.5},
    "listen/timeout_ms": 0,
    "listen/exit_on_failure": True,
    "open/return_conditions": {"connect_scouted": False, "declares": False},
}

_CLIENT_SETTINGS: Mapping[str, object] = {
    # Opening a client waits until it is connected.
    "connect/timeout_ms": 1_000,
    "connect/exit_on_failure": True,
}


class LinkSession(NamedTuple):
    """A Zenoh session, and what is to be called again after as many seconds as it returns.

    ``watch`` says why nobody is connected; it waits for that, and may only while nobody is.
    """

    session: zenoh.Session
    watch: Callable[[], float]


@contextmanager
def open_session(options: LinkOptions, mode: str, warn: Callable[[str], None]) -> Iterator[LinkSession]:
    """A session at the endpoints of ``options``, whether or not anybody answers there yet.

    ``mode`` is Zenoh's: ``peer`` or ``router``. ``warn`` is told why nobody answers. Raises ``LinkError``.
    """
    config, known = session_config(options, mode, warn)
    place = ", ".join((*options.listen, *options.connect))
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        raise LinkError(_cause(error), place=place, remedy="is the endpoint right, and free?") from error
    try:
        yield LinkSession(session, partial(next, _watch(session, options.connect, known, warn)))
    finally:
        close_session(session)


def close_session(session: zenoh.Session) -> None:
    """Close it, and let its callbacks end before the interpreter does.

    A thread of Zenoh's that comes back while the interpreter ends aborts the process, and nothing waits for
    those that a daemon thread began.
    """
    session.close()
    # Once, however often a client connects again.
    atexit.unregister(_await_callbacks)
    atexit.register(_await_callbacks)


def _await_callbacks() -> None:
    end_s = time.monotonic() + _END_WITHIN_S
    for thread in threading.enumerate():
        if _OF_ZENOH in thread.name:
            thread.join(max(end_s - time.monotonic(), 0.0))


def has_subscribers(publisher: zenoh.Publisher) -> bool:
    """Whether somebody subscribes to what it publishes."""
    # Zenoh's type stubs call it a bool.
    status: Any = publisher.matching_status
    return bool(status.matching)


def session_config(
    options: LinkOptions, mode: str, warn: Callable[[str], None]
) -> tuple[zenoh.Config, Mapping[str, object]]:
    """The configuration of a session at the endpoints of ``options``, and what its file says.

    ``mode`` is Zenoh's: ``peer``, ``router`` or ``client``. A client that cannot connect gives up at once.
    Raises ``LinkError``.
    """
    if not options.listen and not options.connect:
        raise LinkError("a link needs an endpoint to listen at or to connect to")
    config = _read_config(options.config_file)
    known = json.loads(str(config))
    warning = admit(options, known)
    check_certificates(options, known)
    if warning:
        warn(warning)
    place = ", ".join((*options.listen, *options.connect))
    settings: dict[str, object] = {
        "mode": mode,
        "listen/endpoints": options.listen,
        "connect/endpoints": options.connect,
        **_SETTINGS,
    }
    if mode == "client":
        settings |= _CLIENT_SETTINGS
    try:
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
    except zenoh.ZError as error:
        raise LinkError(_cause(error), place=place, remedy="is the endpoint right, and free?") from error
    return config, known


def _read_config(path: Path | None) -> zenoh.Config:
    try:
        text = "{}" if path is None else read_input(path, _MOST_CONFIG_BYTES).decode()
        _require_shallow(text)
        config: zenoh.Config = zenoh.Config.from_json5(text)
    except OSError as error:
        raise LinkError(
            error.strerror or str(error), place=str(path), remedy="check --zenoh-config"
        ) from error
    except (zenoh.ZError, ValueError) as error:
        cause = f"it is no Zenoh configuration: {_cause(error)}"
        raise LinkError(cause, place=str(path), remedy="correct it, or see zenoh.io/docs") from error
    return config


def _require_shallow(text: str) -> None:
    """Raise ``ValueError`` where brackets of JSON5 lie too deep in each other."""
    depth = 0
    for bracket in re.findall(r"[][{}]", _TEXTS_AND_COMMENTS.sub("", text)):
        depth = depth + 1 if bracket in "[{" else max(depth - 1, 0)
        if depth > _MOST_CONFIG_DEPTH:
            raise ValueError(f"brackets lie more than {_MOST_CONFIG_DEPTH} deep in each other")


def _cause(error: Exception) -> str:
    return " ".join(_SOURCE_LINE.sub("", str(error)).split())[:_MOST_CAUSE].rstrip(" .!")


def _watch(
    session: zenoh.Session,
    endpoints: tuple[str, ...],
    config: Mapping[str, object],
    warn: Callable[[str], None],
) -> Iterator[float]:
    """Say why nobody is connected, each cause once, when it was there twice: the other end may just start."""
    said: set[str] = set()
    seen: set[str] = set()
    while True:
        yield POLL_PERIOD_S
        if is_connected(session):
            said, seen = set(), set()
            continue
        before, seen = seen, {why_unreachable(endpoint, config).why for endpoint in endpoints}
        for why in sorted(before & seen - said):
            warn(why)
        said |= before & seen


def is_connected(session: zenoh.Session) -> bool:
    return bool(session.info.routers_zid() or session.info.peers_zid())


def robot_peer(boot: Boot) -> str:
    """The name of a robot's end in a sentence."""
    return f"robot {boot.robot}"


class OtherVersions:
    """Tells ``warn`` once of each peer that speaks another version; what it sends is lost.

    ``present`` has what is to be said of each peer that is there.
    """

    def __init__(self, warn: Callable[[str], None] = lambda _: None) -> None:
        self.present: dict[str, str] = {}
        self._warn = warn
        self._said: set[str] = set()

    def check(self, peer: str, data: bytes) -> None:
        """See which version the data of ``peer`` has."""
        version = other_version(data)
        if version is None or len(self._said) >= _MOST_SAID:
            return
        sentence = self.present[peer] = version_sentence(peer, version)
        if sentence not in self._said:
            self._said.add(sentence)
            self._warn(sentence)

    def leave(self, peer: str) -> None:
        self.present.pop(peer, None)

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's server on a socket."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import socket
from collections.abc import Callable

import uvicorn
from starlette.types import ASGIApp

from smarttestudo.domain.errors import PortError
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.incidents.robot_incidents import OpenIncidents
from smarttestudo.ruler.robots.link import OpenRobots
from smarttestudo.ruler.server.app import ruler_app
from smarttestudo.ruler.server.guard import ServerAddress
from smarttestudo.ruler.server.routes import MAX_BODY_BYTES

_STOP_TIMEOUT_S = 2


def serve(
    folder: ProjectFolder,
    open_robots: OpenRobots,
    *,
    open_incidents: OpenIncidents | None,
    host: str,
    port: int,
    is_watch_only: bool,
    started: Callable[[ServerAddress], None],
) -> None:
    """Serve ``folder``, the robots of ``open_robots`` and what these recorded until asked to stop.

    Port 0 takes a free one. With ``is_watch_only`` nobody may change anything. ``started`` gets the address,
    once the server listens. Raises ``PortError`` where it cannot listen.
    """
    with listening(host, port) as listener:
        port = listener.getsockname()[1]
        access = ServerAddress.at(host, port, machine=socket.gethostname(), is_watch_only=is_watch_only)
        started(access)
        app = ruler_app(folder, access, open_robots, open_incidents=open_incidents)
        server = server_of(app)
        # Ctrl-C is how a server ends: uvicorn raises it again once it has ended well.
        with contextlib.suppress(KeyboardInterrupt):
            server.run(sockets=[listener])


def server_of(app: ASGIApp) -> uvicorn.Server:
    """``app`` as a server; it trusts no proxy, and sends no server header."""
    config = uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        server_header=False,
        date_header=False,
        proxy_headers=False,
        ws="websockets-sansio",
        ws_max_size=MAX_BODY_BYTES,
        timeout_graceful_shutdown=_STOP_TIMEOUT_S,
        lifespan="on",
    )
    logging.getLogger("uvicorn.error").addFilter(_without_foreign_traceback)
    return uvicorn.Server(config)


def _without_foreign_traceback(record: logging.LogRecord) -> bool:
    """Leave out what is no fault of the server: requests that its end cut, and text that is not UTF-8."""
    if record.exc_info and record.exc_info[0] is asyncio.CancelledError:
        return False
    if (
        record.exc_info
        and record.exc_info[0] is UnicodeDecodeError
        and record.msg.startswith("Invalid UTF-8")
    ):
        record.exc_info = None
        record.levelno, record.levelname = logging.WARNING, "WARNING"
    return True


def listening(host: str, port: int) -> socket.socket:
    """A socket that listens; ``PortError`` where that is not possible."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listener = socket.socket(family, socket.SOCK_STREAM)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind((host, port))
            listener.listen()
        except OSError:
            listener.close()
            raise
    except OSError as error:
        cause = f"the server cannot listen there: {error.strerror or error}"
        is_host = isinstance(error, socket.gaierror) or error.errno == errno.EADDRNOTAVAIL
        remedy = "give another --host" if is_host else "give another --port"
        raise PortError(cause, place=f"{host}:{port}", remedy=remedy) from error
    return listener

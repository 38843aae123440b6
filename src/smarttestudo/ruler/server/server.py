# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's server: the routes of all jobs, the page and its web socket, on a socket."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from functools import partial

import uvicorn
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.types import ASGIApp

from smarttestudo.domain.errors import PortError, TestudoError
from smarttestudo.ruler.files.drafts import DraftStore
from smarttestudo.ruler.files.project import SettingsFile
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.versions import VersionStore
from smarttestudo.ruler.incidents.robot_incidents import OpenIncidents, RobotIncidents
from smarttestudo.ruler.job import RequestError, all_jobs
from smarttestudo.ruler.robots.known import KnownRobots
from smarttestudo.ruler.robots.link import OpenRobots, RobotLink
from smarttestudo.ruler.rules.document import CheckedTexts
from smarttestudo.ruler.server.guard import Guard, ServerAddress
from smarttestudo.ruler.server.live import Listeners, LiveFeed, Progress
from smarttestudo.ruler.server.page import documentation_routes, page_files
from smarttestudo.ruler.server.processes import Processes
from smarttestudo.ruler.server.routes import GONE, MAX_BODY_BYTES, error_answer, job_route
from smarttestudo.ruler.topics.vocabulary import RobotTopics
from smarttestudo.ruler.tries.keep import Keeps
from smarttestudo.ruler.tries.summary import FileLoads, LastTries


def ruler_app(
    folder: ProjectFolder,
    access: ServerAddress,
    open_robots: OpenRobots,
    *,
    open_incidents: OpenIncidents | None = None,
) -> ASGIApp:
    """The server of the project in ``folder``, for whom ``access`` lets in, with these robots."""
    listeners = Listeners()
    processes = Processes(folder.root)
    keeps = Keeps(folder, processes.result)
    robot_incidents = RobotIncidents(folder, open_incidents)
    link = RobotLink(open_robots, KnownRobots(folder))
    feed = LiveFeed(link, listeners)
    services: dict[object, object] = {
        ProjectFolder: folder,
        SettingsFile: SettingsFile(folder),
        VersionStore: VersionStore(folder),
        DraftStore: DraftStore(folder),
        LastTries: LastTries(folder),
        FileLoads: FileLoads(),
        CheckedTexts: CheckedTexts(),
        Keeps: keeps,
        RobotIncidents: robot_incidents,
        RobotLink: link,
        RobotTopics: link.topics,
    }

    def tell(run: str, share: float) -> None:
        listeners.tell(Progress(run=run, share=share))

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        yield
        await feed.close()
        await keeps.close()
        await processes.close()
        await run_in_threadpool(robot_incidents.close)

    jobs = all_jobs()
    routes: list[BaseRoute] = [
        *(job_route(job, services, partial(processes.result, job), tell) for job in jobs),
        Route("/api/{path:path}", _no_such_thing, methods=["GET", "POST", "PUT", "DELETE", "PATCH"]),
        WebSocketRoute("/ws", listeners.serve),
        *documentation_routes(),
        Mount("/", page_files()),
    ]
    handlers = {TestudoError: _saying(folder), ClientDisconnect: _gone}
    app = Starlette(routes=routes, exception_handlers=handlers, lifespan=lifespan)
    return Guard(app, access, [job.route for job in jobs if job.reads])


async def _no_such_thing(request: Request) -> Response:
    raise RequestError(f"there is no {request.method} {request.url.path}", 404)


def _saying(folder: ProjectFolder) -> Callable[[Request, Exception], Awaitable[Response]]:
    async def said(_: Request, error: Exception) -> Response:
        if not isinstance(error, TestudoError):
            raise error
        return error_answer(error, folder.shown)

    return said


async def _gone(_request: Request, _error: Exception) -> Response:
    """Nobody reads it: the page left before it had said what it wanted."""
    return Response(status_code=GONE)


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

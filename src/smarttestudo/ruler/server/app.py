# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's server: the routes of all jobs, the page and its web socket."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable
from functools import partial

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.types import ASGIApp

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.files.project import SettingsFile
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.version_store import VersionStore
from smarttestudo.ruler.incidents.robot_incidents import OpenIncidents, RobotIncidents
from smarttestudo.ruler.job import RequestError, all_jobs
from smarttestudo.ruler.robots.link import OpenRobots, RobotLink
from smarttestudo.ruler.rules.document import CheckedTexts
from smarttestudo.ruler.server.guard import Guard, ServerAddress
from smarttestudo.ruler.server.live import Listeners, LiveFeed, Progress
from smarttestudo.ruler.server.page import documentation_routes, page_files
from smarttestudo.ruler.server.processes import Processes
from smarttestudo.ruler.server.routes import GONE, error_answer, job_route
from smarttestudo.ruler.topics.vocabulary import RobotTopics
from smarttestudo.ruler.tries.keep import Keeps


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
    link = RobotLink(open_robots)
    feed = LiveFeed(link, listeners)
    services: dict[object, object] = {
        ProjectFolder: folder,
        SettingsFile: SettingsFile(folder),
        VersionStore: VersionStore(folder),
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

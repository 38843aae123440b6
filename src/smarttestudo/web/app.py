# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The routes of the Ruler's server."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from typing import TypeVar

import msgspec
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.types import ASGIApp

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.composition.ruler.robot_link import RobotLink
from smarttestudo.composition.ruler.ruler_node import ruler_node
from smarttestudo.domain.errors import TestudoError
from smarttestudo.web import optimize_api, rules_api, zone_schemas, zones_json
from smarttestudo.web import robot_schemas as robot_schema
from smarttestudo.web import schemas as schema
from smarttestudo.web import sharing_schemas as sharing
from smarttestudo.web.background_api import BackgroundApi
from smarttestudo.web.bodies import read_body
from smarttestudo.web.curve_schemas import LevelsRequest
from smarttestudo.web.errors import JSON, RequestError, error_answer
from smarttestudo.web.guard import Access, Guard
from smarttestudo.web.live_feed import LiveFeed
from smarttestudo.web.measure_api import MeasureApi
from smarttestudo.web.page import page_files
from smarttestudo.web.profile_api import ProfileApi, levels_of_rate
from smarttestudo.web.project_api import ProjectApi
from smarttestudo.web.robots_api import RobotsApi
from smarttestudo.web.socket import Listeners
from smarttestudo.web.try_api import CurveApi, TryApi

_Body = TypeVar("_Body", bound=msgspec.Struct)
_Handler = Callable[[Request], Awaitable[Response]]


def ruler_app(folder: ProjectFolder, access: Access, *, opened: str | None = None) -> ASGIApp:
    """The server of the project in ``folder``, for whom ``access`` lets in."""
    listeners = Listeners()
    link = RobotLink(ruler_node)
    robots = RobotsApi(link)
    feed = LiveFeed(link, listeners)

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        yield
        await feed.close()

    routes: list[BaseRoute] = [
        *_project_routes(ProjectApi(folder, opened)),
        *_rule_routes(rules_api.RulesApi()),
        *_profile_routes(ProfileApi(folder, robots.topics)),
        *_background_routes(BackgroundApi(folder)),
        *_robot_routes(robots),
        Route("/api/profile/measure-live", MeasureApi(listeners).answer, methods=["POST"]),
        Route("/api/try", TryApi(folder, listeners).answer, methods=["POST"]),
        Route("/api/profile/curve", CurveApi(folder, listeners).answer, methods=["POST"]),
        Route("/api/{path:path}", _no_such_thing, methods=["GET", "POST", "PUT", "DELETE", "PATCH"]),
        WebSocketRoute("/ws", listeners.serve),
        Mount("/", page_files()),
    ]
    app = Starlette(routes=routes, exception_handlers={TestudoError: _said}, lifespan=lifespan)
    return Guard(app, access)


def _project_routes(api: ProjectApi) -> Iterable[BaseRoute]:
    async def project(_: Request) -> Response:
        return _json(await run_in_threadpool(api.project))

    async def read(request: Request) -> Response:
        return _json(await run_in_threadpool(api.read, request.query_params.get("name", "")))

    yield Route("/api/project", project, methods=["GET"])
    yield Route("/api/file", read, methods=["GET"])
    yield _route("/api/file", schema.SaveRequest, api.save, method="PUT")


def _rule_routes(api: rules_api.RulesApi) -> Iterable[BaseRoute]:
    yield _route("/api/document", schema.DocumentRequest, api.document)
    yield _route("/api/edit", schema.EditRequest, api.edit)
    yield _route("/api/format", schema.DocumentRequest, rules_api.format_text)
    yield _route("/api/fix", schema.FixRequest, api.fix)
    yield _route("/api/download", schema.DocumentRequest, rules_api.download)
    yield _route("/api/diff", schema.DifferenceRequest, rules_api.difference)
    yield _route("/api/export", sharing.ExportRequest, rules_api.export)
    yield _route("/api/import", sharing.ImportRequest, api.import_rules)
    yield _route("/api/import/preview", sharing.ImportPreviewRequest, rules_api.import_preview)
    yield _route("/api/zones", schema.DocumentRequest, api.zones)
    yield _route("/api/zones/cover", zone_schemas.CoverRequest, zones_json.cover)
    yield _route("/api/optimize", schema.OptimizeRequest, optimize_api.optimize)


def _background_routes(api: BackgroundApi) -> Iterable[BaseRoute]:
    async def choices(_: Request) -> Response:
        return _json(await run_in_threadpool(api.choices))

    yield Route("/api/backgrounds", choices, methods=["GET"])
    yield Route("/api/background/picture", api.picture, methods=["GET"])
    yield _route("/api/background", zone_schemas.BackgroundRequest, api.background)
    yield _route("/api/background/path", zone_schemas.PathRequest, api.path)


def _profile_routes(api: ProfileApi) -> Iterable[BaseRoute]:
    async def vocabulary(request: Request) -> Response:
        query = request.query_params
        return _json(await run_in_threadpool(api.vocabulary_of_files, query.get("profile"), query.get("bag")))

    yield Route("/api/vocabulary", vocabulary, methods=["GET"])
    yield _route("/api/vocabulary", schema.VocabularyRequest, api.vocabulary)
    yield _route("/api/profile/parse", schema.ProfileParseRequest, api.parse)
    yield _route("/api/profile/write", schema.ProfileWriteRequest, api.write)
    yield _route("/api/profile/check", schema.ProfileWriteRequest, api.check)
    yield _route("/api/profile/measure", schema.ProfileMeasureRequest, api.measure)
    yield _route("/api/profile/levels", LevelsRequest, levels_of_rate)


def _robot_routes(api: RobotsApi) -> Iterable[BaseRoute]:
    async def robots(_: Request) -> Response:
        return _json(await run_in_threadpool(api.robots))

    async def rules(request: Request) -> Response:
        return _json(await run_in_threadpool(api.rules, request.query_params.get("node", "")))

    yield Route("/api/robots", robots, methods=["GET"])
    yield Route("/api/robots/rules", rules, methods=["GET"])
    yield _route("/api/push/preview", robot_schema.PushRequest, api.preview)
    yield _route("/api/push", robot_schema.PushRequest, api.push)
    yield _route("/api/push/confirm", robot_schema.ConfirmRequest, api.confirm)


def _route(
    path: str, kind: type[_Body], answer: Callable[[_Body], msgspec.Struct], *, method: str = "POST"
) -> Route:
    async def handle(request: Request) -> Response:
        body = await read_body(request, kind)
        return _json(await run_in_threadpool(answer, body))

    return Route(path, handle, methods=[method])


async def _no_such_thing(request: Request) -> Response:
    raise RequestError(f"there is no {request.method} {request.url.path}", 404)


async def _said(_: Request, error: Exception) -> Response:
    if not isinstance(error, TestudoError):
        raise error
    return error_answer(error)


def _json(answer: msgspec.Struct) -> Response:
    return Response(msgspec.json.encode(answer), media_type=JSON)

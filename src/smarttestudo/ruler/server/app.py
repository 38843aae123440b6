# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The routes of the Ruler's server."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.types import ASGIApp

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.child_process import ChildWork
from smarttestudo.ruler.files.backgrounds import BackgroundRequest, Backgrounds
from smarttestudo.ruler.files.project import (
    CopyRequest,
    DeleteRequest,
    ProjectFiles,
    RenameRequest,
    SaveRequest,
    SettingsFile,
    SettingsRequest,
)
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.recordings import BagRequest, ReceivedAnswer, Recordings
from smarttestudo.ruler.incidents.incidents import (
    IncidentCourse,
    IncidentCourseRequest,
    KnownIncidents,
    OneIncidentRequest,
)
from smarttestudo.ruler.incidents.robot_incidents import (
    OpenIncidents,
    RobotIncidentRequest,
    RobotIncidents,
)
from smarttestudo.ruler.robots.checks import RobotChecksRequest
from smarttestudo.ruler.robots.link import OpenRobots, RobotLink
from smarttestudo.ruler.robots.push import PushedRequest, PushRequest, RobotRequest
from smarttestudo.ruler.robots.watched_robots import WatchedRobots
from smarttestudo.ruler.rules import edits, optimize, sharing, versions, zones
from smarttestudo.ruler.rules.document import Draft
from smarttestudo.ruler.rules.edits import TextAnswer
from smarttestudo.ruler.server.child_work import (
    CheckApi,
    CurveApi,
    IncidentApi,
    MeasureApi,
    TryApi,
)
from smarttestudo.ruler.server.downloads import sending_zip
from smarttestudo.ruler.server.errors import GONE, RequestError, error_answer
from smarttestudo.ruler.server.guard import Guard, ServerAddress
from smarttestudo.ruler.server.keeping import Keepings
from smarttestudo.ruler.server.live import Listeners, LiveFeed
from smarttestudo.ruler.server.page import documentation_routes, page_files
from smarttestudo.ruler.server.routes import ApiRoute, Handler, answering, long_work, read_query, telling
from smarttestudo.ruler.server.uploads import receiving
from smarttestudo.ruler.topics import profiles
from smarttestudo.ruler.topics.curves import AccuracyNeeds, Curve, CurveRequest
from smarttestudo.ruler.topics.vocabulary import Vocabulary, VocabularyRequest, vocabulary
from smarttestudo.ruler.tries.check_course import CheckCourse, CheckCourseRequest
from smarttestudo.ruler.tries.incident_keeping import KeepEndRequest, KeepRequest, KeepsAnswer
from smarttestudo.ruler.tries.loss import TriedRecording
from smarttestudo.ruler.tries.try_rules import TryAnswer, TryRequest

_PNG = "image/png"


def ruler_app(
    folder: ProjectFolder,
    access: ServerAddress,
    open_robots: OpenRobots,
    *,
    open_incidents: OpenIncidents | None = None,
    opened: str | None = None,
) -> ASGIApp:
    """The server of the project in ``folder``, for whom ``access`` lets in, with these robots."""
    listeners = Listeners()
    tries = TryApi(folder, listeners)
    keepings = Keepings(folder)
    robot_incidents = RobotIncidents(folder, open_incidents)
    link = RobotLink(open_robots)
    feed = LiveFeed(link, listeners)

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        yield
        await feed.close()
        await keepings.close()
        await tries.close()
        await run_in_threadpool(robot_incidents.close)

    routes: list[BaseRoute] = [
        *api_routes(folder, link, listeners, opened=opened),
        *trial_routes(tries, keepings),
        *robot_incident_routes(robot_incidents),
        Route("/api/background/picture", _picture(Backgrounds(folder)), methods=["GET"]),
        Route("/api/incident/zip", sending_zip(KnownIncidents(folder)), methods=["GET"]),
        Route("/api/{path:path}", _no_such_thing, methods=["GET", "POST", "PUT", "DELETE", "PATCH"]),
        WebSocketRoute("/ws", listeners.serve),
        *documentation_routes(),
        Mount("/", page_files()),
    ]
    handlers = {TestudoError: _saying(folder), ClientDisconnect: _gone}
    app = Starlette(routes=routes, exception_handlers=handlers, lifespan=lifespan)
    return Guard(app, access)


def api_routes(
    folder: ProjectFolder, link: RobotLink, listeners: Listeners, *, opened: str | None = None
) -> Iterator[ApiRoute]:
    """All that the page can ask in JSON."""
    robots = WatchedRobots(link)
    settings = SettingsFile(folder)
    yield from _project_routes(ProjectFiles(folder, settings, opened))
    yield from _recording_routes(Recordings(folder))
    yield from _version_routes(versions.Versions(folder))
    yield from _rule_routes(edits.EditedTexts(), robots)
    yield from _profile_routes(profiles.Profiles(folder, settings))
    yield from _background_routes(Backgrounds(folder))
    yield from _incident_routes(KnownIncidents(folder))
    course = IncidentApi(folder, listeners)
    yield long_work("/api/incident/course", IncidentCourseRequest, course.answer, IncidentCourse)
    yield answering("/api/robot/history", RobotRequest, robots.history)
    yield answering("/api/robot/checks", RobotChecksRequest, robots.checks)
    yield answering("/api/robot/start", RobotRequest, robots.start)
    yield answering("/api/push/preview", PushRequest, robots.preview)
    yield answering("/api/push", PushRequest, robots.push)
    yield answering("/api/push/confirm", PushedRequest, robots.confirm)
    yield answering("/api/push/lasting", RobotRequest, robots.lasting)
    yield answering("/api/push/write", PushedRequest, robots.write)
    yield long_work(
        "/api/profile/measure-live", profiles.MeasureLiveRequest, MeasureApi(listeners).answer, TextAnswer
    )
    yield long_work("/api/check/course", CheckCourseRequest, CheckApi(folder, listeners).answer, CheckCourse)
    losses = CurveApi(folder, listeners, ChildWork.CURVE)
    yield long_work("/api/profile/curve", CurveRequest, losses.answer, Curve)
    needs = CurveApi(folder, listeners, ChildWork.ACCURACY)
    yield long_work("/api/profile/accuracy", CurveRequest, needs.answer, AccuracyNeeds)


def _project_routes(files: ProjectFiles) -> Iterator[ApiRoute]:
    yield telling("/api/project", files.project)
    yield telling("/api/file", files.read, query="name")
    yield telling("/api/file/state", files.state, query="name")
    yield answering("/api/file", SaveRequest, files.save, method="PUT")
    yield answering("/api/file/rename", RenameRequest, files.rename)
    yield answering("/api/file/copy", CopyRequest, files.copy)
    yield answering("/api/file/delete", DeleteRequest, files.delete)
    yield answering("/api/project/settings", SettingsRequest, files.set, method="PUT")


def _recording_routes(known: Recordings) -> Iterator[ApiRoute]:
    yield answering("/api/recording", BagRequest, known.recording)
    yield ApiRoute("PUT", "/api/recording", receiving(known), asked=None, answered=ReceivedAnswer)


def _incident_routes(known: KnownIncidents) -> Iterator[ApiRoute]:
    yield telling("/api/incidents", known.incidents)
    yield answering("/api/incident", OneIncidentRequest, known.incident, answered=known.mark_read)
    yield answering("/api/incident/delete", OneIncidentRequest, known.delete)


def trial_routes(tries: TryApi, keepings: Keepings) -> Iterator[ApiRoute]:
    """Routes about tries, and incidents of them that are being kept."""
    yield long_work("/api/try", TryRequest, tries.answer, TryAnswer)
    yield long_work("/api/try/headline", TryRequest, tries.headline, TriedRecording)
    yield ApiRoute("GET", "/api/try/keeps", keepings.told, asked=None, answered=KeepsAnswer)
    yield long_work("/api/try/keep", KeepRequest, keepings.start, KeepsAnswer)
    yield long_work("/api/try/keep/cancel", KeepEndRequest, keepings.end, KeepsAnswer)


def robot_incident_routes(robots: RobotIncidents) -> Iterator[ApiRoute]:
    """Routes about incidents that robots hold."""
    yield telling("/api/robot-incidents", robots.incidents)
    yield telling("/api/robot-incidents/fetches", robots.fetches)
    yield answering("/api/robot-incidents/fetch", RobotIncidentRequest, robots.fetch)
    yield answering("/api/robot-incidents/cancel", RobotIncidentRequest, robots.cancel)


def _version_routes(kept: versions.Versions) -> Iterator[ApiRoute]:
    yield telling("/api/versions", kept.versions, query="name")
    yield answering("/api/version", versions.VersionRequest, kept.version)
    yield answering("/api/difference", versions.DifferenceRequest, versions.difference)


def _rule_routes(texts: edits.EditedTexts, robots: WatchedRobots) -> Iterator[ApiRoute]:
    def words(request: VocabularyRequest) -> Vocabulary:
        return vocabulary(request, robots.topics())

    yield answering("/api/document", Draft, texts.document)
    yield answering("/api/edit", edits.EditRequest, texts.edit)
    yield answering("/api/format", Draft, edits.format_text)
    yield answering("/api/export", sharing.ExportRequest, edits.export)
    yield answering("/api/import", sharing.ImportRequest, texts.import_rules)
    yield answering("/api/import/preview", sharing.ImportPreviewRequest, sharing.import_preview)
    yield answering("/api/zones", Draft, texts.zones)
    yield answering("/api/zones/cover", zones.CoverRequest, zones.cover)
    yield answering("/api/optimize", optimize.OptimizeRequest, optimize.optimize)
    yield answering("/api/vocabulary", VocabularyRequest, words)


def _background_routes(backgrounds: Backgrounds) -> Iterator[ApiRoute]:
    yield telling("/api/backgrounds", backgrounds.choices)
    yield answering("/api/background", BackgroundRequest, backgrounds.background)
    yield answering("/api/background/path", BagRequest, backgrounds.path)


def _profile_routes(known: profiles.Profiles) -> Iterator[ApiRoute]:
    yield answering("/api/profile/for", profiles.ProfileForRequest, known.choice)
    yield answering("/api/profile/for", profiles.ProfileChosenRequest, known.choose, method="PUT")
    yield answering("/api/profile/parse", profiles.ProfileParseRequest, profiles.table_of)
    yield answering("/api/profile/write", profiles.ProfileWriteRequest, profiles.written)
    yield answering("/api/profile/entry", profiles.ProfileEntryRequest, profiles.with_entry)
    yield answering("/api/profile/check", profiles.ProfileWriteRequest, profiles.checked)
    yield answering("/api/profile/measure", BagRequest, known.measured)
    yield answering("/api/profile/levels", profiles.LevelsRequest, profiles.levels_of_rate)


def _picture(backgrounds: Backgrounds) -> Handler:
    async def picture(request: Request) -> Response:
        asked = read_query(request, BackgroundRequest)
        return Response(await run_in_threadpool(backgrounds.picture, asked), media_type=_PNG)

    return picture


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

# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks about the floor below its zones."""

from __future__ import annotations

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import FileKind, ProjectFolder
from smarttestudo.composition.ruler.backgrounds import Backgrounds
from smarttestudo.web import zone_schemas as schema
from smarttestudo.web.errors import RequestError

_PNG = "image/png"
_KINDS: dict[str, FileKind] = {"map": FileKind.MAP, "image": FileKind.IMAGE}


class BackgroundApi:
    """The maps, images and recordings of ``folder``."""

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder
        self._backgrounds = Backgrounds(folder)

    def choices(self) -> schema.BackgroundsAnswer:
        """What zones can be drawn on."""
        files, _ = self._folder.files()
        found = [one for one in files if one.kind in (FileKind.MAP, FileKind.BAG)] + self._folder.images()
        return schema.BackgroundsAnswer(
            choices=tuple(
                schema.BackgroundChoice(kind=one.kind.value, name=one.name)  # type: ignore[arg-type]
                for one in found
            )
        )

    def background(self, request: schema.BackgroundRequest) -> schema.BackgroundAnswer:
        """Size and place of a map or image."""
        found = self._backgrounds.background(request.name, _KINDS[request.kind])
        return schema.BackgroundAnswer(
            kind=request.kind,
            name=request.name,
            hash=found.sha256,
            width_px=found.width_px,
            height_px=found.height_px,
            metres_per_pixel=found.metres_per_pixel,
            x=found.x_m,
            y=found.y_m,
            yaw_rad=found.yaw_rad,
        )

    async def picture(self, request: Request) -> Response:
        """A map or image, as PNG whatever it was."""
        kind = _KINDS.get(request.query_params.get("kind", ""))
        if kind is None:
            raise RequestError("a picture is of a 'map' or an 'image'", 400)
        name = request.query_params.get("name", "")
        return Response(await run_in_threadpool(self._backgrounds.picture, name, kind), media_type=_PNG)

    def path(self, request: schema.PathRequest) -> schema.PathAnswer:
        """Where the robot of a recording was."""
        driven = self._backgrounds.path(request.bag)
        return schema.PathAnswer(
            path=tuple((point.t_s, point.x_m, point.y_m) for point in driven.points), notices=driven.notices
        )
